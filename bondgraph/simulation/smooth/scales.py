"""Scales: how large states and algebraic variables of a smooth model may become.

An absolute tolerance needs a size for a state that starts at zero. It is
estimated by implicit Euler steps of all lengths, from the linearised start, under
the inputs of the run; a step that is far too long for a mode lands near where the
mode comes to rest, so that stiff models give no absurd numbers. All terms count by
their size: what they cancel to, such as the output of a balanced bridge, would be
rounding.
"""

from __future__ import annotations

import numpy

from .functions import SmoothFunctions

Array = numpy.ndarray
DECADES = 12
# Of a size: what was seen far below it says little, for it was measured by it.
LEAST = 1e-6


class Sizes:
    """Sizes of states and algebraic variables, kept in step with what comes out of a run.

    Parameters
    ----------
    estimated : ((n,) array, (nz,) array)
        See `typical`.
    start : ((n,) array, (nz,) array)
        Values at the start.

    Attributes
    ----------
    x : (n,) array
    z : (nz,) array
        At least as large as all values so far.

    Examples
    --------
    >>> one = numpy.ones(1)
    >>> sizes = Sizes((1e9 * one, one[:0]), (one, one[:0]))
    >>> float(sizes.corrected()[0][0])
    1000.0
    """

    def __init__(self, estimated: tuple[Array, Array], start: tuple[Array, Array]) -> None:
        self.x, self.z = estimated
        self._seen = numpy.abs(start[0]), numpy.abs(start[1])

    def saw(self, x: Array, z: Array) -> None:
        """Take notice of values, of shape (n, k) and (nz, k), that the run has passed through."""
        self._seen = (
            numpy.fmax(self._seen[0], numpy.abs(x).max(axis=1, initial=0.0)),
            numpy.fmax(self._seen[1], numpy.abs(z).max(axis=1, initial=0.0)),
        )
        self.x, self.z = numpy.fmax(self.x, self._seen[0]), numpy.fmax(self.z, self._seen[1])

    def corrected(self) -> tuple[Array, Array] | None:
        """Return sizes nearer to what was seen, where some were far too large; else None."""
        better = _nearer(self.x, self._seen[0]), _nearer(self.z, self._seen[1])
        if numpy.array_equal(better[0], self.x) and numpy.array_equal(better[1], self.z):
            return None
        return better


def _nearer(size: Array, seen: Array) -> Array:
    """Bring sizes down to what was seen; in steps, since it was seen by their measure."""
    low = numpy.fmax(seen, LEAST * size)
    return numpy.where((size > 100 * low) & (seen > 0), low, size)


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
    settle = numpy.abs(_inverse(g_z))
    follow = _inverse(g_z) @ g_x
    matrix = f_x - f_z @ follow
    pushes = []
    for sample in samples:
        f, g, *_ = _numbers(functions, sample, x, z, p)
        shift = settle @ numpy.abs(g)
        sizes_z = _larger(sizes_z, shift)
        pushes.append(numpy.abs(f) + numpy.abs(f_z) @ shift)
    for step in span * 10.0 ** -numpy.arange(DECADES + 1):
        reach = numpy.abs(_inverse(numpy.eye(len(x)) / step - matrix))
        for push in pushes:
            sizes_x = _larger(sizes_x, reach @ push)
            sizes_z = _larger(sizes_z, numpy.abs(follow) @ reach @ push)
    return _positive(sizes_x), _positive(sizes_z)


def _numbers(
    functions: SmoothFunctions, sample: tuple[float, Array], x: Array, z: Array, p: Array
) -> list[Array]:
    t, u = sample
    f, g, *slopes = (part.full() for part in functions.slopes(t, x, z, u, p))
    return [f.ravel(), g.ravel(), *slopes]


def _inverse(matrix: Array) -> Array:
    """Invert where that can be done; nan where it cannot."""
    try:
        return numpy.linalg.inv(matrix)
    except numpy.linalg.LinAlgError:
        return numpy.full(matrix.shape, numpy.nan)


def _larger(sizes: Array, other: Array) -> Array:
    return numpy.fmax(sizes, numpy.where(numpy.isfinite(other), numpy.abs(other), 0.0))


def _positive(sizes: Array) -> Array:
    """Give what never moves the size of the smallest that does."""
    moving = sizes[sizes > 0]
    return numpy.where(sizes > 0, sizes, moving.min() if len(moving) else 1.0)
