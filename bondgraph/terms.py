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


def product(*factors: sympy.Expr) -> sympy.Expr:
    """Multiply expressions.

    Parameters
    ----------
    *factors : Expr

    Returns
    -------
    Expr
        As ``sympy.Mul(*factors)``.

    Examples
    --------
    >>> e, f = sympy.symbols("e f")
    >>> product(sympy.Rational(1, 2), e**2), product(f, 3 * e)
    (e**2/2, 3*e*f)
    """
    if len(factors) == 2 and _is_plain(*factors):
        return sympy.Mul._from_args(factors, is_commutative=True)
    number: sympy.Expr = sympy.S.One
    powers: list[sympy.Expr] = []
    for factor in factors:
        coefficient, rest = factor.as_coeff_Mul()
        if coefficient is not sympy.S.One:
            number *= coefficient
        if rest is not sympy.S.One:
            powers += sympy.Mul.make_args(rest)
    bases = {_base(power) for power in powers}
    if not number.is_Rational or number.is_zero or None in bases or len(bases) < len(powers):
        return sympy.Mul(*factors)
    if len(powers) > 1:
        powers.sort(key=_BY_SYMPY)
    if number is not sympy.S.One:
        powers.insert(0, number)
    return sympy.Mul._from_args(tuple(powers), is_commutative=True)


def _is_plain(number: sympy.Expr, symbol: sympy.Expr) -> bool:
    """Whether two factors are a number other than 0 and 1, and a symbol: most products are."""
    return bool(
        number.is_Rational
        and symbol.is_Symbol
        and symbol.is_commutative
        and number is not sympy.S.One
        and number is not sympy.S.Zero
    )


def _base(power: sympy.Expr) -> sympy.Symbol | None:
    """Return the symbol of which an expression is an integer power, None where it is none."""
    if power.is_Pow and power.exp.is_Integer:
        power = power.base
    return power if power.is_Symbol and power.is_commutative else None


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
        return sympy.Add._from_args(tuple(sorted(terms, key=_BY_SYMPY)), is_commutative=True)
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
    if expression.is_Mul:
        return product(*(renamed(part, names) for part in expression.args))
    if (base := _base(expression)) is not None:
        return names[base] ** expression.exp if base in names else expression
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
