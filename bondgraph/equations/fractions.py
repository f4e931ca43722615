"""Assignments worked out as fractions of polynomials, so that what cancels does so on the way.

Expanding assignments first and simplifying the result takes long where many terms cancel: a mesh of
capacitors comes out as thousands of operations for a sum of nine. In a field of fractions each step is
in lowest terms.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import sympy
from sympy.polys.fields import FracElement, FracField

Assignments = Sequence[tuple[sympy.Symbol, sympy.Expr]]

MOST_GENERATORS = 40


def fractions(assignments: Assignments, wanted: Sequence[sympy.Expr]) -> list[sympy.Expr] | None:
    """Expand expressions in lowest terms.

    Functions and roots count as quantities of their own, with their arguments expanded.

    Parameters
    ----------
    assignments : sequence of (Symbol, Expr)
        Ordered.
    wanted : sequence of Expr
        In assigned and given symbols.

    Returns
    -------
    list of Expr or None
        None where there are too many quantities for fractions to be worth while.

    Examples
    --------
    >>> x, y, z = sympy.symbols("x y z")
    >>> fractions([(y, x / (1 + x)), (z, 1 / y)], [z - 1 / x])
    [1]
    """
    needed = _needed(assignments, wanted)
    work = _Work([expression for _, expression in needed] + list(wanted), dict(needed))
    if len(work.generators) > MOST_GENERATORS:
        return None
    field = FracField(work.generators, sympy.QQ) if work.generators else None
    if field is None:
        return None
    known = {
        generator: element for generator, element in zip(work.generators, field.gens, strict=True)
    }
    for symbol, expression in needed:
        known[symbol] = work.element(expression, known, field)
    return [work.element(expression, known, field).as_expr() for expression in wanted]


def _needed(assignments: Assignments, wanted: Iterable[sympy.Expr]) -> Assignments:
    symbols: set[sympy.Basic] = set()
    for expression in wanted:
        symbols |= expression.free_symbols
    kept = []
    for symbol, expression in reversed(assignments):
        if symbol in symbols:
            symbols |= expression.free_symbols
            kept.append((symbol, expression))
    return kept[::-1]


class _Work:
    """The quantities that fractions are made of, and the expressions behind functions."""

    def __init__(
        self, expressions: Sequence[sympy.Expr], table: dict[sympy.Symbol, sympy.Expr]
    ) -> None:
        self._expanded: dict[sympy.Symbol, sympy.Expr] = {}
        self._table = table
        self._atoms: dict[sympy.Expr, sympy.Expr] = {}
        found: dict[sympy.Expr, None] = {}
        for symbol, expression in table.items():
            self._expanded[symbol] = expression.xreplace(self._expanded)
        for expression in expressions:
            self._collect(expression, found)
        self.generators = sorted(found, key=sympy.default_sort_key)

    def _collect(self, expression: sympy.Expr, found: dict[sympy.Expr, None]) -> None:
        if expression.is_Symbol:
            if expression not in self._table:
                found[expression] = None
        elif expression.is_Add or expression.is_Mul or _is_power(expression):
            for part in expression.args[:1] if expression.is_Pow else expression.args:
                self._collect(part, found)
        elif not expression.is_Rational:
            atom = expression.xreplace(self._expanded)
            self._atoms[expression] = atom
            found[atom] = None

    def element(
        self,
        expression: sympy.Expr,
        known: dict[sympy.Expr, FracElement],
        field: FracField,
    ) -> FracElement:
        """Return an expression as an element of the field."""
        if expression in self._atoms:
            return known[self._atoms[expression]]
        if expression in known:
            return known[expression]
        if expression.is_Rational:
            return field.ground_new(sympy.QQ(int(expression.p), int(expression.q)))
        parts = (
            self.element(part, known, field)
            for part in expression.args[: 1 if expression.is_Pow else None]
        )
        if expression.is_Add:
            return sum(parts, field.zero)
        if expression.is_Mul:
            product = field.one
            for part in parts:
                product *= part
            return product
        return next(iter(parts)) ** int(expression.exp)


def _is_power(expression: sympy.Expr) -> bool:
    return bool(expression.is_Pow and expression.exp.is_Integer)
