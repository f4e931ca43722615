"""Rank decisions by orthogonal turns that keep zeros where they can."""

from __future__ import annotations

import numpy

from .realisation import EPS

Array = numpy.ndarray


def compressed(matrix: Array, tolerance: float) -> tuple[Array, int]:
    """Turn rows so that those that count come first.

    Parameters
    ----------
    matrix : (k, m) array
    tolerance : float
        What is no more than this is rounding.

    Returns
    -------
    q : (k, k) array
        Orthogonal: below its first rows ``q.T @ matrix`` is rounding.
    rank : int

    Notes
    -----
    By Householder reflections with pivoting, but a column with one entry is moved, not
    turned. A long chain of elements stays a chain then, and is reduced without
    rounding, where turning would let an error grow with every step.

    Examples
    --------
    >>> q, rank = compressed(numpy.array([[0.0], [0.0], [-2.0]]), 1e-12)
    >>> rank, q.tolist()
    (1, [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    """
    rest = matrix.copy()
    q = numpy.eye(len(matrix))
    for rank in range(min(matrix.shape)):
        sizes = numpy.linalg.norm(rest[rank:], axis=0)
        pivot = int(numpy.argmax(sizes))
        if sizes[pivot] <= tolerance:
            return q, rank
        column = rest[rank:, pivot].copy()
        column[numpy.abs(column) <= EPS * sizes[pivot]] = 0.0
        places = numpy.flatnonzero(column)
        if len(places) == 1:
            swapped = [rank + places[0], rank]
            rest[[rank, swapped[0]]] = rest[swapped]
            q[:, [rank, swapped[0]]] = q[:, swapped]
        else:
            column[0] += numpy.copysign(numpy.linalg.norm(column), column[0])
            column /= numpy.linalg.norm(column)
            rest[rank:] -= 2 * numpy.outer(column, column @ rest[rank:])
            q[:, rank:] -= 2 * numpy.outer(q[:, rank:] @ column, column)
        rest[rank + 1 :, pivot] = 0.0
    return q, min(matrix.shape)
