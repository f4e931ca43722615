"""Elimination: sparse and exact, for rows that are affine in their unknowns."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import sympy

from .residues import Residues

# A coefficient larger than this becomes an assignment of its own; so does a fraction with more
# bits, since exact fractions grow with every step of an elimination.
HOIST_OPERATIONS = 40
HOIST_BITS = 256

# So many coefficients are brought to one fraction; a system with more is not for reading.
TIDY_COEFFICIENTS = 300


@dataclass(frozen=True)
class Affine:
    """Sum of coefficient times variable, plus a constant.

    Attributes
    ----------
    terms : mapping of Symbol to Expr
    constant : Expr

    Examples
    --------
    >>> x, y, a = sympy.symbols("x y a")
    >>> Affine({x: a}, sympy.S.One).plus(Affine({x: sympy.S.One, y: a}, a), -a).terms
    {y: -a**2}
    """

    terms: Mapping[sympy.Symbol, sympy.Expr]
    constant: sympy.Expr

    def plus(self, other: Affine, factor: sympy.Expr) -> Affine:
        """Add a multiple of another."""
        return combined(sympy.S.Zero, [(self, sympy.S.One), (other, factor)])

    def without(self, variable: sympy.Symbol) -> Affine:
        """Leave a variable's term out."""
        terms = {key: value for key, value in self.terms.items() if key != variable}
        return Affine(terms, self.constant)

    def scaled(self, factor: sympy.Expr) -> Affine:
        """Multiply throughout."""
        terms = {key: value * factor for key, value in self.terms.items()}
        return Affine(terms, self.constant * factor)

    def mapped(self, change: Callable[[sympy.Expr], sympy.Expr]) -> Affine:
        """Change each coefficient; what becomes zero drops out."""
        terms = {key: change(value) for key, value in self.terms.items()}
        return Affine(
            {key: value for key, value in terms.items() if value != 0}, change(self.constant)
        )

    def expression(self) -> sympy.Expr:
        """Return the sum as an expression."""
        return sympy.Add(*(value * key for key, value in self.terms.items()), self.constant)


def combined(constant: sympy.Expr, parts: Iterable[tuple[Affine, sympy.Expr]]) -> Affine:
    """Add multiples of several to a constant.

    Examples
    --------
    >>> x, y = sympy.symbols("x y")
    >>> one, two = (Affine({variable: sympy.S.One}, sympy.S.Zero) for variable in (x, y))
    >>> combined(sympy.S(3), [(one, sympy.S(2)), (two, sympy.S(5))]).expression()
    2*x + 5*y + 3
    """
    terms: dict[sympy.Symbol, sympy.Expr] = {}
    for part, factor in parts:
        for variable, value in part.terms.items():
            total = terms.get(variable, sympy.S.Zero) + factor * value
            if total != 0:
                terms[variable] = total
            else:
                terms.pop(variable, None)
        constant += factor * part.constant
    return Affine(terms, constant)


class Names:
    """Names for coefficients that have grown large, collected as assignments."""

    def __init__(self) -> None:
        self.assignments: list[tuple[sympy.Symbol, sympy.Expr]] = []
        self._residues = Residues()
        self._count = 0
        self._tidied = 0

    def is_zero(self, value: sympy.Expr) -> bool:
        """Whether a coefficient is zero, also through names."""
        return self._residues.is_zero(value)

    def named(self, value: sympy.Expr) -> sympy.Expr:
        """Return a coefficient, or its name where it is large, so that later ones stay small."""
        if not _is_large(value):
            return value
        self._count += 1
        symbol = sympy.Symbol(f"loop#{self._count}", real=True)
        self.assignments.append((symbol, value))
        self._residues.define(symbol, value)
        return symbol

    def tidied(self, value: sympy.Expr) -> sympy.Expr:
        """Return a coefficient as one fraction where it is small, zero where it is zero."""
        if value.is_Atom and not value.is_Rational:
            return value
        if self.is_zero(value):
            return sympy.S.Zero
        if not value.is_Rational and self._tidied < TIDY_COEFFICIENTS:
            self._tidied += 1
            value = tidy(value)
        return self.named(value)


def _is_large(value: sympy.Expr) -> bool:
    if value.is_Symbol:
        return False
    numbers = value.atoms(sympy.Rational)
    if any(int(n.p).bit_length() + int(n.q).bit_length() > HOIST_BITS for n in numbers):
        return True
    return not value.is_Atom and sympy.count_ops(value) > HOIST_OPERATIONS


def tidy(value: sympy.Expr) -> sympy.Expr:
    """Bring a small expression to one fraction.

    Examples
    --------
    >>> a = sympy.Symbol("a")
    >>> tidy(1 - a / (1 + a))
    1/(a + 1)
    """
    if value.is_Atom or sympy.count_ops(value) > HOIST_OPERATIONS:
        return value
    try:
        return sympy.cancel(sympy.together(value))
    except sympy.PolynomialError:
        return value


class Elimination:
    """Rows that are zero, solved for their unknowns; rows and unknowns of fewest terms first.

    Parameters
    ----------
    rows : iterable of Affine
        Each is zero.
    names : Names
        Takes the assignments of large coefficients.

    Attributes
    ----------
    solved : list of (Symbol, Affine)
        Unknowns by those solved after them.
    left : list of Expr
        What the rows left over ask to be zero.
    """

    def __init__(self, rows: Iterable[Affine], names: Names) -> None:
        self.solved: list[tuple[sympy.Symbol, Affine]] = []
        self.left: list[sympy.Expr] = []
        self._names = names
        self._rows = {index: row.mapped(names.tidied) for index, row in enumerate(rows)}
        self._users: dict[sympy.Symbol, set[int]] = {}
        for index, row in self._rows.items():
            for variable in row.terms:
                self._users.setdefault(variable, set()).add(index)
        self._queue = [(len(row.terms), index) for index, row in self._rows.items()]
        heapq.heapify(self._queue)
        while self._queue:
            length, index = heapq.heappop(self._queue)
            sparsest = self._rows.get(index)
            if sparsest is not None and len(sparsest.terms) == length:
                self._solve(index, sparsest)

    def code(self) -> list[tuple[sympy.Symbol, sympy.Expr]]:
        """Return the unknowns as ordered assignments."""
        return [(variable, form.expression()) for variable, form in reversed(self.solved)]

    def _solve(self, index: int, row: Affine) -> None:
        """Solve one row for one of its unknowns, and put that into the others."""
        del self._rows[index]
        if not row.terms:
            self.left.append(row.constant)
            return
        pivot = min(row.terms, key=lambda variable: self._cost(variable, row.terms[variable]))
        form = row.without(pivot).scaled(-1 / row.terms[pivot]).mapped(self._names.tidied)
        self.solved.append((pivot, form))
        for variable in row.terms:
            self._users[variable].discard(index)
        for other in sorted(self._users.pop(pivot)):
            before = self._rows[other]
            after = before.without(pivot).plus(form, before.terms[pivot]).mapped(self._names.tidied)
            self._replace(other, before, after)

    def _replace(self, index: int, before: Affine, after: Affine) -> None:
        self._rows[index] = after
        for variable in before.terms.keys() - after.terms.keys():
            if variable in self._users:
                self._users[variable].discard(index)
        for variable in after.terms:
            self._users[variable].add(index)
        heapq.heappush(self._queue, (len(after.terms), index))

    def _cost(self, variable: sympy.Symbol, coefficient: sympy.Expr) -> tuple[int, bool, int]:
        """Fill-in first, then plain numbers, then what is short to divide by."""
        operations = 0 if coefficient.is_number else sympy.count_ops(coefficient)
        return len(self._users[variable]), not coefficient.is_number, operations
