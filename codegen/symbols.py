"""The free symbols of an expression, faster than sympy finds them in short arithmetic."""

from __future__ import annotations

import sympy


def symbols_in(expression: sympy.Basic) -> set[sympy.Basic]:
    """Return the free symbols of an expression.

    Sums, products and powers are walked through at once; sympy would make a set of each of their
    parts, which on large programs is a tenth of all work.

    Parameters
    ----------
    expression : Basic

    Returns
    -------
    set of Symbol
        As ``expression.free_symbols``; the caller's own.

    Examples
    --------
    >>> x, y = sympy.symbols("x y")
    >>> sorted(symbols_in(2 * x * y - x), key=str)
    [x, y]
    """
    found: set[sympy.Basic] = set()
    stack = [expression]
    while stack:
        part = stack.pop()
        if part.is_Symbol:
            found.add(part)
        elif part.is_Add or part.is_Mul or part.is_Pow:
            stack.extend(part.args)
        elif not part.is_Number:
            found |= part.free_symbols
    return found
