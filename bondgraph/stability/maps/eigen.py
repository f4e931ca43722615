"""Eigenvalues of many matrices of one pattern, block by block."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy

from ...blocks.components import components
from .small import eigvals

Array = numpy.ndarray


def diagonal_blocks(rows: Array, columns: Array, size: int) -> list[list[int]]:
    """Group the rows of a pattern so that its matrices are block triangular.

    Parameters
    ----------
    rows, columns : (nnz,) array of int
    size : int

    Returns
    -------
    list of list of int
        The eigenvalues are those of the blocks: what a state decides without hearing from it
        again needs no larger problem.

    Examples
    --------
    >>> diagonal_blocks(numpy.array([0, 1, 1]), numpy.array([0, 0, 1]), 2)
    [[0], [1]]
    """
    needs: list[list[int]] = [[] for _ in range(size)]
    for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
        if row != column:
            needs[row].append(column)
    return components(needs)


def eigenvalues(
    entries: Sequence[Any],
    rows: Array,
    columns: Array,
    blocks: Sequence[Sequence[int]],
    m: int,
    compiled: bool = False,
) -> Array:
    """Return the eigenvalues of matrices given by the nonzeros of their pattern.

    Parameters
    ----------
    entries : sequence of float or (m,) array
        Finite.
    rows, columns : (nnz,) array of int
    blocks : sequence of sequence of int
        From `diagonal_blocks`.
    m : int
    compiled : bool
        See `eigvals`.

    Returns
    -------
    (m, n) complex array
        Each row by falling real part, of a pair the one with positive imaginary part first.

    Examples
    --------
    >>> at = numpy.array([0, 1]), numpy.array([1, 0])
    >>> found = eigenvalues([-4.0, numpy.array([1.0, -1.0])], *at, [[0, 1]], 2)
    >>> found.round(12).tolist()
    [[2j, -2j], [(2+0j), (-2+0j)]]
    """
    found = numpy.zeros((m, sum(map(len, blocks))), dtype=complex)
    first = 0
    for block in blocks:
        place = {member: index for index, member in enumerate(block)}
        matrix = numpy.zeros((m, len(block), len(block)))
        for row, column, value in zip(rows.tolist(), columns.tolist(), entries, strict=True):
            if row in place and column in place:
                matrix[:, place[row], place[column]] = value
        own = matrix[:, :, 0] if len(block) == 1 else eigvals(matrix, compiled)
        found[:, first : first + len(block)] = own
        first += len(block)
    return falling(found)


def falling(values: Array) -> Array:
    """Sort each row by falling real part, of a pair the one with positive imaginary part first."""
    return -numpy.sort(-values, axis=1)
