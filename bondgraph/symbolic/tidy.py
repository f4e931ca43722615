"""Polynomials and quotients written for reading: cancelled, and factored where that is quick."""

from __future__ import annotations

import math

import sympy

from .common import lowest_terms
from .limits import FACTOR_DENSE, FACTOR_TERMS, SymbolicError
from .rational import Poly, Polynomials, polynomials_over, split_monomial


def tidy(expression: sympy.Expr) -> sympy.Expr:
    """Cancel what cancels, and keep the shorter of the two forms.

    Parameters
    ----------
    expression : Expr

    Returns
    -------
    Expr
        Equal to the given one.

    Raises
    ------
    SymbolicError
        If the expression is not finite.

    Examples
    --------
    >>> a, b = sympy.symbols("a b")
    >>> tidy(a / (a + b) + b / (a + b)), tidy(a / b + b)
    (1, a/b + b)
    """
    if expression.has(sympy.nan, sympy.zoo, sympy.oo, -sympy.oo):
        raise SymbolicError(f"{expression} is not finite")
    if expression.is_Atom:
        return expression
    space = polynomials_over([expression])
    try:
        found = space.quotient(expression)
        short = ratio(space, found.top, space.denominator(found))
    except ZeroDivisionError:
        raise SymbolicError(f"{expression} divides by zero") from None
    except SymbolicError:  # too large to look for what cancels: it stays as it is
        return expression
    return min(short, expression, key=sympy.count_ops)


def ratio(space: Polynomials, top: Poly, bottom: Poly) -> sympy.Expr:
    """Write a quotient of two polynomials in lowest terms, factored."""
    top, bottom = lowest_terms(top, bottom)
    return factored(space, top) / factored(space, bottom)


def factored(space: Polynomials, poly: Poly) -> sympy.Expr:
    """Write a polynomial without the Laplace variable as a product, where that is quick."""
    return sympy.Mul(*(_collected(space, item) ** power for item, power in factors(poly)))


def _collected(space: Polynomials, poly: Poly) -> sympy.Expr:
    """Write a sum with what goes with each function, such as an exponential, put together."""
    functions = [place for place, item in enumerate(space.shown, 1) if not item.is_Symbol]
    groups: dict[tuple[int, ...], Poly] = {}
    for monomial, number in poly.iterterms():
        key = tuple(monomial[place] for place in functions)
        groups[key] = groups.get(key, poly.ring.zero) + poly.ring.from_dict({monomial: number})
    if len(groups) == 1:
        return space.expression(poly)
    return sympy.Add(*(factored(space, group) for group in groups.values()))


def factors(poly: Poly) -> list[tuple[Poly, int]]:
    """Return factors of a polynomial and their powers, numbers and generators first.

    What is large is not split beyond its numbers and generators.
    """
    ring = poly.ring
    if not poly:
        return [(ring.zero, 1)]
    content, rest = poly.primitive()
    if rest.LC < 0:
        content, rest = -content, -rest
    monomial, rest = split_monomial(rest)
    found = [(gen, power) for gen, power in zip(ring.gens, monomial, strict=True) if power]
    if content != 1:
        found.insert(0, (ring(content), 1))
    if rest == 1:
        return found
    dense = math.prod(degree + 1 for degree in rest.degrees())
    if len(rest) > FACTOR_TERMS or dense > FACTOR_DENSE:
        return [*found, (rest, 1)]
    number, split = rest.factor_list()
    signed = [(-item, power) if item.LC < 0 else (item, power) for item, power in split]
    turned = sum(power for item, power in split if item.LC < 0) % 2 == 1
    if (-number if turned else number) == -1:
        found.insert(0, (ring(-1), 1))
    return [*found, *signed]
