"""Two windows of a recording, before and during an event, by their periodograms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

from ...cycles import Spectrum, spectrum
from ...errors import MeasurementError
from ..measurement import Measurement
from .even import evenly
from .frequency import independent

Array = numpy.ndarray

AROUND = 12  # lines on either side that make the background of a line
BACKGROUND = 0.3  # degrees of freedom of that median, over those of its lines together


@dataclass(frozen=True)
class PeakChange:
    """A peak in one window or both.

    Attributes
    ----------
    kind : str
        ``"appears"``: during only, and higher than before; ``"grows"``, ``"shrinks"``,
        ``"stays"``: in both; ``"vanishes"``: before only, and lower during; ``"drowned"``: before
        only, but no lower during: what is around has risen over it; ``"unsure"``: during only,
        and not surely higher than before.
    frequency_hz : float
    width_hz : float
        Between the points of half the density; no narrower than the resolution can show.
    before, during : float
        Density at the peak's line.
    ratio : float
        During over before.
    p : float
        Chance of a ratio so far from one, either way, from one spectrum; not corrected for the
        number of peaks.
    """

    kind: str
    frequency_hz: float
    width_hz: float
    before: float
    during: float
    ratio: float
    p: float


@dataclass(frozen=True, eq=False)
class WindowComparison:
    """Spectra of two windows and the peaks that change.

    Attributes
    ----------
    signal, name : str
    spans : ((float, float), (float, float))
        Start and end of each window, s.
    before, during : Spectrum
        With window, resolution and averages.
    freedom : (float, float)
        Degrees of freedom of a line.
    peaks : tuple of PeakChange
        By frequency.
    rise : float
        Median over the lines of the density's ratio: what rose everywhere.
    risen : float
        Share of lines surely higher during.
    alpha : float
    treatment : str
        What was done to missing or uneven samples.
    """

    signal: str
    name: str
    spans: tuple[tuple[float, float], tuple[float, float]]
    before: Spectrum
    during: Spectrum
    freedom: tuple[float, float]
    peaks: tuple[PeakChange, ...]
    rise: float
    risen: float
    alpha: float
    treatment: str

    def of(self, kind: str) -> tuple[PeakChange, ...]:
        """Return the peaks of a kind."""
        return tuple(peak for peak in self.peaks if peak.kind == kind)


def compare_windows(
    measurement: Measurement,
    signal: str,
    before: tuple[float, float],
    during: tuple[float, float],
    *,
    segment: float | None = None,
    window: str = "hann",
    alpha: float = 0.01,
) -> WindowComparison:
    """Compare the spectra of two windows of a signal.

    A line is a peak where it stands above the median of the 12 lines on either side by more than
    noise does (F, Bonferroni over the lines). A peak has changed where the ratio of the two
    densities is outside what one spectrum gives (F, Bonferroni over the peaks; for `risen`, over
    the lines).

    Parameters
    ----------
    measurement : Measurement
    signal : str
    before, during : (float, float)
        Start and end of each window, s.
    segment : float, optional
        Length of a segment in both, s; a quarter of the shorter window unless given. Longer ones
        tell nearer peaks apart, more of them tell smaller changes.
    window : str
        Of `scipy.signal.get_window`.
    alpha : float
        Chance of any false peak, and of any false change.

    Returns
    -------
    WindowComparison

    Raises
    ------
    MeasurementError
        For an unknown signal, windows outside the recording, holes in them.
    SimulationError
        For segments and windows without meaning.

    Examples
    --------
    >>> t = numpy.arange(8000) / 1000
    >>> y = numpy.random.default_rng(2).normal(size=8000)
    >>> y[4000:] += numpy.sin(2 * numpy.pi * 150 * t[4000:])
    >>> found = compare_windows(Measurement(t, {"a": y}), "a", (0, 4), (4, 8))
    >>> [(peak.kind, round(peak.frequency_hz)) for peak in found.peaks]
    [('appears', 150)]
    """
    from scipy.signal import get_window
    from scipy.stats import f as fisher

    if signal not in measurement.columns:
        raise MeasurementError(
            f"{measurement.name}: no column {signal!r}; there is {', '.join(measurement.columns)}"
        )
    parts = [_part(measurement, signal, *span) for span in (before, during)]
    rate = (len(measurement) - 1) / (measurement.t[-1] - measurement.t[0])
    shorter = min(len(data.t) for data in parts) / rate
    length = shorter / 4 if segment is None else segment
    first, then = (
        spectrum((data.t, data.columns[0]), signal, segment=length, window=window) for data in parts
    )
    if len(first.frequency) != len(then.frequency):
        raise MeasurementError(f"{measurement.name}: the windows are sampled at different rates")
    count = 2 * (len(first.frequency) - 1)
    weights = get_window(window, round(length * first.rate))
    step = len(weights) - int(0.5 * len(weights))
    freedom = tuple(2 * independent(weights, step, part.averages) for part in (first, then))
    with numpy.errstate(divide="ignore", invalid="ignore"):
        ratio = then.density / first.density
    each = alpha / max(count // 2, 1)
    risen = ratio > fisher.isf(each / 2, freedom[1], freedom[0])
    return WindowComparison(
        signal,
        measurement.name,
        ((float(before[0]), float(before[1])), (float(during[0]), float(during[1]))),
        first,
        then,
        (freedom[0], freedom[1]),
        _changes(first, then, freedom, ratio, alpha),
        float(numpy.nanmedian(ratio[1:-1])),
        float(risen.mean()),
        alpha,
        "; ".join(dict.fromkeys(data.treatment for data in parts if data.treatment)),
    )


def _part(measurement: Measurement, signal: str, start: float, end: float) -> Any:
    t = measurement.t
    rows = (t >= start) & (t <= end)
    if not start < end or start < t[0] - 1e-9 or end > t[-1] * (1 + 1e-9) + (t[1] - t[0]):
        raise MeasurementError(
            f"{measurement.name}: window from {start:g} to {end:g} s; the recording has "
            f"{t[0]:g} to {t[-1]:g} s"
        )
    where = f"{measurement.name}, {signal}, {start:g} to {end:g} s"
    if rows.sum() < 2:
        raise MeasurementError(f"{where}: {int(rows.sum())} samples in the window")
    return evenly(t[rows], measurement.columns[signal][rows], where)


def _changes(
    first: Spectrum, then: Spectrum, freedom: tuple[float, ...], ratio: Array, alpha: float
) -> tuple[PeakChange, ...]:
    from scipy.stats import f as fisher

    each = alpha / max(len(ratio) - 1, 1)
    old, new = (_peaks(part, own, each) for part, own in zip((first, then), freedom, strict=True))
    near = max(1, round(first.resolution / first.line_spacing))
    changes = []
    places = sorted({*new, *(k for k in old if not _has(new, k, near))})
    sure = alpha / 2 / max(len(places), 1)
    for place in places:
        was, now = _has(old, place, near), _has(new, place, near)
        p_up = float(fisher.sf(ratio[place], freedom[1], freedom[0]))
        up, down = p_up < sure, p_up > 1 - sure
        shown = then if now else first
        changes.append(
            PeakChange(
                _kind(was, now, up, down),
                _top(shown, place),
                _width(shown, place),
                float(first.density[place]),
                float(then.density[place]),
                float(ratio[place]),
                2 * min(p_up, 1 - p_up),
            )
        )
    return tuple(changes)


def _kind(was: bool, now: bool, up: bool, down: bool) -> str:
    if was and now:
        return "grows" if up else "shrinks" if down else "stays"
    if now:
        return "appears" if up else "unsure"
    return "vanishes" if down else "drowned"


def _has(places: tuple[int, ...], place: int, near: int) -> bool:
    return any(abs(place - k) <= near for k in places)


def _peaks(part: Spectrum, freedom: float, each: float) -> tuple[int, ...]:
    """Return lines that stand above what is around them; edges hold what detrending left."""
    from scipy.ndimage import median_filter
    from scipy.signal import find_peaks
    from scipy.stats import chi2
    from scipy.stats import f as fisher

    around = numpy.empty_like(part.density)
    # detrending empties the first lines; they would lower what is around
    around[2:] = median_filter(part.density[2:], size=2 * AROUND + 1, mode="reflect")
    known = BACKGROUND * (2 * AROUND + 1) * freedom
    # the median of a chi-squared lies below its mean; two spectra are searched
    limit = around * freedom / chi2.median(freedom) * fisher.isf(each / 2, freedom, known)
    distance = max(1, round(part.resolution / part.line_spacing))
    places, _ = find_peaks(part.density, distance=distance)
    return tuple(int(k) for k in places if 2 <= k < len(limit) - 2 and part.density[k] > limit[k])


def _top(part: Spectrum, place: int) -> float:
    """Return the frequency of a parabola's top through the logarithms of three lines."""
    low, top, high = numpy.log(numpy.maximum(part.density[place - 1 : place + 2], 1e-300))
    bend = low - 2 * top + high
    shift = 0.5 * (low - high) / bend if bend < 0 else 0.0
    return float(part.frequency[place] + shift * part.line_spacing)


def _width(part: Spectrum, place: int) -> float:
    from scipy.signal import peak_widths

    return float(peak_widths(part.density, [place], rel_height=0.5)[0][0] * part.line_spacing)
