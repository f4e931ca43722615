"""Gain at frequency zero, through integrators."""

from __future__ import annotations

import numpy

from .realisation import EPS, Realisation

Array = numpy.ndarray


def static_gain(given: Realisation) -> Array:
    """Return the limit of a transfer as s goes to zero from above.

    Parameters
    ----------
    given : Realisation

    Returns
    -------
    (k, m) array
        Infinite, with its sign, where an integrator lies between input and output. One
        that lies elsewhere does not matter.

    Examples
    --------
    >>> one = numpy.eye(1)
    >>> static_gain(Realisation(0 * one, one, -one, (one,))).tolist()
    [[-inf]]
    """
    import scipy.linalg

    if not given.order:
        return given.direct[0].copy()
    scale, a = _balanced(given.A)
    b, c = given.B / scale[:, None], given.C * scale
    turn, zeros = deflated(a)
    a, b, c = turn.T @ a @ turn, turn.T @ b, c @ turn
    rest = slice(zeros, None)
    gain = given.direct[0].copy()
    if zeros < len(a):
        if zeros:  # part the integrators from the rest: A0 X - X A1 = -A01
            x = scipy.linalg.solve_sylvester(a[:zeros, :zeros], -a[rest, rest], -a[:zeros, rest])
            c[:, rest] = c[:, rest] + c[:, :zeros] @ x
            b[:zeros] = b[:zeros] - x @ b[rest]
        gain = gain - c[:, rest] @ numpy.linalg.solve(a[rest, rest], b[rest])
    inner, outer, slope = b[:zeros], c[:, :zeros], a[:zeros, :zeros]
    sizes = numpy.linalg.norm(outer, axis=1)[:, None] * numpy.linalg.norm(inner, axis=0)
    for power in range(zeros):  # C0 A0^k B0 / s^(k + 1), the highest power last
        part = outer @ inner
        counts = numpy.abs(part) > 1e3 * EPS * len(a) * sizes * numpy.abs(a).max() ** power
        gain = numpy.where(counts, numpy.copysign(numpy.inf, part), gain)
        inner = slope @ inner
    return gain


def _balanced(a: Array) -> tuple[Array, Array]:
    import scipy.linalg

    scaled, (scale, _) = scipy.linalg.matrix_balance(a, permute=False, separate=True)
    return scale, scaled


def deflated(a: Array, size: float = 0.0) -> tuple[Array, int]:
    """Return an orthogonal matrix whose first columns span what decays to nothing under powers of A.

    That is the space of the eigenvalue zero, found by ranks: eigenvalues of a chain
    of integrators would be off by far more than rounding.

    Parameters
    ----------
    a : (n, n) array
        Balanced.
    size : float
        Entries are known to the rounding of this; of the largest unless that is larger.

    Returns
    -------
    turn : (n, n) array
    zeros : int
        Dimension of that space.
    """
    n = len(a)
    turn, zeros = numpy.eye(n), 0
    tolerance = 20 * EPS * n * numpy.abs(a).max(initial=size)
    rest = a
    while zeros < n:
        _, sizes, rows = numpy.linalg.svd(rest)
        found = int((sizes <= tolerance).sum())
        if not found:
            break
        q = numpy.vstack([rows[len(rows) - found :], rows[: len(rows) - found]]).T
        turn[:, zeros:] = turn[:, zeros:] @ q
        rest = (q.T @ rest @ q)[found:, found:]
        zeros += found
    return turn, zeros
