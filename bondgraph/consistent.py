"""Consistent values: algebraic variables that fulfil their equations, found by Newton.

Knows numbers only. `Residual` gives, at values of the variables, what is left of
each equation, its Jacobian, and the size of the terms that cancel in it, so that
rounding can be told from a real remainder.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy

Array = numpy.ndarray
# Values z of shape (n,) to what is left (n,), the Jacobian (n, n), the size of the terms (n,).
Residual = Callable[[Array], tuple[Array, Array, Array]]

# An exponential law is left by one unit of its exponent a step.
MAX_ITERATIONS = 500
SMALLEST_DAMPING = 1e-8
ROUNDING = 1e-14
ACCEPTED = 1e-11
RANDOM_SIZES = (1e-3, 1.0, 1e3)


def consistent(residual: Residual, guess: Array) -> Array | None:
    """Solve for algebraic variables, starting from a guess and from others where it fails.

    Tried in turn, until one succeeds: Newton from the guess and from zero; a
    homotopy from each, along which the remainder of the start fades away; Newton
    from random values of several sizes, the same in each call.

    Parameters
    ----------
    residual : callable
        See `Residual`.
    guess : (n,) array
        Where the equations have several solutions, it decides which is found.

    Returns
    -------
    (n,) array or None
        None where no start leads to a solution.

    Examples
    --------
    >>> def cubic(z):
    ...     return z**3 + z - 10, numpy.diag(3 * z**2 + 1), abs(z**3) + 10
    >>> consistent(cubic, numpy.zeros(1)).round(12).tolist()
    [2.0]
    """
    guess = numpy.array(guess, dtype=float)
    if not guess.size:
        return guess
    with numpy.errstate(all="ignore"):  # trial values may overflow; they are turned down
        return _searched(residual, guess)


def _searched(residual: Residual, guess: Array) -> Array | None:
    starts = [guess, numpy.zeros_like(guess)] if guess.any() else [guess]
    for start in starts:
        found = newton(residual, start)
        if found is not None:
            return found
    for start in starts:
        found = _homotopy(residual, start)
        if found is not None:
            return found
    for start in _random(guess):
        found = newton(residual, start)
        if found is not None:
            return found
    return None


def newton(residual: Residual, start: Array) -> Array | None:
    """Solve by Newton, damped so that each step lessens what is left.

    Parameters
    ----------
    residual : callable
        See `Residual`.
    start : (n,) array

    Returns
    -------
    (n,) array or None
        None where the search comes to rest before what is left is small beside
        the terms it consists of.

    Examples
    --------
    >>> def no_root(z):
    ...     return z**2 + 1, numpy.diag(2 * z), z**2 + 1
    >>> newton(no_root, numpy.ones(1)) is None
    True
    """
    z = numpy.array(start, dtype=float)
    left, matrix, terms = residual(z)
    for _ in range(MAX_ITERATIONS):
        step = _step(matrix, left)
        if step is None:
            return None
        if numpy.all(numpy.abs(left) <= ROUNDING * terms):
            return z
        rows = _rows(matrix)
        worth = numpy.linalg.norm(left / rows)
        size = 1.0
        while size > SMALLEST_DAMPING:
            trial = residual(z + size * step)
            good = all(numpy.isfinite(part).all() for part in trial)
            if good and numpy.linalg.norm(trial[0] / rows) <= (1 - size / 4) * worth:
                break
            size /= 2
        else:  # nothing gets nearer: rounding, or no solution
            return z if numpy.all(numpy.abs(left) <= ACCEPTED * terms) else None
        z = z + size * step
        left, matrix, terms = trial
    return None


def _step(matrix: Array, left: Array) -> Array | None:
    """Return the Newton step; the shortest one where the Jacobian is singular."""
    if not (numpy.isfinite(matrix).all() and numpy.isfinite(left).all()):
        return None
    rows = _rows(matrix)
    try:
        step = numpy.linalg.solve(matrix / rows[:, None], -left / rows)
    except numpy.linalg.LinAlgError:
        step = numpy.linalg.lstsq(matrix / rows[:, None], -left / rows, rcond=1e-12)[0]
    return step if numpy.isfinite(step).all() else None


def _rows(matrix: Array) -> Array:
    largest = numpy.abs(matrix).max(axis=1, initial=0.0)
    return numpy.where(largest > 0, largest, 1.0)


def _homotopy(residual: Residual, start: Array) -> Array | None:
    """Let the remainder at the start fade away, following the solution by Newton."""
    offset = residual(start)[0]
    if not numpy.isfinite(offset).all():
        return None
    z, share, stride = start, 1.0, 0.25
    while stride > 1e-6:
        target = max(share - stride, 0.0)

        def shifted(trial: Array, target: float = target) -> tuple[Array, Array, Array]:
            left, matrix, terms = residual(trial)
            return left - target * offset, matrix, terms + target * numpy.abs(offset)

        found = newton(shifted, z)
        if found is None:
            stride /= 4
            continue
        z, share = found, target
        if share == 0.0:
            return z
        stride *= 2
    return None


def _random(guess: Array) -> Iterator[Array]:
    draw = numpy.random.default_rng(0)
    for size in RANDOM_SIZES:
        for _ in range(4):
            yield guess + size * draw.standard_normal(len(guess))
