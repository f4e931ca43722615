"""Algebraic variables at many points at once: Newton for all together, point by point where it fails."""

from __future__ import annotations

from collections.abc import Callable

import numpy

from ...consistent import Residual, consistent

Array = numpy.ndarray
# Values z of shape (nt, k) at some points (indices) to what is left (nt, k), the Jacobian (nt, k, k),
# and the size of the terms (nt, k).
Many = Callable[[Array, Array], tuple[Array, Array, Array]]

STEPS = 40
HALVINGS = 30  # of a step
ROUNDING, ACCEPTED = 1e-14, 1e-11  # of the terms that cancel


def solved(many: Many, count: int, size: int) -> Array:
    """Return algebraic variables that fulfil their equations at each point.

    Parameters
    ----------
    many : callable
        Takes the numbers of points, shape (m,), and values there, shape (m, size).
    count : int
        Number of points.
    size : int
        Of the algebraic variables.

    Returns
    -------
    (count, size) array
        NaN at points where no values fulfil them.

    Examples
    --------
    >>> level = numpy.array([2.0, 10.0, 30.0])
    >>> def cubic(points, z):
    ...     left = z**3 + z - level[points, None]
    ...     return left, (3 * z**2 + 1)[:, :, None], abs(z**3) + level[points, None]
    >>> solved(cubic, 3, 1).ravel().round(9).tolist()
    [1.0, 2.0, 3.0]
    """
    z = numpy.zeros((count, size))
    with numpy.errstate(all="ignore"):
        open_ = _newton(many, z, numpy.arange(count))
        guess = numpy.zeros(size)
        for point in range(count) if len(open_) else ():
            if point in open_:
                found = consistent(_single(many, point), guess)
                z[point] = numpy.nan if found is None else found
            guess = z[point] if numpy.isfinite(z[point]).all() else guess
    return z


def _newton(many: Many, z: Array, points: Array) -> set[int]:
    """Improve z at points by damped Newton; return those where it did not come to rest."""
    left, matrix, terms = many(points, z[points])
    allowed = ROUNDING
    for _ in range(STEPS):
        going = ~(numpy.abs(left) <= allowed * terms).all(axis=1)
        points, left, matrix, terms = (part[going] for part in (points, left, matrix, terms))
        if not len(points):
            break
        step, worth, share = _steps(matrix, left), _worth(left, matrix), numpy.ones(len(points))
        for _ in range(HALVINGS):
            trial = z[points] + share[:, None] * step
            found = many(points, trial)
            good = _worth(found[0], matrix) <= (1 - share / 4) * worth
            if good.all():
                break
            share = numpy.where(good, share, share / 2)
        z[points[good]] = trial[good]
        for part, fresh in zip((left, matrix, terms), found, strict=True):
            part[good] = fresh[good]
        # where nothing gets nearer it is rounding that is left, or no solution on this way
        allowed = ROUNDING if good.any() else ACCEPTED
    return set(points.tolist())


def _steps(matrix: Array, left: Array) -> Array:
    """Return Newton steps; NaN where a Jacobian is singular."""
    try:
        return numpy.asarray(numpy.linalg.solve(matrix, -left[:, :, None])[:, :, 0])
    except numpy.linalg.LinAlgError:
        rest = numpy.abs(numpy.linalg.det(matrix)) > 0
        step = numpy.full_like(left, numpy.nan)
        step[rest] = numpy.linalg.solve(matrix[rest], -left[rest][:, :, None])[:, :, 0]
        return step


def _worth(left: Array, matrix: Array) -> Array:
    rows = numpy.abs(matrix).max(axis=2)
    return numpy.asarray(numpy.linalg.norm(left / numpy.where(rows > 0, rows, 1.0), axis=1))


def _single(many: Many, point: int) -> Residual:
    at = numpy.array([point])

    def residual(z: Array) -> tuple[Array, Array, Array]:
        left, matrix, terms = many(at, z[None])
        return left[0], matrix[0], terms[0]

    return residual
