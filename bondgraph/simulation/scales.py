"""Scales: how large states and algebraic variables of a smooth model may become.

An absolute tolerance needs a size for a state that starts at zero. It is
estimated by implicit Euler steps of all lengths, from the linearised start, under
the inputs of the run; a step that is far too long for a mode lands near where the
mode comes to rest, so that stiff models give no absurd numbers.
"""

from __future__ import annotations

import numpy

from .dae import SmoothFunctions

Array = numpy.ndarray
DECADES = 12


def typical(
    functions: SmoothFunctions,
    samples: list[tuple[float, Array]],
    start: tuple[Array, Array],
    p: Array,
    span: float,
) -> tuple[Array, Array]:
    """Estimate the size of each state and algebraic variable over a run.

    Parameters
    ----------
    functions : SmoothFunctions
    samples : list of (float, (m,) array)
        Times and inputs that occur in the run, the start first.
    start : ((n,) array, (nz,) array)
        States and algebraic variables at the start.
    p : (np,) array
    span : float
        Length of the run, s.

    Returns
    -------
    x : (n,) array
        Positive.
    z : (nz,) array
        Positive.
    """
    x, z = start
    sizes_x, sizes_z = numpy.abs(x), numpy.abs(z)
    _, _, f_x, f_z, g_x, g_z = _numbers(functions, samples[0], x, z, p)
    follow = _solved(g_z, g_x)
    matrix = f_x - f_z @ follow
    steps = span * 10.0 ** -numpy.arange(DECADES + 1)
    for sample in samples:
        f, g, *_ = _numbers(functions, sample, x, z, p)
        shift = -_solved(g_z, g[:, None])[:, 0]
        push = f + f_z @ shift
        sizes_z = _larger(sizes_z, shift)
        for step in steps:
            change = _solved(numpy.eye(len(x)) / step - matrix, push[:, None])[:, 0]
            sizes_x = _larger(sizes_x, change)
            sizes_z = _larger(sizes_z, follow @ change)
    return _positive(sizes_x), _positive(sizes_z)


def _numbers(
    functions: SmoothFunctions, sample: tuple[float, Array], x: Array, z: Array, p: Array
) -> list[Array]:
    t, u = sample
    f, g, *slopes = (part.full() for part in functions.slopes(t, x, z, u, p))
    return [f.ravel(), g.ravel(), *slopes]


def _solved(matrix: Array, right: Array) -> Array:
    """Solve where that can be done; nan where it cannot."""
    if not len(matrix):
        return numpy.zeros(right.shape)
    try:
        return numpy.linalg.solve(matrix, right)
    except numpy.linalg.LinAlgError:
        return numpy.full(right.shape, numpy.nan)


def _larger(sizes: Array, other: Array) -> Array:
    return numpy.fmax(sizes, numpy.where(numpy.isfinite(other), numpy.abs(other), 0.0))


def _positive(sizes: Array) -> Array:
    """Give what never moves the size of the smallest that does."""
    moving = sizes[sizes > 0]
    return numpy.where(sizes > 0, sizes, moving.min() if len(moving) else 1.0)
