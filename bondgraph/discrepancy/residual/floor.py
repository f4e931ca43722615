"""The size of a signal's white noise, from differences of high order."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from ...errors import MeasurementError
from .value import Residuals

Array = numpy.ndarray

ORDERS = (2, 4, 6, 8)
NORMAL = 0.6744897501960817  # median of |x| of a standard normal x
LEAST = 40
# Of the estimate over white noise, from 4000 draws of 400 and of 4000 samples: degrees of freedom a
# sample, 1 / (2 n var(log sigma)), and by how much the smallest of four falls short, times sqrt(n).
EFFICIENCY = 0.20
SHORT = 0.68


@dataclass(frozen=True)
class Floor:
    """A noise floor.

    Attributes
    ----------
    sigma : float
        Standard deviation of the noise, in the signal's unit.
    freedom : float
        Degrees of freedom of an estimate; infinite for a floor that is known.
    source : str
    """

    sigma: float
    freedom: float = math.inf
    source: str = "given"


def noise_floor(y: Any, t: Any = None) -> Floor:
    """Estimate the standard deviation of white noise on a signal.

    Differences of order p take off every polynomial below degree p; the median of their size is
    not moved by a few jumps. The smallest of orders 2, 4, 6 and 8 is returned. Noise that is
    correlated over many samples is not seen; a signal that is not smooth over nine samples is
    taken for noise.

    Parameters
    ----------
    y : (nt,) array-like
        NaN where nothing was measured; no difference is taken across.
    t : (nt,) array-like, s, optional
        Where the samples are not evenly spaced.

    Returns
    -------
    Floor

    Raises
    ------
    MeasurementError
        For fewer than 40 differences of order 2.

    References
    ----------
    Gasser, Sroka, Jennen-Steinmetz, Residual variance and residual pattern in nonlinear
    regression, Biometrika 73 (1986) 625-633.

    Examples
    --------
    >>> t = numpy.linspace(0, 1, 4001)
    >>> noise = numpy.random.default_rng(0).normal(0, 0.02, 4001)
    >>> round(noise_floor(numpy.sin(20 * t) + noise).sigma, 3)
    0.02
    """
    y = numpy.asarray(y, dtype=float)
    t = numpy.arange(len(y), dtype=float) if t is None else numpy.asarray(t, dtype=float)
    found, used = math.inf, 0
    for order in ORDERS:
        differences = _differences(y, t, order)
        if len(differences) >= LEAST:
            size = float(numpy.median(numpy.abs(differences))) / NORMAL
            found, used = min(found, size), max(used, len(differences))
    if not used:
        raise MeasurementError(
            f"a noise floor takes {LEAST} runs of three samples without gaps at least; give floor="
        )
    found *= 1 + SHORT / math.sqrt(used)
    return Floor(found, EFFICIENCY * used, f"differences of orders {ORDERS[0]} to {ORDERS[-1]}")


def floor_of(found: Residuals, signal: str, floor: Any) -> Floor:
    """Return the floor of one signal: given for it, for all, or estimated from its measurement.

    Parameters
    ----------
    found : Residuals
    signal : str
    floor : float, Floor, mapping of str to these, or None

    Returns
    -------
    Floor

    Raises
    ------
    MeasurementError
        For a floor that is negative or not finite.
    """
    found.gap(signal)
    if isinstance(floor, Mapping):
        floor = floor.get(signal)
    if floor is None:
        return noise_floor(found.measured[signal], found.t)
    floor = floor if isinstance(floor, Floor) else Floor(float(floor))
    if not (math.isfinite(floor.sigma) and floor.sigma >= 0):
        raise MeasurementError(f"{signal}: noise floor is {floor.sigma}; give 0 or more")
    return floor


def _differences(y: Array, t: Array, order: int) -> Array:
    """Return differences of an order whose variance is that of white noise."""
    if len(y) <= order:
        return numpy.zeros(0)
    view = numpy.lib.stride_tricks.sliding_window_view
    steps = numpy.diff(t)
    if numpy.ptp(steps) <= 1e-6 * steps.mean():
        weights = numpy.array([(-1) ** k * math.comb(order, k) for k in range(order + 1)], float)
        out = numpy.convolve(y, weights / numpy.sqrt((weights**2).sum()), mode="valid")
    else:  # weights of the divided difference, which takes off polynomials in t
        at = view(t, order + 1)
        apart = at[:, :, None] - at[:, None, :]
        apart = apart / numpy.abs(apart).max(axis=(1, 2), keepdims=True)
        apart[:, numpy.arange(order + 1), numpy.arange(order + 1)] = 1.0
        weights = 1 / apart.prod(axis=2)
        weights /= numpy.sqrt((weights**2).sum(axis=1, keepdims=True))
        out = (weights * view(y, order + 1)).sum(axis=1)
    return out[numpy.isfinite(out)]
