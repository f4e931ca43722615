"""One sentence on where most of the gap lies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy

from ...errors import MeasurementError, SimulationError
from .floor import floor_of
from .frequency import Band, by_frequency
from .regions import RegionGaps, by_region
from .signals import SignalGaps, by_signal
from .value import Residuals
from .windows import WindowGaps, by_window

Array = numpy.ndarray

MOST_ROWS = 20_000  # of a region analysis here: its permutations take time
LEAST_ROWS = 256  # of a window whose own spectrum is taken
STANDS_OUT = 0.15  # share that a part must hold beyond its fair one
NARROW = 0.5  # of the frequencies: a wider band is no band


@dataclass(frozen=True)
class Part:
    """A stretch of time or a region of a signal that holds more of the gap than is fair.

    Attributes
    ----------
    name : str
        ``"time"``, or of the signal.
    low, high : float
    unit : str
    share : float
        Of the gap above the floor.
    fair : float
        What it would hold were the gap spread evenly over the samples.
    """

    name: str
    low: float
    high: float
    unit: str
    share: float
    fair: float


@dataclass(frozen=True, eq=False)
class Place:
    """Where most of the gap lies.

    Attributes
    ----------
    found : bool
        Whether any gap stands above the floor.
    signal : str
        Empty where nothing was found.
    window : Part or None
        None where the gap is spread over time.
    band : Band or None
        Within the window; None where it is spread over the frequencies.
    region : Part or None
        None where the gap depends on none of the signals tried.
    onset : float or None
        s.
    share : float
        Of the whole gap above the floor in signal, window and band together.
    text : str
        All of it in words.
    signals : SignalGaps
    tried : tuple of str
        Signals tried for regions.
    """

    found: bool
    signal: str
    window: Part | None
    band: Band | None
    region: Part | None
    onset: float | None
    share: float
    text: str
    signals: SignalGaps
    tried: tuple[str, ...]


def locate(
    found: Residuals,
    over: Iterable[str] | None = None,
    *,
    floor: Any = None,
    windows: int = 10,
    segment: float | None = None,
    correlation_time: float = 0.0,
    alpha: float = 0.01,
    seed: int = 0,
) -> Place:
    """Name signal, window, band and region that hold the largest share of the gap.

    A signal is looked at only where its windows or its spectrum stand above the floor, with
    `alpha` shared by both tests of all signals. A window or region is named where it holds 15 %
    of the gap more than its share of the samples; a band where it is narrower than half of all
    frequencies; a region only where dependence passes the permutation test too.

    Parameters
    ----------
    found : Residuals
    over : iterable of str, optional
        Signals to look for regions in; inputs, compared signals and states unless given.
    floor : float, Floor, or mapping, optional
        As for `by_signal`.
    windows : int
    segment : float, optional
        Of the spectrum, s; as `by_frequency` chooses unless given.
    correlation_time : float
        Of the noise, s, as for `by_window`. Where it is not zero, bands are not looked for: they
        are told from white noise only.
    alpha : float
        Chance that anything is named where there is noise of the floor alone.
    seed : int

    Returns
    -------
    Place

    Examples
    --------
    >>> t = numpy.arange(4000) / 1000
    >>> noise = numpy.random.default_rng(1).normal(0, 0.1, 4000)
    >>> burst = numpy.where((t >= 1.2) & (t < 2), numpy.sin(400 * numpy.pi * t), 0)
    >>> locate(Residuals(t, {"v": noise + burst}, {"v": 0 * t}, {"v": "m/s"}), floor=0.1).text
    '100 % of the gap lies in v between 1.2 and 2 s at 185 to 215 Hz; none stands out by operating region'
    """
    sizes = by_signal(found, {signal: floor_of(found, signal, floor) for signal in found.signals})
    floors = {row.signal: row.floor for row in sizes}
    names = (*found.inputs, *found.signals, *found.states) if over is None else tuple(over)
    level = alpha / (2 * len(sizes))
    kept: list[tuple[Any, WindowGaps, tuple[Band, ...]]] = []
    for row in sizes:
        times = by_window(
            found,
            row.signal,
            windows,
            floor=floors,
            correlation_time=correlation_time,
            alpha=level,
        )
        bands = () if correlation_time else _bands(found, row.signal, floors, segment, level)
        if times.significant.any() or bands:
            kept.append((row, times, bands))
    if not kept:
        return Place(False, "", None, None, None, None, 0.0, _nothing(sizes, alpha), sizes, names)
    total = sum(row.share for row, *_ in kept)
    row, times, bands = max(kept, key=lambda item: item[0].share)
    signal = row.signal
    window = _window(times)
    inside = found if window is None else _between(found, window)
    if window is not None and not correlation_time and len(inside) >= LEAST_ROWS:
        bands = _bands(inside, signal, floors, None, level)
    band = bands[0] if bands and _narrow(bands[0], inside) else None
    region = _region(inside, signal, names, floors, alpha, seed)
    share = row.share / total if total > 0 else 1.0
    share *= (window.share if window else 1.0) * (band.share if band else 1.0)
    text = _words(signal, share, window, band, region, found.unit(signal))
    return Place(True, signal, window, band, region, times.onset, share, text, sizes, names)


def _bands(
    found: Residuals, signal: str, floors: Any, segment: float | None, alpha: float
) -> tuple[Band, ...]:
    try:
        return by_frequency(found, signal, (), floor=floors, segment=segment, alpha=alpha).bands
    except (MeasurementError, SimulationError):
        return ()  # uneven, holed or short: time and region can still be told


def _window(times: WindowGaps) -> Part | None:
    """Return the run of windows that holds most beyond its share of the samples."""
    first, last = _densest(times.share, times.count / max(times.count.sum(), 1))
    run = slice(first, last + 1)
    share = float(times.share[run].sum())
    fair = float(times.count[run].sum() / max(times.count.sum(), 1))
    if share - fair < STANDS_OUT or not times.significant[run].any():
        return None
    return Part("time", float(times.edges[first, 0]), float(times.edges[last, 1]), "s", share, fair)


def _densest(share: Array, fair: Array) -> tuple[int, int]:
    """Return first and last of the run with the largest sum of share less fair (Kadane)."""
    best, found, total, start = -numpy.inf, (0, 0), 0.0, 0
    for place, gain in enumerate(share - fair):
        if total <= 0:
            total, start = 0.0, place
        total += float(gain)
        if total > best:
            best, found = total, (start, place)
    return found


def _between(found: Residuals, window: Part) -> Residuals:
    return _rows(found, (found.t >= window.low) & (found.t <= window.high))


def _rows(found: Residuals, rows: Any) -> Residuals:
    parts: dict[str, Any] = {
        kind: {name: column[rows] for name, column in getattr(found, kind).items()}
        for kind in ("measured", "simulated", "inputs", "states")
    }
    return replace(found, t=found.t[rows], **parts)


def _narrow(band: Band, found: Residuals) -> bool:
    half = 0.5 * (len(found) - 1) / (found.t[-1] - found.t[0])
    return band.high - band.low < NARROW * half and band.share > STANDS_OUT


def _region(
    found: Residuals,
    signal: str,
    names: tuple[str, ...],
    floors: Any,
    alpha: float,
    seed: int,
) -> Part | None:
    """Return the region of the signal on which the gap depends most."""
    stride = -(-len(found) // MOST_ROWS)
    thinned = _rows(found, slice(None, None, stride))
    best: tuple[float, Part] | None = None
    permutations = max(199, int(numpy.ceil(2 * len(names) / alpha)))
    for name in names:
        column = thinned.along(name)
        if not numpy.nanmax(column) > numpy.nanmin(column):
            continue
        regions = by_region(
            thinned, signal, name, floor=floors, permutations=permutations, seed=seed
        )
        sure = [
            test.ratio - test.expected
            for test in (regions.of_mean, regions.of_power)
            if test.p * 2 * len(names) <= alpha * (1 + 1e-9) or test.p * (1 + permutations) < 1.5
        ]
        part = _part(regions)
        if sure and part is not None and (best is None or max(sure) > best[0]):
            best = (max(sure), part)
    return best[1] if best else None


def _part(regions: RegionGaps) -> Part | None:
    fair = regions.count / regions.count.sum()
    first, last = _densest(regions.share, fair)
    run = slice(first, last + 1)
    share, even = float(regions.share[run].sum()), float(fair[run].sum())
    if share - even < STANDS_OUT:
        return None
    low, high = float(regions.edges[0][first]), float(regions.edges[0][last + 1])
    return Part(regions.over[0], low, high, regions.over_units[0], share, even)


def _nothing(sizes: SignalGaps, alpha: float) -> str:
    parts = ", ".join(
        f"{row.signal} (rmse {row.rmse:.3g}, floor {row.floor.sigma:.3g} {row.unit or '1'})"
        for row in sizes
    )
    return f"no gap above the noise floor, at a false-alarm rate of {100 * alpha:g} %: {parts}"


def _words(
    signal: str,
    share: float,
    window: Part | None,
    band: Band | None,
    region: Part | None,
    unit: str,
) -> str:
    said = f"{100 * share:.0f} % of the gap lies in {signal}"
    if window:
        said += f" between {window.low:.4g} and {window.high:.4g} s"
    if band:
        said += f" at {band.low:.4g} to {band.high:.4g} Hz"
    lacking = [
        word
        for word, part in (("time", window), ("frequency", band), ("operating region", region))
        if part is None
    ]
    if region:
        said += (
            f", {100 * region.share:.0f} % of that at {region.name} from {region.low:.3g} to "
            f"{region.high:.3g} {region.unit}".rstrip()
            + f", where {100 * region.fair:.0f} % of the samples are"
        )
    return said + (f"; none stands out by {' or '.join(lacking)}" if lacking else "")
