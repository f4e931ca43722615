"""Algebraic variables at many points: their first values, and how they follow the states."""

from __future__ import annotations

from typing import Any

import numpy

from ...smooth import ROUNDING
from .newton import newton
from .numbers import Evaluated, ModeNumbers, picked

Array = numpy.ndarray


def with_algebraic(
    numbers: ModeNumbers, states: Array, u: list[Any], p: list[Any]
) -> tuple[Array, Array]:
    """Put algebraic variables that fulfil their equations behind given states.

    Parameters
    ----------
    numbers : ModeNumbers
    states : (n, m) array
    u, p : list of float or (m,) array

    Returns
    -------
    x : (n + nz, m) array
    found : (m,) array of bool
    """
    n, m = states.shape
    if n == numbers.size:
        return states, numpy.ones(m, dtype=bool)

    def functions(z: Array, points: Array) -> tuple[Array, Array]:
        x = numpy.concatenate([states[:, points], z])
        at = numbers.at(x, picked(u, points), picked(p, points))
        return at.rates[n:], numbers.dense(at.slopes, len(points))[:, n:, n:]

    first = numpy.repeat(numpy.array(numbers.algebraic_start)[:, None], m, axis=1)
    z, found, _ = newton(functions, first)
    return numpy.concatenate([states, z]), found


def state_matrices(
    numbers: ModeNumbers, found: Evaluated, u: list[Any], p: list[Any]
) -> tuple[Array, Array]:
    """Return the Jacobian of the states' rates, algebraic variables following.

    Parameters
    ----------
    numbers : ModeNumbers
    found : Evaluated
        At steady states.
    u, p : list of float or (m,) array

    Returns
    -------
    matrices : (m, n, n) array
    determined : (m,) array of bool
        Where the residuals determine the algebraic variables: their Jacobian stands while
        rounding moves them, which at a fold it does not.
    """
    n, m = numbers.order, found.x.shape[1]
    full = numbers.dense(found.slopes, m)
    inner = full[:, n:, n:]
    determined = numpy.linalg.matrix_rank(inner) == inner.shape[1]
    safe = numpy.where(determined[:, None, None], inner, numpy.eye(inner.shape[1]))
    with numpy.errstate(all="ignore"):
        follow = numpy.linalg.solve(safe, -full[:, n:, :n])
        matrices = full[:, :n, :n] + full[:, :n, n:] @ follow
        left = found.rates[n:]
        wide = numpy.array([numpy.broadcast_to(row, (m,)) for row in u]).reshape(len(u), m)
        sizes = numpy.concatenate([numpy.abs(found.x), numpy.abs(wide)]).T[:, :, None]
        steep = numpy.concatenate([full, numbers.by_inputs(found.x, u, p)], axis=2)[:, n:]
        terms = (numpy.abs(steep) @ sizes)[:, :, 0].T + numpy.abs(left)
        push = (numpy.abs(left) + ROUNDING * terms).T[:, :, None]
        moved = found.x.copy()
        moved[n:] += numpy.linalg.solve(safe, push)[:, :, 0].T
        other = numbers.dense(numbers.at(moved, u, p).slopes, m)[:, n:, n:]
        usable = numpy.isfinite(other).all(axis=(1, 2))
        other = numpy.where(usable[:, None, None], other, 0.0)
        change = numpy.linalg.solve(safe, other) - numpy.eye(inner.shape[1])
        steady = usable & (numpy.abs(change).max(axis=(1, 2)) < 0.5)
    determined &= steady & numpy.isfinite(matrices).all(axis=(1, 2))
    return matrices, determined
