"""Jacobians in symbols, through algebraic variables by the implicit function theorem."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy

from .limits import SymbolicError
from .tidy import tidy

# An inverse of more rows than this is too much to be written out.
MAX_ALGEBRAIC = 4

Blocks = tuple[sympy.ImmutableMatrix, ...]


def jacobian(
    rows: Mapping[str, sympy.Expr],
    columns: Sequence[sympy.Symbol],
    at: Mapping[sympy.Basic, sympy.Expr],
) -> sympy.Matrix:
    """Return derivatives of expressions at a point.

    Parameters
    ----------
    rows : mapping of str to Expr
        By the name that an error calls them.
    columns : sequence of Symbol
    at : mapping of Symbol to Expr
        The point, as far as it is given.

    Returns
    -------
    (rows, columns) Matrix

    Raises
    ------
    SymbolicError
        Where an expression has no derivative.

    Examples
    --------
    >>> x = sympy.Symbol("x", real=True)
    >>> jacobian({"rate": sympy.sin(x)}, [x], {x: sympy.S.Zero})
    Matrix([[1]])
    """
    return sympy.Matrix(
        len(rows),
        len(columns),
        [_slope(name, item, x, at) for name, item in rows.items() for x in columns],
    )


def _slope(
    name: str, expression: sympy.Expr, x: sympy.Symbol, at: Mapping[sympy.Basic, sympy.Expr]
) -> sympy.Expr:
    slope = sympy.diff(expression, x)
    if at:
        slope = slope.subs(at, simultaneous=True)
    if slope.has(sympy.Derivative, sympy.Subs, sympy.DiracDelta):
        raise SymbolicError(
            f"{name} = {expression} has no derivative along {x}; use a smooth law, or its value in a mode",
            elements=[_element(x)],
        )
    try:
        return tidy(slope)
    except SymbolicError:
        raise SymbolicError(
            f"the derivative of {name} along {x} is not finite at the operating point; give another at={{...}}",
            elements=[_element(x)],
        ) from None


def _element(symbol: sympy.Symbol) -> str:
    """Return the element that a port variable or state belongs to."""
    return str(symbol.name).rpartition(".")[0] or str(symbol.name)


def eliminated(
    direct: sympy.Matrix, through: sympy.Matrix, inner: sympy.Matrix, outer: sympy.Matrix
) -> sympy.ImmutableMatrix:
    """Return ``f_x - f_z g_z^-1 g_x``, tidied.

    Parameters
    ----------
    direct, through : Matrix
        f_x and f_z.
    inner : (k, k) Matrix
        The inverse of g_z.
    outer : Matrix
        g_x.

    Returns
    -------
    ImmutableMatrix
    """
    if not inner.rows:
        return sympy.ImmutableMatrix(direct)
    return sympy.ImmutableMatrix((direct - through * inner * outer).applyfunc(tidy))


def inverse(g_z: sympy.Matrix, algebraic: Sequence[sympy.Symbol]) -> sympy.Matrix:
    """Return the inverse of the algebraic equations' own Jacobian.

    Raises
    ------
    SymbolicError
        If it is singular or too large.

    Examples
    --------
    >>> z = sympy.Symbol("z")
    >>> inverse(sympy.Matrix([[3 * z**2 + 1]]), [z])
    Matrix([[1/(3*z**2 + 1)]])
    """
    names = ", ".join(symbol.name for symbol in algebraic)
    if len(algebraic) > MAX_ALGEBRAIC:
        raise SymbolicError(
            f"{len(algebraic)} algebraic variables ({names}) are too many to be eliminated in symbols; "
            f"{MAX_ALGEBRAIC} are the limit: break the loop with a storage",
            elements=[_element(symbol) for symbol in algebraic],
        )
    if not algebraic:
        return g_z
    determinant = tidy(g_z.det(method="berkowitz"))
    if determinant == 0:
        raise SymbolicError(
            f"the algebraic equations do not determine {names} at this point; give another at={{...}}",
            elements=[_element(symbol) for symbol in algebraic],
        )
    return (g_z.adjugate() / determinant).applyfunc(tidy)
