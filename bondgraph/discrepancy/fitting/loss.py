"""Loss functions of a standardised residual, as value and weight."""

from __future__ import annotations

from collections.abc import Callable

import numpy

from ...errors import ParameterError

Array = numpy.ndarray

# 95 % efficient on normal noise (Huber, Robust Statistics, Wiley 1981)
HUBER, CAUCHY = 1.345, 2.385


def _linear(r: Array) -> tuple[Array, Array]:
    return r * r, numpy.ones_like(r)


def _huber(r: Array) -> tuple[Array, Array]:
    size = numpy.abs(r)
    inside = size <= HUBER
    value = numpy.where(inside, r * r, 2 * HUBER * size - HUBER**2)
    return value, numpy.where(inside, 1.0, HUBER / numpy.maximum(size, HUBER))


def _cauchy(r: Array) -> tuple[Array, Array]:
    square = (r / CAUCHY) ** 2
    return CAUCHY**2 * numpy.log1p(square), 1 / (1 + square)


LOSSES = {"linear": _linear, "huber": _huber, "cauchy": _cauchy}


def loss_named(name: str) -> Callable[[Array], tuple[Array, Array]]:
    """Return a loss: residuals to their values and to the weights of reweighted least squares.

    Parameters
    ----------
    name : {"linear", "huber", "cauchy"}

    Returns
    -------
    callable

    Raises
    ------
    ParameterError

    Examples
    --------
    >>> [float(part[0]) for part in loss_named("linear")(numpy.array([3.0]))]
    [9.0, 1.0]
    """
    if name not in LOSSES:
        raise ParameterError(f"loss {name!r} is not known; use {', '.join(LOSSES)}")
    return LOSSES[name]
