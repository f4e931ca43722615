"""Slopes: the resistance that each nonlinear dissipator has for small changes about a point."""

from __future__ import annotations

import math

import casadi
import sympy

from ..codegen.program import Program
from ..codegen.to_casadi import to_casadi
from ..elements import R
from ..smooth import own_variables
from ..steady import SteadyState


def incremental_resistances(point: SteadyState) -> dict[str, float]:
    """Return de/df of each dissipator whose law is not linear, contacts that slip among them.

    A negative one feeds motion: it is what makes friction that falls with speed squeal.

    Parameters
    ----------
    point : SteadyState

    Returns
    -------
    dict of str to float
        By element, SI, with all other variables of the law held. Infinite where a law gives the
        flow and has no slope.

    Examples
    --------
    >>> from bondgraph import steady_state
    >>> from bondgraph.models import bicycle_brake
    >>> found = incremental_resistances(steady_state(bicycle_brake.graph(), {"v_s": 0.2}))
    >>> round(found["friction"], 6)
    -12.497621
    """
    equations = point.equations
    graph = equations.graph
    variables = own_variables(equations, graph)
    rows: dict[str, tuple[sympy.Expr, bool]] = {}
    for name, element in graph.of(R):
        given = element.effort is not None
        law, by = (element.effort, element.f) if given else (element.flow, element.e)
        if law is None:
            continue
        slope = sympy.diff(law, by)
        if slope.free_symbols & set(variables):
            rows[name] = (slope.xreplace(variables), given)
    if not rows:
        return {}
    program = Program.pruned(
        "slopes",
        [
            ("t", [equations.time]),
            ("x", (*equations.states, *equations.algebraic)),
            ("u", equations.inputs),
            ("p", equations.parameters),
        ],
        equations.assignments,
        {"slopes": [slope for slope, _ in rows.values()]},
    )
    u = [point.inputs[symbol.name] for symbol in equations.inputs]
    p = [point.parameters[symbol.name] for symbol in equations.parameters]
    found = casadi.DM(to_casadi(program)(0, point.vector, u, p)).full().ravel().tolist()
    return {
        name: float(value) if given else (1 / value if value else math.inf)
        for (name, (_, given)), value in zip(rows.items(), found, strict=True)
    }
