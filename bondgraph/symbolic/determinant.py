"""Determinants of sparse matrices of polynomials, without a division.

Rows are taken one by one, and the minors of the rows so far are kept by the
columns they use. Nothing is divided, so that nothing grows beyond the result
except where terms cancel, and a banded matrix has few minors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .limits import Budget
from .rational import Poly

Rows = Sequence[Mapping[int, Poly]]


def determinant(rows: Rows, ring: Any, budget: Budget) -> Poly:
    """Return the determinant of a square matrix of polynomials.

    Parameters
    ----------
    rows : sequence of mapping of int to Poly
        Each row's entries by column; what is missing is zero.
    ring : PolyRing
    budget : Budget

    Returns
    -------
    Poly

    Raises
    ------
    SymbolicError
        When it costs more than the budget.

    Examples
    --------
    >>> from sympy import ZZ, ring
    >>> space, a, b = ring("a, b", ZZ)
    >>> determinant([{0: a, 1: b}, {0: b, 1: a}], space, Budget("it"))
    a**2 - b**2
    """
    order, swapped = _order(rows)
    minors: dict[int, Poly] = {0: ring.one}
    for place, index in enumerate(order):
        later = 0
        for other in order[place + 1 :]:
            later |= sum(1 << column for column in rows[other])
        minors = _next_row(minors, rows[index], later, (1 << len(rows)) - 1, ring, budget)
    found = minors.get((1 << len(rows)) - 1, ring.zero)
    return -found if swapped else found


def _next_row(
    minors: Mapping[int, Poly],
    row: Mapping[int, Poly],
    later: int,
    every: int,
    ring: Any,
    budget: Budget,
) -> dict[int, Poly]:
    """Return the minors with one more row, by Laplace's expansion along it."""
    grown: dict[int, Poly] = {}
    for used, minor in minors.items():
        for column, entry in row.items():
            mask = used | 1 << column
            if mask == used or (mask | later) != every:
                continue  # a column is used twice, or can never be used any more
            budget.spend(len(minor) * len(entry))
            term = minor * entry
            if (used >> column).bit_count() % 2:
                term = -term
            grown[mask] = grown.get(mask, ring.zero) + term
    return {mask: minor for mask, minor in grown.items() if minor}


def _order(rows: Rows) -> tuple[list[int], bool]:
    """Order rows so that few columns are open at a time; tell whether that turns the sign."""
    left = list(range(len(rows)))
    order: list[int] = []
    opened: set[int] = set()
    while left:
        best = min(left, key=lambda index: (len(rows[index].keys() - opened), len(rows[index])))
        left.remove(best)
        order.append(best)
        opened |= rows[best].keys()
    inversions = sum(a > b for place, a in enumerate(order) for b in order[place + 1 :])
    return order, inversions % 2 == 1
