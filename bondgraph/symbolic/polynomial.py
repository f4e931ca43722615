"""A polynomial in the Laplace variable whose coefficients are expressions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy

from ..codegen.to_latex import latex
from .limits import SymbolicError
from .rational import Poly, Polynomials, polynomials_over
from .tidy import factored, factors, ratio, tidy


@dataclass(frozen=True)
class Polynomial:
    r"""A polynomial in one variable.

    Attributes
    ----------
    coefficients : tuple of Expr
        Highest power first; the first is not zero, unless it is the only one.
    variable : Symbol
        The Laplace variable, 1/s.
    names : mapping of Symbol to str
        LaTeX of the symbols, where it is not that of their names.

    Examples
    --------
    >>> m, b, k, s = sympy.symbols("m b k s", positive=True)
    >>> polynomial = Polynomial((m, b, k), s)
    >>> polynomial.degree, polynomial.expression
    (2, b*s + k + m*s**2)
    >>> print(polynomial.to_latex())
    m \, s^{2} + b \, s + k
    """

    coefficients: tuple[sympy.Expr, ...]
    variable: sympy.Symbol
    names: Mapping[sympy.Basic, str] = field(default_factory=dict, repr=False, compare=False)

    @property
    def degree(self) -> int:
        """The highest power."""
        return len(self.coefficients) - 1

    @property
    def expression(self) -> sympy.Expr:
        """The polynomial as a sum of powers."""
        return sympy.Add(*(number * power for number, power in self._terms()))

    def roots(self) -> dict[sympy.Expr, int]:
        """Return the roots and how often each occurs, where they have a closed form.

        Returns
        -------
        dict of Expr to int

        Raises
        ------
        SymbolicError
            Where a factor is of third degree or higher.

        Examples
        --------
        >>> k, m = sympy.symbols("k m", positive=True)
        >>> Polynomial((m, 0, k, 0), sympy.Symbol("s")).roots()
        {0: 1, -I*sqrt(k)/sqrt(m): 1, I*sqrt(k)/sqrt(m): 1}
        """
        space = polynomials_over(self.coefficients)
        found: Counter[sympy.Expr] = Counter()
        for factor, power in factors(from_coefficients(space, self.coefficients)):
            for root in _closed(space, factor, self.variable):
                found[root] += power
        return dict(sorted(found.items(), key=lambda item: item[0] != 0))

    def to_latex(self) -> str:
        """Write the polynomial as LaTeX, highest power first."""
        shown: list[str] = []
        for number, power in self._terms():
            text = _term(number, power, self.names)
            shown.append(text if text.startswith("-") or not shown else f"+ {text}")
        return " ".join(shown) or "0"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.to_latex()}$"

    def __str__(self) -> str:
        shown = [_plain(number, power) for number, power in self._terms()]
        return " + ".join(shown).replace("+ -", "- ").replace("**", "^") or "0"

    def _terms(self) -> list[tuple[sympy.Expr, sympy.Expr]]:
        powers = range(self.degree, -1, -1)
        pairs = zip(self.coefficients, powers, strict=True)
        terms = [(sympy.sympify(number), self.variable**power) for number, power in pairs]
        return [term for term in terms if term[0] != 0]


def from_coefficients(space: Polynomials, coefficients: Any) -> Poly:
    """Return coefficients, highest power first, as one polynomial without denominators."""
    quotients = [space.quotient(sympy.sympify(item)) for item in coefficients]
    whole = space.common_denominator(quotients)
    found = space.ring.zero
    for item in quotients:
        found = found * space.s + space.over(item, whole)
    return found


def read(poly: Poly, space: Polynomials, s: sympy.Symbol, **extra: Any) -> Polynomial:
    """Return a polynomial of the ring as a value for reading."""
    return Polynomial(tuple(factored(space, item) for item in split(poly)), s, **extra)


def monic(poly: Poly, space: Polynomials, s: sympy.Symbol, **extra: Any) -> Polynomial:
    """Return a polynomial of the ring divided by its leading coefficient."""
    first, *others = split(poly)
    return Polynomial((sympy.S.One, *(ratio(space, item, first) for item in others)), s, **extra)


def split(poly: Poly) -> list[Poly]:
    """Return the coefficients of the Laplace variable's powers, highest first.

    Examples
    --------
    >>> from sympy import ZZ, ring
    >>> _, s, a = ring("s, a", ZZ)
    >>> split(a * s**2 + 1)
    [a, 0, 1]
    """
    ring = poly.ring
    found: dict[int, dict[tuple[int, ...], int]] = {}
    for monomial, number in poly.iterterms():
        found.setdefault(monomial[0], {})[(0, *monomial[1:])] = number
    return [ring.from_dict(found.get(power, {})) for power in range(max(found, default=0), -1, -1)]


def _closed(space: Polynomials, factor: Poly, s: sympy.Symbol) -> list[sympy.Expr]:
    """Return the roots of a factor of at most second degree."""
    numbers = [factored(space, item) for item in split(factor)]
    if len(numbers) == 1:
        return []
    if len(numbers) == 2:
        return [tidy(-numbers[1] / numbers[0])]
    if len(numbers) == 3:
        a, b, c = numbers
        middle, spread = tidy(-b / (2 * a)), sympy.sqrt(tidy((b**2 - 4 * a * c) / (4 * a**2)))
        return [middle - spread, middle + spread]
    raise SymbolicError(
        f"a factor of degree {len(numbers) - 1} in {s} has no closed form for its roots; "
        f"use routh_hurwitz() for stability, or linearize(...).poles() for numbers"
    )


def _plain(number: sympy.Expr, power: sympy.Expr) -> str:
    if power == 1:
        return str(number)
    if number in (1, -1):
        return f"{'-' if number == -1 else ''}{power}"
    return f"({number})*{power}" if number.is_Add else f"{number}*{power}"


def _term(number: sympy.Expr, power: sympy.Expr, names: Mapping[sympy.Basic, str]) -> str:
    if power == 1:
        return latex(number, names)
    if number in (1, -1):
        return ("-" if number == -1 else "") + latex(power, names)
    shown = latex(number, names)
    if number.is_Add:
        shown = rf"\left({shown}\right)"
    return rf"{shown} \, {latex(power, names)}"
