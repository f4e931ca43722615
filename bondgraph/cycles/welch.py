"""Power spectra by Welch's method, with what they can tell apart said beside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy

from ..errors import SimulationError
from ..simulation import Trajectory
from .again import again

Array = numpy.ndarray

UNEVEN = 1e-6
LEAST_SAMPLES = 8
DETREND = ("constant", "linear", False)


@dataclass(frozen=True)
class Peak:
    """A peak of a spectrum.

    Attributes
    ----------
    frequency_hz : float
        Of the top of a parabola through the logarithms of three lines.
    density : float
        There, in the spectrum's unit.
    amplitude : float
        Of a sine that would give this peak, in the signal's unit.

    Examples
    --------
    >>> Peak(50.0, 0.5, 1.0).frequency_hz
    50.0
    """

    frequency_hz: float
    density: float
    amplitude: float


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Power spectral density of a signal, one-sided.

    Attributes
    ----------
    frequency : (nf,) array
        Hz.
    density : (nf,) array
        Mean power in a band over the band's width, in `unit`; its integral is the variance.
    signal : str
    unit : str
        Such as ``(m)^2/Hz``.
    rate : float
        Samples a second, Hz.
    window : str
    segment : float
        Length of a segment, s.
    overlap : float
        Share of a segment that the next one has too.
    detrend : str or False
        What was taken off each segment.
    averages : int
        Number of segments.
    line_spacing : float
        Hz from line to line.
    resolution : float
        Equivalent noise bandwidth of the window, Hz: peaks nearer than about this are one.
    """

    frequency: Array
    density: Array
    signal: str
    unit: str
    rate: float
    window: str
    segment: float
    overlap: float
    detrend: Any
    averages: int
    line_spacing: float
    resolution: float

    def peaks(self, most: int = 5, prominence: float = 1e-3) -> tuple[Peak, ...]:
        """Return the peaks that stand out, highest first.

        Parameters
        ----------
        most : int
        prominence : float
            Least height over the higher of the valleys beside, as a share of the highest line.

        Returns
        -------
        tuple of Peak
        """
        from scipy.signal import find_peaks

        if not len(self.density) or not self.density.max() > 0:
            return ()
        least = prominence * float(self.density.max())
        places, _ = find_peaks(self.density, prominence=least)
        places = places[numpy.argsort(-self.density[places], kind="stable")][:most]
        return tuple(self._peak(int(place)) for place in places)

    def _peak(self, place: int) -> Peak:
        tiny = numpy.finfo(float).tiny
        low, top, high = numpy.log(numpy.maximum(self.density[place - 1 : place + 2], tiny))
        bend = low - 2 * top + high
        shift = 0.5 * (low - high) / bend if bend < 0 else 0.0
        density = float(numpy.exp(top - 0.25 * (low - high) * shift))
        where = float(self.frequency[place] + shift * self.line_spacing)
        return Peak(where, density, float(numpy.sqrt(2 * density * self.resolution)))


def spectrum(
    source: Trajectory | tuple[Any, Any],
    signal: str = "signal",
    *,
    window: str = "hann",
    segment: float | None = None,
    overlap: float = 0.5,
    detrend: Any = "constant",
    start: float | None = None,
    rate: float | None = None,
    rtol: float = 1e-8,
) -> Spectrum:
    """Estimate the power spectral density of a signal.

    Parameters
    ----------
    source : Trajectory or (t, y)
        A run whose rows are not evenly spaced is simulated again from its first row, on an even
        grid. Data are taken as they are, and must be even.
    signal : str
        Of the run; or what to call the data.
    window : str
        Of `scipy.signal.get_window`.
    segment : float, optional
        Length of a segment, s; a quarter of the data unless given. Longer ones tell nearer
        frequencies apart, more of them scatter less.
    overlap : float
        Share of a segment that the next one has too, from 0 to below 1.
    detrend : {"constant", "linear", False}
        What is taken off each segment.
    start : float, optional
        Leave out what is before, s: a transient blurs the lines.
    rate : float, optional
        Samples a second for a run that is simulated again; as many as it has rows unless given.
    rtol : float
        Of that run.

    Returns
    -------
    Spectrum

    Raises
    ------
    SimulationError
        For data that are not evenly spaced or not finite, too few of them, and options without
        meaning.

    References
    ----------
    Welch, The use of fast Fourier transform for the estimation of power spectra, IEEE Trans.
    Audio and Electroacoustics 15 (1967) 70-73; Harris, On the use of windows for harmonic
    analysis, Proc. IEEE 66 (1978) 51-83.

    Examples
    --------
    >>> t = numpy.arange(4000) / 1000
    >>> found = spectrum((t, 3 * numpy.sin(2 * numpy.pi * 50 * t)))
    >>> [(round(peak.frequency_hz, 3), round(peak.amplitude, 2)) for peak in found.peaks()]
    [(50.0, 3.0)]
    """
    from scipy.signal import get_window, welch

    t, y, unit = _data(source, signal, start, rate, rtol)
    _check_options(overlap, detrend)
    spacing = (t[-1] - t[0]) / (len(t) - 1)
    count = _samples(segment, spacing, len(t), signal)
    step = count - int(overlap * count)
    try:
        weights = get_window(window, count)
    except ValueError as error:
        raise SimulationError(f"window {window!r} is not known: {error}") from None
    frequency, density = welch(
        y,
        fs=1 / spacing,
        window=weights,
        nperseg=count,
        noverlap=count - step,
        detrend=detrend,
        scaling="density",
    )
    bandwidth = float((weights**2).sum() / weights.sum() ** 2 / spacing)
    return Spectrum(
        frequency,
        density,
        signal,
        f"({unit or '1'})^2/Hz",
        1 / spacing,
        str(window),
        count * spacing,
        1 - step / count,
        detrend,
        1 + (len(t) - count) // step,
        1 / (count * spacing),
        bandwidth,
    )


def _data(
    source: Any, signal: str, start: float | None, rate: float | None, rtol: float
) -> tuple[Array, Array, str]:
    """Return evenly spaced times and values, and the unit."""
    if isinstance(source, Trajectory):
        unit = source.unit(signal)
        run = source if rate is None and _even(source.t) else _evenly(source, rate, rtol)
        t, y = run.t, run[signal]
    else:
        try:
            t, y = (numpy.array(part, dtype=float).ravel() for part in source)
        except (TypeError, ValueError):
            raise SimulationError("a spectrum needs a Trajectory, or (times, values)") from None
        unit = ""
        if len(t) != len(y):
            raise SimulationError(f"{signal!r} has {len(t)} times and {len(y)} values")
    if start is not None:
        t, y = t[t >= start], y[t >= start]
    if len(t) < LEAST_SAMPLES:
        raise SimulationError(
            f"{signal!r} has {len(t)} samples; a spectrum takes {LEAST_SAMPLES} at least"
        )
    if not (numpy.isfinite(t).all() and numpy.isfinite(y).all()):
        raise SimulationError(f"{signal!r} has values that are not finite; cut or mend them first")
    if not _even(t):
        worst = int(numpy.argmax(numpy.abs(numpy.diff(t) - numpy.median(numpy.diff(t)))))
        raise SimulationError(
            f"{signal!r} is not evenly spaced: {t[worst + 1] - t[worst]:g} s after t = {t[worst]:g} s, "
            f"elsewhere {numpy.median(numpy.diff(t)):g} s; interpolate it onto an even grid first"
        )
    return t, y, unit


def _even(t: Array) -> bool:
    if len(t) < 2:
        return False
    steps = numpy.diff(t)
    middle = (t[-1] - t[0]) / (len(t) - 1)
    return bool(middle > 0 and numpy.abs(steps - middle).max() <= UNEVEN * middle)


def _evenly(run: Trajectory, rate: float | None, rtol: float) -> Trajectory:
    """Simulate a run again from its first row, on an even grid."""
    first, last = float(run.t[0]), float(run.t[-1])
    count = len(run.t) if rate is None else int(rate * (last - first)) + 1
    if count < LEAST_SAMPLES:
        raise SimulationError(
            f"{count} samples are too few for a spectrum; give a higher rate or a longer run"
        )
    end = last if rate is None else first + (count - 1) / rate
    grid = numpy.linspace(first, min(end, last), count)
    z = run.z[:, 0] if len(run.z) else None
    even = again(run, (first, last), run.x[:, 0], z, grid, rtol)
    if not even.outcome.ok:
        raise SimulationError(f"the run cannot be made again: {even.outcome.advice}")
    return even


def _samples(segment: float | None, spacing: float, available: int, signal: str) -> int:
    if segment is None:
        return max(LEAST_SAMPLES, available // 4)
    count = round(segment / spacing)
    if not LEAST_SAMPLES <= count <= available:
        raise SimulationError(
            f"segment of {segment:g} s: {signal!r} has {available} samples of {spacing:g} s; give "
            f"{LEAST_SAMPLES * spacing:g} s to {available * spacing:g} s"
        )
    return count


def _check_options(overlap: float, detrend: Any) -> None:
    if not 0 <= overlap < 1:
        raise SimulationError(f"overlap is {overlap}; it must be at least 0 and below 1")
    if detrend not in DETREND:
        raise SimulationError(f"detrend is {detrend!r}; give 'constant', 'linear' or False")
