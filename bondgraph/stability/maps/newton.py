"""Damped Newton at many points at once; each point has its own damping and its own end.

The steps, their damping and the two conditions of an end are those of
`bondgraph.steady.solve_rates`, so that a point comes to rest where it would alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy

Array = numpy.ndarray
# Values x (k, m) at the points of an index array, to rates (k, m) and Jacobian (m, k, k).
Functions = Callable[[Array, Array], tuple[Array, Array]]

MAX_ITERATIONS = 60
SMALLEST_STEP = 1e-6
ROUNDING = 1e-9
FLOOR = 1e-13
SMALL = 1e-8
# Of an inverse times its matrix, in norm: from here on the rank is looked at.
DOUBTFUL = 1e10
RANK = 1e-12


def newton(functions: Functions, start: Array) -> tuple[Array, Array, Array]:
    """Find where rates are zero.

    Parameters
    ----------
    functions : callable
        See `Functions`.
    start : (k, m) array

    Returns
    -------
    x : (k, m) array
    found : (m,) array of bool
        Points that came to rest; the others want a longer search.
    isolated : (m,) array of bool
        Whether the Jacobian has full rank there.

    Examples
    --------
    >>> def squares(x, points):
    ...     return x**2 - 4, (2 * x.T)[:, :, None]
    >>> newton(squares, numpy.array([[1.0, 5.0]]))[0].round(9).tolist()
    [[2.0, 2.0]]
    """
    x = numpy.array(start, dtype=float)
    m = x.shape[1]
    found, isolated = numpy.zeros(m, dtype=bool), numpy.ones(m, dtype=bool)
    active = numpy.arange(m)
    with numpy.errstate(all="ignore"):
        residual, matrix = functions(x, active)
        scale = _scale(matrix)
        for iteration in range(MAX_ITERATIONS):
            usable = numpy.isfinite(matrix).all(axis=(1, 2)) & numpy.isfinite(residual).all(axis=0)
            active, residual, matrix = active[usable], residual[:, usable], matrix[usable]
            if not active.size:
                break
            here = x[:, active]
            step, full = _steps(
                matrix * (scale[None, None, :] / scale[None, :, None]), residual, scale
            )
            isolated[active] = full
            still = balanced(here, residual, matrix, scale)
            small = _small(here, step, scale)
            # where the Jacobian is singular, how far to go in the open direction is a matter of the
            # point's own scale: only what is at rest from the start is taken
            done = still & ((small & full) | (~full & (iteration == 0)))
            sharp = done & full
            x[:, active[sharp]] += step[:, sharp]  # near the root a step doubles the digits
            found[active[done]] = True
            size, residual, matrix = _damped(
                functions, (here, active), step, (residual, matrix), done
            )
            stuck = ~done & (size == 0)
            found[active[stuck & still & full]] = True
            x[:, active] = numpy.where(done | stuck, x[:, active], here + size * step)
            going = ~done & ~stuck & full
            active, residual, matrix = active[going], residual[:, going], matrix[going]
    return x, found, isolated


def balanced(x: Array, residual: Array, matrix: Array, scale: Array | None = None) -> Array:
    """Whether rates are rounding noise beside the terms they are made of, point by point.

    Parameters
    ----------
    x, residual : (k, m) array
    matrix : (m, k, k) array
    scale : (k,) array, optional
        Sizes in which states are measured.

    Returns
    -------
    (m,) array of bool
    """
    sizes = numpy.abs(x)
    steep = numpy.abs(matrix)
    terms = numpy.matmul(steep, sizes.T[:, :, None])[:, :, 0].T
    limit = ROUNDING * terms
    if scale is not None:
        steepest = (steep * (scale[None, None, :] / scale[None, :, None])).max(axis=(1, 2))
        limit += FLOOR * steepest * (sizes / scale[:, None]).max(axis=0) * scale[:, None]
    return numpy.asarray((numpy.abs(residual) <= limit).all(axis=0))


def _small(x: Array, step: Array, scale: Array) -> Array:
    """Whether steps are small beside the states."""
    reach = numpy.abs(x / scale[:, None]).max(axis=0)
    return numpy.asarray(numpy.abs(step / scale[:, None]).max(axis=0) <= SMALL * reach)


def _scale(matrix: Array) -> Array:
    """Return sizes of states that balance the Jacobian, as at the first point that has one."""
    good = numpy.flatnonzero(numpy.isfinite(matrix).all(axis=(1, 2)))
    return balancing(matrix[good[0]]) if good.size else numpy.ones(matrix.shape[1])


def balancing(matrix: Array) -> Array:
    """Return sizes of states in which a matrix is balanced; ones where it is not finite.

    Examples
    --------
    >>> scale = balancing(numpy.array([[1.0, 1e-4], [1e4, 1.0]]))
    >>> float(scale[1] / scale[0])
    8192.0
    """
    import scipy.linalg

    if not matrix.size or not numpy.isfinite(matrix).all():
        return numpy.ones(len(matrix))
    _, transform = scipy.linalg.matrix_balance(matrix, permute=False)
    return numpy.asarray(numpy.diag(transform), dtype=float)


def _steps(matrix: Array, residual: Array, scale: Array) -> tuple[Array, Array]:
    """Return Newton steps, and whether the Jacobian determines them."""
    right = -(residual / scale[:, None]).T[:, :, None]
    full = numpy.ones(len(matrix), dtype=bool)
    try:
        inverse = numpy.linalg.inv(matrix)
        norm = numpy.linalg.norm(matrix, axis=(1, 2)) * numpy.linalg.norm(inverse, axis=(1, 2))
        full = numpy.isfinite(norm) & (norm < DOUBTFUL)
        step = numpy.linalg.solve(matrix, right)
    except numpy.linalg.LinAlgError:
        full[:] = False
        step = numpy.zeros_like(right)
    if not full.all():
        doubtful = ~full
        sizes = numpy.linalg.svd(matrix[doubtful], compute_uv=False)
        step[doubtful] = numpy.linalg.pinv(matrix[doubtful], rcond=RANK) @ right[doubtful]
        full[doubtful] = sizes[:, -1] > RANK * sizes[:, 0]
    return step[:, :, 0].T * scale[:, None], full


def _damped(
    functions: Functions,
    at: tuple[Array, Array],
    step: Array,
    before: tuple[Array, Array],
    done: Array,
) -> tuple[Array, Array, Array]:
    """Return the share of each step that lessens what is left, zero where none, with what is left."""
    (x, points), (residual, matrix) = at, before
    rows = _largest(matrix)
    worth = _worth(residual, rows)
    size = numpy.zeros(len(points))
    residual, matrix = residual.copy(), matrix.copy()
    waiting = numpy.flatnonzero(~done & numpy.isfinite(step).all(axis=0))
    share = 1.0
    while waiting.size and share > SMALLEST_STEP:
        trial, slopes = functions(x[:, waiting] + share * step[:, waiting], points[waiting])
        less = _worth(trial, rows[:, waiting]) <= (1 - share / 4) * worth[waiting]
        better = waiting[less & numpy.isfinite(trial).all(axis=0)]
        if better.size:
            taken = numpy.isin(waiting, better)
            size[better] = share
            residual[:, better], matrix[better] = trial[:, taken], slopes[taken]
            waiting = waiting[~taken]
        share /= 2
    return size, residual, matrix


def _worth(residual: Array, rows: Array) -> Array:
    return numpy.asarray(numpy.linalg.norm(residual / rows, axis=0))


def _largest(matrix: Array) -> Array:
    rows = numpy.abs(matrix).max(axis=2, initial=0.0).T
    return numpy.where(rows > 0, rows, 1.0)
