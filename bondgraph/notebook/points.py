"""View of a steady state: where it is, and in which modes."""

from __future__ import annotations

from ..dimensions import infer
from ..steady import SteadyState
from .markup import block, number, paragraph, table


def html(point: SteadyState) -> str:
    """Return states, outputs, inputs and modes with units.

    Parameters
    ----------
    point : SteadyState

    Returns
    -------
    str
    """
    graph = point.equations.graph
    known = infer(graph).units
    inputs = {symbol.name: unit for symbol, unit in graph.inputs.items()}
    rows = [("state", name, number(v, known.get(name) or "")) for name, v in point.states.items()]
    rows += [("algebraic", name, number(v)) for name, v in point.algebraic.items()]
    rows += [("input", name, number(v, inputs.get(name, ""))) for name, v in point.inputs.items()]
    rows += [
        ("output", name, number(v, graph.outputs[name].unit)) for name, v in point.outputs.items()
    ]
    rows += [("mode", name, mode) for name, mode in point.modes.items()]
    free = "" if point.isolated else "Not the only one near by: a state is free."
    return block(
        f"Operating point of {point.equations.name}",
        table(("", "name", "value"), rows),
        paragraph(free),
    )
