"""Whole columns from one unit into SI."""

from __future__ import annotations

import math

import numpy

from ...units import to_si

Array = numpy.ndarray


def scaled(values: Array, unit: str) -> Array:
    """Convert an array to SI base units.

    Parameters
    ----------
    values : (n,) array
    unit : str
        Any unit pint knows, with an offset (degC) or a logarithm (dB) too.

    Returns
    -------
    (n,) array
        NaN stays NaN.

    Examples
    --------
    >>> scaled(numpy.array([0.0, 20.0]), "degC").tolist()
    [273.15, 293.15]
    >>> scaled(numpy.array([1.0, numpy.nan]), "km").tolist()
    [1000.0, nan]
    """
    if unit in ("", "1", "s"):
        return values
    offset, one, two = (to_si(value, unit) for value in (0.0, 1.0, 2.0))
    if offset == 0.0 and math.isclose(two, 2 * one):
        return values * one
    if math.isclose(two - one, one - offset, rel_tol=1e-9):
        # over a thousand units, so that taking the offset off loses no digits
        return values * round((to_si(1e3, unit) - offset) / 1e3, 12) + offset
    return numpy.array([to_si(float(value), unit) for value in values])
