"""Equations expanded to states, inputs and parameters, within the limits of a small model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import sympy

from ..blocks import expansion
from ..equations import Equations
from .limits import MAX_OPERATIONS, MAX_STATES, SymbolicError
from .tidy import tidy


@dataclass(frozen=True, eq=False)
class Expanded:
    """Rates, residuals and outputs in states, inputs, algebraic variables and parameters."""

    rates: tuple[sympy.Expr, ...]
    residuals: tuple[sympy.Expr, ...]
    outputs: dict[str, sympy.Expr]


def expand(
    equations: Equations,
    outputs: Mapping[str, sympy.Expr],
    given: Mapping[sympy.Basic, sympy.Expr],
) -> Expanded:
    """Expand all that a symbolic analysis needs.

    Parameters
    ----------
    equations : Equations
    outputs : mapping of str to Expr
        In the equations' variables.
    given : mapping of Symbol to Expr
        What stands for some parameters.

    Returns
    -------
    Expanded

    Raises
    ------
    SymbolicError
        Where the model is not small.
    """
    wanted = [*equations.derivatives, *equations.residuals, *outputs.values()]
    _check_size(equations, wanted)
    known = expansion(equations.assignments, set().union(*(item.free_symbols for item in wanted)))

    def of(expression: sympy.Expr) -> sympy.Expr:
        return tidy(expression.xreplace(known).xreplace(given))

    return Expanded(
        tuple(of(item) for item in equations.derivatives),
        tuple(of(item) for item in equations.residuals),
        {name: of(item) for name, item in outputs.items()},
    )


def _check_size(equations: Equations, wanted: Iterable[sympy.Expr]) -> None:
    count, size = len(equations.states), expanded_size(equations, wanted)
    if count <= MAX_STATES and size <= MAX_OPERATIONS:
        return
    how = (
        f"{count} states; {MAX_STATES} are the limit"
        if count > MAX_STATES
        else f"{size} operations once expanded; {MAX_OPERATIONS} are the limit"
    )
    raise SymbolicError(
        f"model {equations.name!r} is too large to be analysed in symbols: {how}; "
        f"use linearize(), which works in numbers, or analyse a part of the model"
    )


def expanded_size(equations: Equations, wanted: Iterable[sympy.Expr]) -> int:
    """Count the operations that expressions would have, without expanding them."""
    sizes: dict[sympy.Basic, int] = {}

    def of(expression: sympy.Expr) -> int:
        inner = (
            expression.count(symbol) * sizes.get(symbol, 0) for symbol in expression.free_symbols
        )
        return int(sympy.count_ops(expression)) + sum(inner)

    for symbol, expression in equations.assignments:
        sizes[symbol] = of(expression)
    return sum(of(item) for item in wanted)
