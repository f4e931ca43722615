"""Views of equations: as MathML, which browsers show by themselves, and as LaTeX."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from ..dimensions import infer
from ..equations import Equations
from ..report.mathml import state_equations
from ..text import to_latex, to_text
from ..units import pretty
from .markup import block, folded, items, scrolled, table


def html(equations: Equations) -> str:
    """Return the state equations, and what is a state, an input and an output in which unit.

    Parameters
    ----------
    equations : Equations

    Returns
    -------
    str
        A large model's equations as plain text.
    """
    lines = state_equations(equations)
    if not lines and equations.states:
        body = folded("as text", f"<pre>{escape(to_text(equations))}</pre>")
    else:
        body = scrolled("".join(f'<div style="margin: 0.6em 0">{row}</div>' for row in lines))
    graph = equations.graph
    known: Mapping[str, str | None] = infer(graph).units
    units = {symbol.name: unit for symbol, unit in graph.inputs.items()}
    rows = [("state", symbol.name, known.get(symbol.name) or "") for symbol in equations.states]
    rows += [("algebraic", symbol.name, "") for symbol in equations.algebraic]
    rows += [("input", symbol.name, units.get(symbol.name, "")) for symbol in equations.inputs]
    rows += [("output", name, graph.outputs[name].unit) for name in equations.outputs]
    return block(
        f"Equations of {equations.name}",
        body,
        table(("", "name", "SI unit"), [(*row[:2], pretty(row[2])) for row in rows]),
        items(dict.fromkeys(equations.warnings)),
    )


def latex(equations: Equations) -> str:
    """Return the equations as an ``align*`` environment.

    Parameters
    ----------
    equations : Equations

    Returns
    -------
    str
        Says that there are none where a model has no states.
    """
    return to_latex(equations) or r"$\text{no state equations}$"
