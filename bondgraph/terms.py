"""Terms: the products and sums of symbols that bond graphs are made of.

Almost every law is a number times a symbol, and every junction a sum of symbols. These are
written here in sympy's normal form at once; sympy itself would search each for like terms, which
on large graphs is most of the work. Whatever else comes along is left to sympy.
``_from_args`` is how sympy's own modules make what is in normal form already.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping

import sympy

_BY_SYMPY = functools.cmp_to_key(sympy.Basic.compare)


def product(factor: sympy.Expr, quantity: sympy.Expr) -> sympy.Expr:
    """Multiply two expressions.

    Parameters
    ----------
    factor, quantity : Expr

    Returns
    -------
    Expr
        As ``factor * quantity``.

    Examples
    --------
    >>> e, f = sympy.symbols("e f")
    >>> product(sympy.Rational(1, 2), e**2), product(f, e)
    (e**2/2, e*f)
    """
    if quantity.is_Symbol or (quantity.is_Pow and quantity.base.is_Symbol):
        if factor.is_Rational and factor is not sympy.S.One and factor is not sympy.S.Zero:
            return sympy.Mul._from_args((factor, quantity))
        if factor.is_Symbol and quantity.is_Symbol and factor != quantity:
            return sympy.Mul._from_args(tuple(sorted((factor, quantity), key=_BY_SYMPY)))
    return factor * quantity


def signed_sum(plus: Iterable[sympy.Symbol], minus: Iterable[sympy.Symbol]) -> sympy.Expr:
    """Add up some symbols and take others off.

    Parameters
    ----------
    plus, minus : iterable of Symbol

    Returns
    -------
    Expr

    Examples
    --------
    >>> x, y, z = sympy.symbols("x y z")
    >>> signed_sum([x, z], [y]), signed_sum([x], [x])
    (x - y + z, 0)
    """
    plus, minus = list(plus), list(minus)
    terms = [*plus, *(-symbol for symbol in minus)]
    if len(terms) > 1 and len({*plus, *minus}) == len(terms):
        return sympy.Add._from_args(tuple(sorted(terms, key=_BY_SYMPY)))
    return sympy.Add(*terms)


def renamed(expression: sympy.Expr, names: Mapping[sympy.Basic, sympy.Expr]) -> sympy.Expr:
    """Exchange symbols for others, or for expressions.

    Parameters
    ----------
    expression : Expr
    names : mapping of Symbol to Expr

    Returns
    -------
    Expr
        As ``expression.xreplace(names)``.

    Examples
    --------
    >>> p, q = sympy.symbols("p q")
    >>> renamed(q**2 / 2, {q: p})
    p**2/2
    """
    if expression.is_Symbol:
        return names.get(expression, expression)
    if expression.is_Mul and len(expression.args) == 2 and expression.args[0].is_Rational:
        factor, quantity = expression.args
        return product(factor, renamed(quantity, names))
    return expression.xreplace(names)


def slopes(expression: sympy.Expr, symbols: Iterable[sympy.Basic]) -> dict[sympy.Basic, sympy.Expr]:
    """Differentiate by several symbols; a sum term by term, each by its own symbols alone.

    Parameters
    ----------
    expression : Expr
    symbols : iterable of Symbol

    Returns
    -------
    dict of Symbol to Expr
        The partial derivatives, in the order of the symbols.

    Examples
    --------
    >>> x, y = sympy.symbols("x y")
    >>> slopes(3 * x + x * y, [x, y])
    {x: y + 3, y: x}
    """
    parts: dict[sympy.Basic, list[sympy.Expr]] = {symbol: [] for symbol in symbols}
    for term in sympy.Add.make_args(expression):
        for symbol in term.free_symbols & parts.keys():
            parts[symbol].append(_slope(term, symbol))
    return {symbol: sympy.Add(*part) for symbol, part in parts.items()}


def _slope(term: sympy.Expr, symbol: sympy.Basic) -> sympy.Expr:
    factor, rest = term.as_coeff_Mul()
    return factor if rest == symbol else sympy.diff(term, symbol)
