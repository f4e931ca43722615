"""Expressions as quotients of sparse polynomials with whole coefficients.

Whatever is no sum, product or whole power (a symbol, ``sin(x)``, ``sqrt(k)``)
counts as a generator. Denominators stay factored, so that quotients are added
without looking for common divisors, which is slow for many symbols.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Any

import sympy
from sympy.polys.rings import ring

from .images import Images
from .limits import MAX_PRODUCT, MAX_TERMS, too_large

Poly = Any  # sympy.polys.rings.PolyElement, of which sympy has no types


@dataclass(frozen=True, eq=False)
class Quotient:
    """A polynomial over a whole number and a product of polynomials.

    Attributes
    ----------
    top : Poly
    number : int
        Positive.
    factors : Counter of Poly
        Each with its power.
    """

    top: Poly
    number: int = 1
    factors: Counter[Poly] = field(default_factory=Counter)


@dataclass(frozen=True, eq=False)
class Polynomials:
    """The ring in which a set of expressions is computed.

    Attributes
    ----------
    ring : PolyRing
        Over the integers; generator 0 is the Laplace variable.
    generators : tuple of Expr
        What generators 1, 2, ... stand for.
    roots : mapping of Symbol to Expr
        Symbols of which roots occur, as powers of the generator in their place.
    relations : tuple of Poly
        Polynomials in the generators that are zero, such as sin^2 + cos^2 - 1.

    Examples
    --------
    >>> m, k = sympy.symbols("m k")
    >>> space = polynomials_over([k / m])
    >>> quotient = space.quotient(k / m + 1)
    >>> space.expression(quotient.top), [space.expression(item) for item in quotient.factors]
    (k + m, [m])
    """

    ring: Any
    generators: tuple[sympy.Expr, ...]
    roots: dict[sympy.Basic, sympy.Expr]
    relations: tuple[Poly, ...] = ()

    @property
    def back(self) -> dict[sympy.Basic, sympy.Expr]:
        """Generators that are roots of symbols, as they are shown."""
        return {item.base: symbol ** (1 / item.exp) for symbol, item in self.roots.items()}

    @property
    def shown(self) -> tuple[sympy.Expr, ...]:
        """The generators as expressions in the given symbols."""
        return tuple(item.xreplace(self.back) for item in self.generators)

    @property
    def s(self) -> Poly:
        """The Laplace variable."""
        return self.ring.gens[0]

    def quotient(self, expression: sympy.Expr) -> Quotient:
        """Write an expression as a quotient, lowest terms not promised."""
        return self._tidied(self._read(expression.xreplace(self.roots)))

    def expression(self, poly: Poly, s: sympy.Expr = sympy.S.Zero) -> sympy.Expr:
        """Write a polynomial as an expression, with a value for the Laplace variable."""
        return sympy.sympify(poly.as_expr(s, *self.shown))

    def is_zero(self, poly: Poly) -> bool:
        """Whether a polynomial is zero by the relations that are known."""
        return not self.normal(poly)

    def normal(self, poly: Poly) -> Poly:
        """Reduce a polynomial by the relations between generators."""
        return poly.rem(list(self.relations)) if self.relations and poly else poly

    def common_denominator(self, quotients: Iterable[Quotient]) -> Quotient:
        """Return one over the least denominator by which all quotients are polynomials."""
        number, factors = 1, Counter[Poly]()
        for item in quotients:
            number, factors = math.lcm(number, item.number), factors | item.factors
        return Quotient(self.ring.one, number, factors)

    def denominator(self, given: Quotient) -> Poly:
        """Return the denominator multiplied out."""
        return expanded(given.factors, self.ring.one) * given.number

    def over(self, given: Quotient, whole: Quotient) -> Poly:
        """Return a quotient times a common denominator."""
        left = expanded(whole.factors - given.factors, self.ring.one)
        return _times(given.top, left) * (whole.number // given.number)

    def _read(self, expression: sympy.Expr) -> Quotient:
        if isinstance(expression, sympy.Rational):
            return Quotient(self.ring(int(expression.p)), int(expression.q))
        if isinstance(expression, sympy.Add):
            return self._sum([self._read(item) for item in expression.args])
        if isinstance(expression, sympy.Mul):
            return reduce(_product, (self._read(item) for item in expression.args))
        base, power = _base_and_power(expression)
        if isinstance(base, sympy.exp) and base not in self.generators:
            base, power = sympy.exp(-base.args[0]), -power
        if base in self.generators:
            gen = self.ring.gens[1 + self.generators.index(base)]
            if power > 0:
                return Quotient(gen**power)
            return Quotient(self.ring.one, 1, Counter({gen: -power}))
        found = self._read(base)
        return _power(found if power > 0 else self._inverse(found), abs(power))

    def _sum(self, parts: list[Quotient]) -> Quotient:
        whole = self.common_denominator(parts)
        top = sum((self.over(part, whole) for part in parts), self.ring.zero)
        return Quotient(top, whole.number, whole.factors)

    def _inverse(self, given: Quotient) -> Quotient:
        if not given.top:
            raise ZeroDivisionError("the inverse of zero")
        content, primitive = given.top.primitive()
        if primitive.LC < 0:
            content, primitive = -content, -primitive
        monomial, rest = split_monomial(primitive)
        factors: Counter[Poly] = Counter()
        for gen, exponent in zip(self.ring.gens, monomial, strict=True):
            factors[gen] += exponent
        factors[rest] += 1
        factors.pop(self.ring.one, None)
        top = expanded(given.factors, self.ring.one) * given.number
        return Quotient(top if content > 0 else -top, abs(int(content)), +factors)

    def _tidied(self, given: Quotient) -> Quotient:
        """Divide by those factors of the denominator that go out even."""
        top, factors = cancelled(self.normal(given.top), given.factors)
        if not top:
            return Quotient(top)
        common = math.gcd(int(top.content()), given.number)
        return Quotient(top.quo_ground(common), given.number // common, factors)


def polynomials_over(expressions: Iterable[sympy.Expr]) -> Polynomials:
    """Return the ring in which all given expressions can be written.

    Parameters
    ----------
    expressions : iterable of Expr

    Returns
    -------
    Polynomials
    """
    given = [sympy.sympify(item) for item in expressions]
    roots = _roots(given)
    atoms: set[sympy.Expr] = set()
    for expression in given:
        _collect(expression.xreplace(roots), atoms)
    for atom in list(atoms):
        if _is_root(atom):
            _collect(atom.base, atoms)
    generators = tuple(sorted(_as_they_occur(atoms, given), key=_rank))
    made = ring([sympy.Dummy() for _ in range(len(generators) + 1)], sympy.ZZ)[0]
    space = Polynomials(made, generators, roots)
    return replace(space, relations=tuple(_relations(space)))


def split_monomial(poly: Poly) -> tuple[tuple[int, ...], Poly]:
    """Split off the largest monomial that divides a polynomial.

    Returns
    -------
    exponents : tuple of int
    rest : Poly
    """
    exponents = tuple(map(min, zip(*poly.itermonoms(), strict=True)))
    if not any(exponents):
        return exponents, poly
    rest = poly.ring.from_dict(
        {
            tuple(a - b for a, b in zip(monomial, exponents, strict=True)): coefficient
            for monomial, coefficient in poly.iterterms()
        }
    )
    return exponents, rest


def cancelled(top: Poly, factors: Counter[Poly]) -> tuple[Poly, Counter[Poly]]:
    """Divide a polynomial by factors as often as they go out even; return it and what is left."""
    left: Counter[Poly] = Counter()
    images = Images(len(top.ring.gens))
    for factor, power in factors.items():
        if top and len(factor) == 1:  # a generator
            often = min(power, *(monomial[factor.degrees().index(1)] for monomial in top))
            top, power = top.exquo(factor**often), power - often
        while top and power and len(factor) > 1 and images.may_divide(factor, top):
            quotient, remainder = top.div(factor)
            if remainder:
                break
            top, power = quotient, power - 1
        left[factor] = power
    return top, +left


def _base_and_power(expression: sympy.Expr) -> tuple[sympy.Expr, int]:
    """Return the generator that an atom is a whole power of, and the power."""
    if isinstance(expression, sympy.exp) and expression.args[0].could_extract_minus_sign():
        return sympy.exp(-expression.args[0]), -1
    if isinstance(expression, sympy.Pow):
        base, exponent = expression.args
        if exponent.is_Integer:
            return base, int(exponent)
        if exponent.is_Rational and exponent.p != 1:
            return sympy.Pow(base, sympy.Rational(1, exponent.q)), int(exponent.p)
        if exponent.is_Mul and exponent.could_extract_minus_sign():
            return sympy.Pow(base, -exponent), -1
    return expression, 1


def _collect(expression: sympy.Expr, atoms: set[sympy.Expr]) -> None:
    if isinstance(expression, sympy.Rational):
        return
    if isinstance(expression, sympy.Add | sympy.Mul):
        for item in expression.args:
            _collect(item, atoms)
        return
    base, power = _base_and_power(expression)
    if power == 1:
        atoms.add(base)
    else:
        _collect(base, atoms)


def _as_they_occur(
    atoms: Iterable[sympy.Expr], expressions: Iterable[sympy.Expr]
) -> Iterable[sympy.Expr]:
    """Turn exponentials of which only the inverse occurs into that: laws mostly decay."""
    inside = set().union(*(expression.atoms(sympy.exp) for expression in expressions), set())
    for atom in atoms:
        if isinstance(atom, sympy.exp) and atom not in inside:
            yield sympy.exp(-atom.args[0])
        else:
            yield atom


def _is_root(atom: sympy.Expr) -> bool:
    return isinstance(atom, sympy.Pow) and bool(atom.exp.is_Rational)


def _roots(expressions: Iterable[sympy.Expr]) -> dict[sympy.Basic, sympy.Expr]:
    """Return symbols of which roots are taken, each as a power of its least root."""
    orders: dict[sympy.Symbol, int] = {}
    for expression in expressions:
        for power in expression.atoms(sympy.Pow):
            if power.base.is_Symbol and power.exp.is_Rational and power.exp.q > 1:
                orders[power.base] = math.lcm(orders.get(power.base, 1), int(power.exp.q))
    # positive, so that powers of powers merge; the algebra is the same for either sign
    return {symbol: sympy.Dummy(positive=True) ** order for symbol, order in orders.items()}


def _rank(atom: sympy.Expr) -> tuple[int, int, object]:
    """Order generators so that relations lead with what they replace."""
    kinds = [_is_root(atom), isinstance(atom, sympy.sin), not atom.is_Symbol, True]
    return kinds.index(True), -int(sympy.count_ops(atom)), sympy.default_sort_key(atom)


def _relations(space: Polynomials) -> Iterable[Poly]:
    for atom, gen in zip(space.generators, space.ring.gens[1:], strict=True):
        if _is_root(atom):
            base = space.quotient(atom.base.xreplace(space.back))
            if not base.factors and base.number == 1:
                yield gen ** int(atom.exp.q) - base.top
        if isinstance(atom, sympy.sin) and (twin := sympy.cos(*atom.args)) in space.generators:
            yield gen**2 + space.ring.gens[1 + space.generators.index(twin)] ** 2 - 1


def _product(first: Quotient, second: Quotient) -> Quotient:
    factors = first.factors + second.factors
    return Quotient(_times(first.top, second.top), first.number * second.number, factors)


def _power(given: Quotient, power: int) -> Quotient:
    if len(given.top) > 1 and math.comb(len(given.top) + power - 1, power) > MAX_TERMS:
        raise too_large("a power of a sum")
    factors = Counter({factor: power * often for factor, often in given.factors.items()})
    return Quotient(given.top**power, given.number**power, factors)


def expanded(factors: Counter[Poly], one: Poly) -> Poly:
    """Multiply factors out."""
    return reduce(_times, factors.elements(), one)


def _times(first: Poly, second: Poly) -> Poly:
    if len(first) * len(second) > MAX_PRODUCT:
        raise too_large("a product of sums")
    return first * second
