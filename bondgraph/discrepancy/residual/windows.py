"""When the gap is more than noise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy

from ...errors import MeasurementError
from .floor import Floor, floor_of
from .value import Residuals

Array = numpy.ndarray

SLACK = 0.5  # of the floor's variance: a rise of the mean square that the onset does not look for
CLIP = 25.0  # one outlier moves the onset's sum by no more than this many variances


@dataclass(frozen=True, eq=False)
class WindowGaps:
    """Gap of a signal in windows of time.

    Attributes
    ----------
    signal, unit : str
    edges : (nw, 2) array
        Start and end of each window, s.
    count, effective : (nw,) array
        Samples, and how many independent ones they are worth.
    rmse, bias : (nw,) array
        NaN in windows without a sample.
    p : (nw,) array
        Chance of a mean square as large from noise alone.
    significant : (nw,) array of bool
        `p` below `alpha` over the number of windows.
    share : (nw,) array
        Of the excess over the floor of all windows.
    onset : float or None
        Time at which disagreement begins, s; None where there is none.
    floor : Floor
    alpha : float
        Chance of any false window, and of a false onset, each.
    """

    signal: str
    unit: str
    edges: Array
    count: Array
    effective: Array
    rmse: Array
    bias: Array
    p: Array
    significant: Array
    share: Array
    onset: float | None
    floor: Floor
    alpha: float


def by_window(
    found: Residuals,
    signal: str,
    windows: int | Sequence[tuple[float, float]] = 10,
    *,
    floor: Any = None,
    correlation_time: float = 0.0,
    alpha: float = 0.01,
) -> WindowGaps:
    """Measure the gap of a signal in windows of time, and find when it begins.

    A window's mean square over that of the floor is held against the F distribution, with the
    window's effective samples and the floor's degrees of freedom (chi-squared for a floor that is
    known), with Bonferroni's correction. The onset is Page's cumulative sum of the squares over
    the floor's, less 1.5: where it last left zero before passing the height that noise passes with
    chance `alpha` at most (Lundberg's bound). It misses disagreement that raises the mean square
    by less than a half, which a window still shows.

    Parameters
    ----------
    found : Residuals
    signal : str
    windows : int or sequence of (float, float)
        How many equal ones; or start and end of each, s.
    floor : float, Floor, or mapping, optional
        As for `by_signal`.
    correlation_time : float
        Of the noise, s, as that of a first-order lag; zero for white noise. Samples nearer than
        it count for less.
    alpha : float

    Returns
    -------
    WindowGaps

    Raises
    ------
    MeasurementError
        For windows without meaning.

    References
    ----------
    Page, Continuous inspection schemes, Biometrika 41 (1954) 100-115; Bartlett, On the
    theoretical specification and sampling properties of autocorrelated time-series, J. R. Stat.
    Soc. Suppl. 8 (1946) 27-41 (effective samples).

    Examples
    --------
    >>> t = numpy.arange(1000) / 1000
    >>> noise = numpy.random.default_rng(1).normal(0, 0.1, 1000)
    >>> late = numpy.where(t >= 0.6, 0.4, 0.0)
    >>> gaps = by_window(Residuals(t, {"v": noise + late}, {"v": 0 * t}), "v", 5, floor=0.1)
    >>> gaps.significant.tolist(), bool(abs(gaps.onset - 0.6) < 0.02)
    ([False, False, False, True, True], True)
    """
    from scipy.stats import f as fisher

    own = floor_of(found, signal, floor)
    edges = _edges(found, windows)
    worth = _worth(found.t, correlation_time)
    gap = found.gap(signal)
    last = edges[:, 1].max()
    parts = [
        gap[(found.t >= a) & ((found.t < b) | ((b == last) & (found.t <= b)))] for a, b in edges
    ]
    parts = [part[numpy.isfinite(part)] for part in parts]
    count = numpy.array([len(part) for part in parts])
    square = numpy.array([(part**2).mean() if len(part) else numpy.nan for part in parts])
    effective = count * worth
    with numpy.errstate(divide="ignore", invalid="ignore"):
        ratio = square / own.sigma**2
    ratio[square == 0] = 0.0
    # scipy's F at infinite degrees of freedom is chi-squared, but warns: a million is the same
    p = fisher.sf(ratio, numpy.maximum(effective, 1), min(own.freedom, 1e6))
    excess = numpy.nan_to_num(numpy.maximum(square - own.sigma**2, 0.0)) * count
    return WindowGaps(
        signal,
        found.unit(signal),
        edges,
        count,
        effective,
        numpy.sqrt(square),
        numpy.array([part.mean() if len(part) else numpy.nan for part in parts]),
        p,
        p < alpha / len(edges),
        excess / excess.sum() if excess.sum() > 0 else excess,
        _onset(found.t, gap, own.sigma, worth, alpha),
        own,
        alpha,
    )


def _edges(found: Residuals, windows: Any) -> Array:
    if isinstance(windows, int):
        if windows < 1:
            raise MeasurementError(f"{windows} windows: give one or more")
        marks = numpy.linspace(found.t[0], found.t[-1], windows + 1)
        return numpy.column_stack([marks[:-1], marks[1:]])
    edges = numpy.array(windows, dtype=float)
    if edges.ndim != 2 or edges.shape[1] != 2 or not (edges[:, 0] < edges[:, 1]).all():
        raise MeasurementError("windows are pairs of start and later end, s")
    return edges


def _worth(t: Array, correlation_time: float) -> float:
    """Return how many independent samples a sample is worth for a mean square."""
    if correlation_time < 0:
        raise MeasurementError(f"correlation_time is {correlation_time:g} s; give 0 or more")
    if correlation_time == 0:
        return 1.0
    square = math.exp(-2 * (t[-1] - t[0]) / (len(t) - 1) / correlation_time)
    return (1 - square) / (1 + square)


def _onset(t: Array, gap: Array, sigma: float, worth: float, alpha: float) -> float | None:
    good = numpy.isfinite(gap)
    t, gap = t[good], gap[good]
    if not sigma > 0:
        return float(t[numpy.argmax(gap != 0)]) if (gap != 0).any() else None
    block = max(1, math.ceil(1 / worth))
    usable = len(gap) // block * block
    if not usable:
        return None
    squares = numpy.minimum((gap[:usable] / sigma) ** 2, CLIP).reshape(-1, block).mean(axis=1)
    rise = numpy.cumsum(squares - 1 - SLACK)
    lowest = numpy.minimum.accumulate(numpy.append(0.0, rise))[:-1]
    over = rise - lowest > math.log(len(squares) / alpha) / _exponent()
    if not over.any():
        return None
    first = int(numpy.argmax(over))
    start = int(numpy.argmin(numpy.append(0.0, rise[: first + 1])))
    return float(t[start * block])


def _exponent() -> float:
    """Return Lundberg's exponent of a squared standard normal less 1 + SLACK."""
    from scipy.optimize import brentq

    return float(brentq(lambda s: -0.5 * math.log1p(-2 * s) - s * (1 + SLACK), 1e-3, 0.4999))
