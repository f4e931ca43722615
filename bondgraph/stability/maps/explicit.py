"""Steady states without a search: the equations of rest as ordered assignments.

Where nothing changes all rates are zero. Which equation then decides which variable is a
matching of the two, and what needs each other a block. A compliance at rest decides a flow, an
inertia an effort, so that the argument of a nonlinear law is often known before the law is met:
the speeds of a sliding brake follow from the road alone, and friction from them.
"""

from __future__ import annotations

import networkx
import sympy

from ...blocks import order_and_solve
from ...codegen.program import Program
from ...codegen.symbols import symbols_in
from ...equations import Equations
from ...errors import AlgebraicLoopError
from ...terms import slopes

# Elimination is in exact arithmetic; larger systems are left to Newton.
MOST_UNKNOWNS = 300


def explicit_rest(equations: Equations) -> Program | None:
    """Write the steady state as a program, where each block of the equations of rest is affine.

    Parameters
    ----------
    equations : Equations
        Without open contacts.

    Returns
    -------
    Program or None
        In u and p, to states and algebraic variables. None where a block is not affine in its
        own unknowns, where the equations leave some open, or where there are many.

    References
    ----------
    Dulmage, Mendelsohn, Coverings of bipartite graphs, Canad. J. Math. 10 (1958) 517-534.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble, derive
    >>> v = One("v")
    >>> cubic = R("b", effort=lambda f: f + f**3)
    >>> msd = assemble("msd", Se("F", 6) >> v >> (I("m", 2), C("k", stiffness=3), cubic))
    >>> explicit_rest(derive(msd)).assignments[-1]
    (k.q, k.e/3)
    """
    wanted = [*equations.derivatives, *equations.residuals]
    kept = Program.pruned(
        "rest",
        [("all", sorted(equations.arguments, key=str))],
        equations.assignments,
        {"zero": wanted},
    ).assignments
    solved = (*equations.states, *equations.algebraic)
    unknowns = [*solved, *(symbol for symbol, _ in kept)]
    if len(unknowns) > MOST_UNKNOWNS or len(wanted) != len(solved):
        return None
    rows = [*(symbol - expression for symbol, expression in kept), *wanted]
    decided = _matched(rows, set(unknowns))
    if decided is None:
        return None
    own = dict(kept)
    row_of = {symbol: place for place, (symbol, _) in enumerate(kept)}
    given = {s: own[s] for s, row in decided.items() if row_of.get(s) == row}
    implicit = {s: rows[row] for s, row in decided.items() if s not in given}
    try:
        ordered = order_and_solve(given, implicit)
    except AlgebraicLoopError:
        return None
    if ordered.algebraic:
        return None
    names = dict(ordered.assignments)
    return Program.pruned(
        "rest",
        [("u", equations.inputs), ("p", tuple(equations.graph.parameters))],
        ordered.assignments,
        {"x": [_short(names[symbol], symbol) for symbol in solved]},
    )


def _short(expression: sympy.Expr, symbol: sympy.Symbol) -> sympy.Expr:
    return expression if expression.is_number else symbol


def _matched(rows: list[sympy.Expr], unknowns: set[sympy.Symbol]) -> dict[sympy.Symbol, int] | None:
    """Let each row decide an unknown that it is affine in; None where that cannot be."""
    network = networkx.Graph()
    network.add_nodes_from(range(len(rows)))
    for place, row in enumerate(rows):
        used = sorted(symbols_in(row) & unknowns, key=str)
        for symbol, slope in slopes(row, used).items():
            if slope != 0 and symbol not in slope.free_symbols:
                network.add_edge(place, symbol)
    found = networkx.bipartite.hopcroft_karp_matching(network, range(len(rows)))
    decided = {symbol: row for row, symbol in found.items() if isinstance(row, int)}
    return decided if len(decided) == len(unknowns) else None
