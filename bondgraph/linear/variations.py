"""Small changes about a point: any variable as a linear function of states, inputs and parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy
import sympy

from ..codegen.program import Program
from ..equations import Equations
from ..smooth import in_dependence
from ..steady import SteadyState

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Slopes:
    """Derivatives of some expressions at a point, algebraic variables following.

    Attributes
    ----------
    states : (k, n) array
        By states.
    inputs : (k, m) array
        By inputs.
    parameters : (k, q) array
        By the parameters asked for.
    """

    states: Array
    inputs: Array
    parameters: Array


def slopes(
    point: SteadyState,
    rows: Sequence[sympy.Expr],
    parameters: Sequence[sympy.Symbol] = (),
) -> Slopes:
    """Differentiate expressions in the equations' variables at a point.

    Parameters
    ----------
    point : SteadyState
    rows : sequence of Expr
    parameters : sequence of Symbol, optional
        To differentiate by; parameters that are derived from them follow, but for
        those that were given values of their own.

    Returns
    -------
    Slopes

    Examples
    --------
    >>> from bondgraph import I, One, R, Se, assemble, steady_state
    >>> mass = I("m", 2)
    >>> cart = assemble("cart", Se("F", 6) >> One("v") >> (mass, R("b", 4)))
    >>> point = steady_state(cart)
    >>> slopes(point, [point.equations.ports["b.e"]]).states.tolist()
    [[2.0]]
    """
    import casadi

    from ..codegen.to_casadi import to_casadi

    equations = point.equations
    derived = _following(point, parameters)
    free = [symbol for symbol in _given(equations) if symbol not in derived]
    table = equations.graph.parameters
    program = Program.pruned(
        "variations",
        [
            ("t", [equations.time]),
            ("x", (*equations.states, *equations.algebraic)),
            ("u", equations.inputs),
            ("p", free),
        ],
        [*((symbol, table[symbol].value) for symbol in derived), *equations.assignments],
        {"rows": rows, "residuals": equations.residuals},
    )
    order = len(equations.states)
    arguments = [
        casadi.SX.sym("x", order + len(equations.algebraic)),
        casadi.SX.sym("u", len(equations.inputs)),
        casadi.SX.sym("p", len(free)),
    ]
    values = [
        point.vector,
        [point.inputs[symbol.name] for symbol in equations.inputs],
        [point.parameters.get(symbol.name, numpy.nan) for symbol in free],
    ]
    found = [
        casadi.densify(casadi.jacobian(of, by))
        for of in to_casadi(program)(0, *arguments)
        for by in arguments
    ]
    blocks = [part.full() for part in casadi.Function("slopes", arguments, found)(*values)]
    x, u, p, *left = blocks
    columns = [free.index(symbol) for symbol in parameters]
    parts = [x[:, :order], u, p[:, columns]]
    if equations.algebraic:
        sides = [left[0][:, :order], left[1], left[2][:, columns]]
        follow = [numpy.linalg.solve(left[0][:, order:], -side) for side in sides]
        parts = [part + x[:, order:] @ step for part, step in zip(parts, follow, strict=True)]
    return Slopes(*parts)


def _given(equations: Equations) -> list[sympy.Symbol]:
    """Return all parameters, those that the equations use first."""
    table = [symbol for symbol in equations.graph.parameters if symbol not in equations.parameters]
    return [*equations.parameters, *table]


def _following(point: SteadyState, moved: Sequence[sympy.Symbol]) -> list[sympy.Symbol]:
    """Return the derived parameters that rest on those moved and have the value they derive, in order."""
    table = point.equations.graph.parameters
    values = {
        symbol: point.parameters[symbol.name] for symbol in table if symbol.name in point.parameters
    }
    derived = [symbol for symbol, row in table.items() if row.derived and symbol not in moved]
    found: list[sympy.Symbol] = []
    for symbol in in_dependence(derived, table):
        formula = table[symbol].value
        known = symbol in values and formula.free_symbols <= values.keys()
        if known and formula.free_symbols & {*moved, *found}:
            own = float(formula.xreplace(values))
            if numpy.isclose(own, values[symbol], rtol=1e-12, atol=0.0):
                found.append(symbol)
    return found
