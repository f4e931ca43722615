"""The noise floor of a column: from high-order differences, or from repeats."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy
from numpy.lib.stride_tricks import sliding_window_view

from ...errors import MeasurementError
from .quality import NORMAL, quantisation
from .sampling import UNIFORM
from .value import Array, Measurement

ORDERS = range(2, 21, 2)
PLATEAU = (
    0.9  # of an order's floor is found two orders up, and at the top, where noise alone is left
)
MOST = 0.4  # of the column's spread: a floor above this may as well be a fast signal
FEWEST = 60  # values that a floor from differences is made of
SMOOTH = 0.5  # correlation of neighbours above which deviations of repeats are no white noise


@dataclass(frozen=True)
class NoiseFloor:
    """Standard deviation of the noise in one column.

    Attributes
    ----------
    std : float
        In the unit of the column.
    method : {"differences", "repeats"}
    reliable : bool
        Where False, `std` is an upper bound at best.
    reason : str
        Why it is not, or what it rests on.
    """

    std: float
    method: str
    reliable: bool
    reason: str


def noise_floor(
    measurement: Measurement, name: str, repeats: Sequence[Measurement] = ()
) -> NoiseFloor:
    """Estimate the noise in one column.

    Parameters
    ----------
    measurement : Measurement
    name : str
    repeats : sequence of Measurement, optional
        Recordings with the same input and start, at the same times after their starts. What
        differs between them is noise then.

    Returns
    -------
    NoiseFloor

    Raises
    ------
    MeasurementError
        For fewer than three values, and repeats sampled at other times.

    Notes
    -----
    A smooth signal sampled often is locally a polynomial, which differences of order k take away;
    white noise of variance s^2 leaves C(2k, k) s^2 [1]_. Differences are divided ones, so steps need
    not be equal, and their spread is the median absolute deviation, so that a few jumps do not
    count. The order rises until two in a row agree. Where none do, or the floor is a large part
    of the whole signal, it cannot be told from the signal: sampled too coarsely, or no white noise.
    Of coloured noise only its density at the highest frequencies is seen, as if it were white; the
    rest counts as signal.

    References
    ----------
    .. [1] P. Hall, J. W. Kay, D. M. Titterington, Asymptotically optimal difference-based
       estimation of variance in nonparametric regression, Biometrika 77 (1990) 521-528.

    Examples
    --------
    >>> t = numpy.linspace(0, 10, 2001)
    >>> noise = 0.05 * numpy.random.default_rng(1).normal(size=len(t))
    >>> floor = noise_floor(Measurement(t, {"x": numpy.sin(t) + noise}), "x")
    >>> round(floor.std, 3), floor.method, floor.reliable
    (0.05, 'differences', True)
    """
    if repeats:
        return _from_repeats([measurement, *repeats], name)
    present = measurement.present(name)
    t, values = measurement.t[present], measurement.column(name)[present]
    if len(values) < 3:
        raise MeasurementError(
            f"{measurement.name}, column {name!r}: a noise floor needs three values or more"
        )
    floor, order = _plateau(t, values)
    step = quantisation(measurement, name)
    rounding = (step or 0.0) / math.sqrt(12)
    spread = float(values.std())
    if floor <= rounding:
        if not step:
            reason = "differences leave nothing" if spread > 0 else "all values are the same"
            return NoiseFloor(0.0, "differences", spread > 0, reason)
        return NoiseFloor(
            rounding, "differences", True, f"the step of {step:.3g} that values are rounded to"
        )
    problem = ""
    if len(values) < FEWEST:
        problem = f"{len(values)} values are too few"
    elif not order:
        problem = (
            "differences of no order leave noise alone: sampled too coarsely, or no white noise"
        )
    elif floor > MOST * spread:
        problem = f"it is {floor / spread:.0%} of the whole signal: it may be the signal itself"
    reason = problem or f"differences of order {order} and {order - 2} agree"
    return NoiseFloor(floor, "differences", not problem, reason)


def _plateau(t: Array, values: Array) -> tuple[float, int]:
    """Return the first floor that has stopped to fall and its order; order 0 where none has."""
    orders = [k for k in ORDERS if k < len(values)]
    last = _of_order(t, values, orders[-1])
    floors: list[float] = []
    for k in orders:
        floors.append(last if k == orders[-1] else _of_order(t, values, k))
        before, here = floors[-2:] if len(floors) > 1 else (0.0, 0.0)
        if before > 0 and PLATEAU <= here / before <= 1 / PLATEAU:
            if last < PLATEAU * here:
                break  # a slow fall looked level between two orders
            return here, k
    return min(*floors, last), 0


def _of_order(t: Array, values: Array, k: int) -> float:
    """Return what differences of order k say the noise is, robustly."""
    steps = numpy.diff(t)
    typical = float(numpy.median(steps))
    if (numpy.abs(steps - typical) <= UNIFORM * typical).all():
        left = numpy.diff(values, n=k) / math.sqrt(math.comb(2 * k, k))
    else:
        weights = _weights(t, k)
        left = (weights * sliding_window_view(values, k + 1)).sum(axis=1)
    return NORMAL * float(numpy.median(numpy.abs(left)))


def _weights(t: Array, k: int) -> Array:
    """Return the weights of divided differences of order k, of norm one, shape (n - k, k + 1)."""
    times = sliding_window_view(t, k + 1)
    scale = (times[:, -1] - times[:, 0])[:, None] / k
    weights = numpy.ones(times.shape)
    for other in range(k + 1):
        apart = (times - times[:, other : other + 1]) / scale
        apart[:, other] = 1.0
        weights /= apart
    return weights / numpy.sqrt((weights**2).sum(axis=1, keepdims=True))


def _from_repeats(runs: list[Measurement], name: str) -> NoiseFloor:
    first = runs[0]
    after = first.t - first.start
    near = 1e-3 * float(numpy.median(numpy.diff(after)))
    for run in runs[1:]:
        if len(run) != len(first) or (numpy.abs(run.t - run.start - after) > near).any():
            raise MeasurementError(
                f"{run.name}: is not sampled at the times of {first.name}, so it is no repeat; resample it"
            )
    values = numpy.array([run.column(name) for run in runs])
    values = values[:, ~numpy.isnan(values).any(axis=0)]
    if values.shape[1] < 3:
        raise MeasurementError(
            f"{first.name}, column {name!r}: the repeats have fewer than three samples in common"
        )
    off = (values - values.mean(axis=0)) * math.sqrt(len(runs) / (len(runs) - 1))
    std = NORMAL * float(numpy.median(numpy.abs(off)))
    power = float((off**2).sum())
    alike = float((off[:, 1:] * off[:, :-1]).sum()) / power if power else 0.0
    if alike > SMOOTH:
        reason = f"the {len(runs)} repeats drift apart smoothly: they did not start or run alike"
        return NoiseFloor(std, "repeats", False, reason)
    return NoiseFloor(std, "repeats", True, f"{len(runs)} repeats")
