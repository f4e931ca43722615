"""Determinants of ``s I - A`` and of the pencil that borders it with an input and an output."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import sympy

from .common import lowest_terms
from .determinant import determinant
from .limits import Budget
from .polynomial import split
from .rational import Poly, Polynomials, cancelled, polynomials_over, split_monomial
from .signs import Signs


def characteristic_factors(a: sympy.Matrix) -> tuple[Polynomials, list[Poly]]:
    """Return factors of ``det(s I - A)``, one for each block of states that move together.

    Parameters
    ----------
    a : (n, n) Matrix

    Returns
    -------
    space : Polynomials
    factors : list of Poly
        Without denominators and common numbers; none for a system without states.

    Raises
    ------
    SymbolicError
        When they are too large.

    Examples
    --------
    >>> k, m = sympy.symbols("k m", positive=True)
    >>> space, (factor,) = characteristic_factors(sympy.Matrix([[0, -k], [1 / m, 0]]))
    >>> space.expression(factor, sympy.Symbol("s"))
    k + m*s**2
    """
    space = polynomials_over(a)
    budget = Budget("the characteristic polynomial")
    factors = []
    for block in a.strongly_connected_components():
        part = a.extract(block, block)
        found = _resolvent(space, part, budget)[0]
        budget.check(len(found))
        found = _primitive(space, found)
        factors.append(_without_denominators(space, part, found))
    return space, factors


def transfer_quotient(
    a: sympy.Matrix, columns: Sequence[tuple[sympy.Matrix, sympy.Expr]], c: sympy.Matrix
) -> tuple[Polynomials, Poly, Poly]:
    """Return ``c (s I - A)^-1 b + d`` as two polynomials without a common divisor.

    Parameters
    ----------
    a : (n, n) Matrix
    columns : sequence of ((n, 1) Matrix, Expr)
        b and d; those of the input's rate follow, then those of its second rate.
    c : (1, n) Matrix

    Returns
    -------
    space : Polynomials
    numerator, denominator : Poly

    Raises
    ------
    SymbolicError
        When they are too large.

    Examples
    --------
    >>> m, b = sympy.symbols("m b", positive=True)
    >>> a, c = sympy.Matrix([[-b / m]]), sympy.Matrix([[1 / m]])
    >>> space, top, bottom = transfer_quotient(a, [(sympy.Matrix([1]), sympy.S.Zero)], c)
    >>> [space.expression(item, sympy.Symbol("s")) for item in (top, bottom)]
    [1, b + m*s]
    """
    kept = _between(a, [b for b, _ in columns], c)
    a, c = a.extract(kept, kept), c.extract([0], kept)
    columns = [(b.extract(kept, [0]), d) for b, d in columns]
    entries = [*a, *c, *(item for b, d in columns for item in (*b, d))]
    space = polynomials_over(entries)
    budget = Budget("the transfer function")
    bottom, rows = _resolvent(space, a, budget, c)
    border, scale = _border(space, columns)
    bordered = [
        {**row, len(kept): entry} if entry else row for row, entry in zip(rows, border, strict=True)
    ]
    top = space.normal(determinant(bordered, space.ring, budget))
    budget.spend(len(bottom) * len(scale))
    for item in (top, bottom):
        budget.check(len(item))
    top, bottom = lowest_terms(top, bottom * scale)
    if Signs(space, {}).of(split(bottom)[0]).value == -1:
        top, bottom = -top, -bottom
    return space, top, bottom


Rows = list[dict[int, Poly]]


def _resolvent(
    space: Polynomials, a: sympy.Matrix, budget: Budget, c: sympy.Matrix | None = None
) -> tuple[Poly, Rows]:
    """Return ``det(s I - A)`` and the rows of ``s I - A`` over c, each column freed of denominators."""
    count = a.rows
    rows: Rows = [{} for _ in range(count + (c is not None))]
    for place in range(count):
        column = [-entry for entry in a[:, place]] + ([c[place]] if c is not None else [])
        quotients = [space.quotient(entry) for entry in column]
        whole = space.common_denominator(quotients)
        for row, item in enumerate(quotients):
            entry = space.over(item, whole)
            if row == place:
                entry += space.s * space.denominator(whole)
            if entry:
                rows[row][place] = entry
    return space.normal(determinant(rows[:count], space.ring, budget)), rows


def _border(
    space: Polynomials, columns: Sequence[tuple[sympy.Matrix, sympy.Expr]]
) -> tuple[list[Poly], Poly]:
    """Return ``(-b, d)`` as a column of polynomials, and the denominator that it was freed of."""
    powers = [[space.quotient(item) for item in (*-b, d)] for b, d in columns]
    whole = space.common_denominator([item for column in powers for item in column])
    border = [
        sum(
            (space.over(item, whole) * space.s**power for power, item in enumerate(entries)),
            space.ring.zero,
        )
        for entries in zip(*powers, strict=True)
    ]
    return border, space.denominator(whole)


def _primitive(space: Polynomials, poly: Poly) -> Poly:
    """Drop what all coefficients share: numbers and generators, but not the Laplace variable."""
    powers, rest = split_monomial(poly.primitive()[1])
    return rest * space.s ** powers[0]


def _without_denominators(space: Polynomials, a: sympy.Matrix, poly: Poly) -> Poly:
    """Divide by factors of denominators that have gone out of the determinant again."""
    whole = space.common_denominator([space.quotient(entry) for entry in a])
    return cancelled(poly, Counter({item: poly.degree() + 1 for item in whole.factors}))[0]


def _between(a: sympy.Matrix, sources: Sequence[sympy.Matrix], c: sympy.Matrix) -> list[int]:
    """Return the states that the input moves and the output sees: others cancel."""
    reached = {place for place in range(a.rows) if any(b[place] != 0 for b in sources)}
    seen = {place for place in range(a.rows) if c[place] != 0}
    for _ in range(a.rows):
        reached |= {i for i in range(a.rows) if any(a[i, j] != 0 for j in reached)}
        seen |= {j for j in range(a.rows) if any(a[i, j] != 0 for i in seen)}
    return sorted(reached & seen)
