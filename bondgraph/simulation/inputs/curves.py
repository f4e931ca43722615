"""Curves: signals over time as cubic pieces, from band-limited samples and from functions.

Band-limited samples are joined by a windowed sinc [1]_ at a grid fine enough for cubics to follow
it; functions of time by a cubic spline refined until it meets them.

References
----------
.. [1] J. F. Kaiser, Nonrecursive digital filter design using the I0-sinh window function, Proc.
   IEEE Int. Symp. Circuits and Systems, 1974, pp. 20-23.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy

from ...errors import ParameterError, SimulationError

Array = numpy.ndarray

# Samples on either side that a value is made of, and the window's shape: it passes 0.8 of the
# Nyquist frequency and stops its image at 1.2 to 1e-6, by Kaiser's rule.
TAPS, SHAPE = 20, 12.3
FINEST = 16  # pieces a sample, where the signal reaches up to 0.8 of the Nyquist frequency
FOLLOWED = 1e-5  # of the range of the samples: what the pieces may be off the sinc
JITTER = 1e-3  # of an interval: times may be rounded, but not irregular
FIRST = 33  # knots that a function is first looked at
MOST = 200_000
ROUNDS = 60
LEAST = 1e-11  # of the span: a function that needs closer knots jumps


@dataclass(frozen=True, eq=False)
class Curve:
    """Cubics between knots; constant before the first and after the last.

    Attributes
    ----------
    knots : (nk,) array
        Rising times, s.
    cubics : (4, nk) array
        Coefficients of the powers 0 to 3 of the time since each knot.
    """

    knots: Array
    cubics: Array

    def at(self, times: Array) -> Array:
        """Return the cubics about given times, shape (4, nt)."""
        index = numpy.searchsorted(self.knots, times, side="right") - 1
        before = index < 0
        index = numpy.maximum(index, 0)
        u, slope, bend, twist = self.cubics[:, index]
        s = numpy.where(before, 0.0, times - self.knots[index])
        found = numpy.array(
            [
                u + s * (slope + s * (bend + s * twist)),
                slope + s * (2 * bend + s * 3 * twist),
                bend + 3 * s * twist,
                twist,
            ]
        )
        found[1:, before] = 0.0
        return found


def rate(curve: Curve) -> Curve:
    """Return the time derivative of a curve.

    Examples
    --------
    >>> square = Curve(numpy.array([0.0]), numpy.array([[0.0], [0.0], [1.0], [0.0]]))
    >>> rate(square).at(numpy.array([3.0]))[0].tolist()
    [6.0]
    """
    _, slope, bend, twist = curve.cubics
    return Curve(curve.knots, numpy.array([slope, 2 * bend, 3 * twist, 0 * twist]))


def band_limited(times: Array, values: Array) -> Curve:
    """Join uniform samples by the signal of least bandwidth that passes through them.

    A sine wave of up to 0.8 of the Nyquist frequency is met within 1e-5 of its range, further than
    20 samples from both ends. Nearer to an end nothing tells what lies beyond; the samples are
    continued by their reflection in the last one, which keeps value and slope. Slow signals hardly
    suffer, fast ones do: at worst sine waves of 0.1, 0.5 and 0.8 of the Nyquist frequency are off
    by 0.4, 12 and 47 percent of their amplitude there.

    Parameters
    ----------
    times, values : (n,) array

    Returns
    -------
    Curve

    Raises
    ------
    ParameterError
        For times that are not uniform.

    Examples
    --------
    >>> times = numpy.arange(100.0)
    >>> curve = band_limited(times, numpy.sin(2.5 * times))
    >>> bool(abs(curve.at(numpy.array([50.3]))[0, 0] - math.sin(2.5 * 50.3)) < 1e-5)
    True
    """
    count = len(times)
    if count == 1:
        return Curve(times, numpy.array([values, *numpy.zeros((3, 1))]))
    interval = (times[-1] - times[0]) / (count - 1)
    _check_uniform(times, interval)
    padded = numpy.pad(values, TAPS, mode="reflect", reflect_type="odd")
    windows = numpy.lib.stride_tricks.sliding_window_view(padded, 2 * TAPS)[1 : count + 1]
    weights, slopes = _kernel(numpy.arange(FINEST) / FINEST)
    fine = (windows @ weights).ravel()[: (count - 1) * FINEST + 1]
    steep = (windows @ slopes).ravel()[: (count - 1) * FINEST + 1] / interval
    allowed = FOLLOWED * numpy.ptp(values)
    pieces = 1
    while pieces < FINEST and _off(fine, steep, FINEST // pieces, interval / pieces) > allowed:
        pieces *= 2
    keep = slice(None, None, FINEST // pieces)
    knots = numpy.linspace(times[0], times[-1], (count - 1) * pieces + 1)
    return Curve(knots, _hermite(fine[keep], steep[keep], interval / pieces))


def _check_uniform(times: Array, interval: float) -> None:
    off = numpy.abs(times - (times[0] + interval * numpy.arange(len(times))))
    if off.max() > JITTER * interval:
        gaps = numpy.diff(times)
        worst = int(numpy.argmax(numpy.abs(gaps - numpy.median(gaps))))
        raise ParameterError(
            f"hold 'band' needs samples at uniform times; sample {worst + 1} (t = {times[worst + 1]:g} s) "
            f"comes {gaps[worst]:g} s after the one before, where {numpy.median(gaps):g} s is usual: "
            f"resample them, or use hold='linear'"
        )


def _kernel(phases: Array) -> tuple[Array, Array]:
    """Return what samples weigh at phases after one, and the slopes of that: (2 TAPS, phases)."""
    from scipy.special import i0, i1

    x = phases[None, :] - numpy.arange(1 - TAPS, TAPS + 1)[:, None]
    wave = numpy.sinc(x)
    safe = numpy.where(x == 0, 1.0, x)
    wave_slope = numpy.where(x == 0, 0.0, (numpy.cos(math.pi * x) - wave) / safe)
    inside = numpy.sqrt(numpy.maximum(1 - (x / TAPS) ** 2, 0.0))
    window = i0(SHAPE * inside) / i0(SHAPE)
    ratio = numpy.where(inside > 0, i1(SHAPE * inside) / numpy.maximum(inside, 1e-300), SHAPE / 2)
    window_slope = -SHAPE * x / TAPS**2 * ratio / i0(SHAPE)
    weights, slopes = wave * window, wave_slope * window + wave * window_slope
    # what is constant stays so
    total, drift = weights.sum(axis=0), slopes.sum(axis=0)
    return weights / total, (slopes - weights * drift / total) / total


def _hermite(values: Array, slopes: Array, interval: float) -> Array:
    """Return cubics with given values and slopes at equidistant knots, shape (4, nk)."""
    rise = numpy.diff(values) / interval
    left, right = slopes[:-1], slopes[1:]
    bend, twist = (3 * rise - 2 * left - right) / interval, (left + right - 2 * rise) / interval**2
    end = numpy.array([[values[-1]], [0.0], [0.0], [0.0]])
    return numpy.concatenate([[values[:-1], left, bend, twist], end], axis=1)


def _off(fine: Array, steep: Array, every: int, interval: float) -> float:
    """How far cubics on every so many points are off the points between."""
    cubics = _hermite(fine[::every], steep[::every], interval)[:, :-1]
    s = (numpy.arange(every) * (interval / every))[:, None]
    u, slope, bend, twist = cubics
    there = (u + s * (slope + s * (bend + s * twist))).T.ravel()
    return float(numpy.abs(there - fine[:-1]).max(initial=0.0))


def fitted(
    function: Callable[[float], float], span: tuple[float, float], tolerance: float, name: str
) -> Curve:
    """Follow a function of time by a cubic spline.

    Knots are added where the spline is off the function half way between two of them, or at an
    irregular third point, by more than the tolerance.

    Parameters
    ----------
    function : callable
        Of a time, s.
    span : (float, float)
        Start and end, s.
    tolerance : float
        Largest deviation, in shares of the function's largest magnitude.
    name : str
        Of the input, for messages.

    Returns
    -------
    Curve
        Twice continuously differentiable.

    Raises
    ------
    SimulationError
        Where the function fails, is not finite, or is not met, such as where it jumps.

    Examples
    --------
    >>> curve = fitted(math.cos, (0.0, 9.0), 1e-8, "u")
    >>> bool(abs(curve.at(numpy.array([4.321]))[0, 0] - math.cos(4.321)) < 1e-8)
    True
    """
    from scipy.interpolate import CubicSpline

    start, end = span
    known: dict[float, float] = {}

    def values_at(times: Array) -> Array:
        for time in map(float, times):
            if time not in known:
                known[time] = _value(function, time, name)
        return numpy.array([known[time] for time in map(float, times)])

    # unequal, so that a periodic function is not met at its zeros only
    inner = numpy.linspace(0.0, 1.0, FIRST) + 0.3 / FIRST * numpy.sin(7.1 * numpy.arange(FIRST))
    shares = numpy.concatenate([[0.0], inner[1:-1], [1.0]])
    knots = start + (end - start) * shares
    values = values_at(knots)
    for _ in range(ROUNDS):
        spline = CubicSpline(knots, values)
        gaps = numpy.diff(knots)
        middles, others = knots[:-1] + 0.5 * gaps, knots[:-1] + 0.2137 * gaps
        if not len(gaps):
            break
        there, thence = values_at(middles), values_at(others)
        size = max(numpy.abs(values).max(), numpy.abs(there).max())
        off = numpy.maximum(numpy.abs(spline(middles) - there), numpy.abs(spline(others) - thence))
        wrong = off > tolerance * size
        if not wrong.any():
            cubics = numpy.concatenate(
                [spline.c[::-1], [[values[-1]], [0.0], [0.0], [0.0]]], axis=1
            )
            return Curve(knots, cubics)
        if (gaps[wrong] < LEAST * (end - start)).any() or len(knots) > MOST:
            break
        order = numpy.argsort(knots := numpy.concatenate([knots, middles[wrong]]))
        knots, values = knots[order], numpy.concatenate([values, there[wrong]])[order]
    worst = float(middles[numpy.argmax(off)])
    raise SimulationError(
        f"input {name!r}, a function of time, cannot be followed by cubics within {tolerance:.1g} of "
        f"its size; near t = {worst:g} s it jumps or moves too fast: give Samples with hold='zero' "
        f"for steps, or use solver='dopri5'"
    )


def _value(function: Callable[[float], float], time: float, name: str) -> float:
    try:
        value = float(function(time))
    except Exception as error:  # whatever a caller's function may raise
        raise SimulationError(f"input {name!r} failed at t = {time:g} s: {error}") from error
    if not math.isfinite(value):
        raise SimulationError(f"input {name!r} is {value} at t = {time:g} s; it must be finite")
    return value
