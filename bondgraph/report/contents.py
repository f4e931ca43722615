"""What the report says of any model beside its spectrum: parameters, point, equations."""

from __future__ import annotations

import re

import numpy
import sympy

from ..causality import CausalGraph
from ..dimensions import infer
from ..equations import Equations, derive
from ..graph import BondGraph
from ..plot import pretty
from ..stability import StabilityResult
from ..text import to_text
from ..units import from_si
from .blocks import Bullets, Markup, Section, Table, Text
from .drawing import drawing
from .mathml import state_equations
from .words import coherent, number

# Beside the states and what they add up from, smaller values are what the solver leaves of zero.
NOISE = 1e-12


def model_section(result: StabilityResult, causal: CausalGraph, description: str) -> Section:
    """Describe the model: words, drawing and size."""
    graph = result.graph
    states = len(result.system.states)
    size = (
        f"{len(graph.elements)} elements, {len(graph.bonds)} bonds, "
        f"{states} state{'s' * (states != 1)}."
    )
    words = [*_paragraphs(description), Text(size, "note")]
    return Section("Model", (*words, *drawing(causal, "bond-graph")))


def _paragraphs(description: str) -> list[Text]:
    """Split a docstring into paragraphs; headings of its sections become part of theirs."""
    text = re.sub(r"(?m)^(.+)\n-{3,}$", r"\1:", description.strip())
    return [Text(" ".join(part.split())) for part in re.split(r"\n\s*\n", text) if part.strip()]


def parameter_section(result: StabilityResult) -> Section:
    """List the parameters that the equations rest on."""
    graph, values = result.graph, result.point.parameters
    used = _with_ancestors(graph, result)
    rows = []
    for symbol, row in graph.parameters.items():
        if symbol.name not in used or symbol.name not in values:
            continue
        value = values[symbol.name]
        source = row.source
        if symbol.name in result.overrides:
            source = "set for this report"
        elif row.derived:
            source = f"{row.source or 'derived'}: {_plain(row.value)}"
        unit, own = coherent(row.unit), row.unit or "1"
        in_si = number(value) if unit == own else f"{number(value)} {pretty(unit)}"
        shown = number(from_si(value, row.unit))
        rows.append((symbol.name, shown, pretty(own), in_si, row.meaning, source))
    head = ("name", "value", "unit", "SI value", "meaning", "source")
    idle = [symbol.name for symbol in graph.parameters if symbol.name not in used]
    blocks: list[object] = [Table(head, tuple(rows), "crlrll", labelled=True)]
    if not rows:
        blocks = [Text("The laws hold numbers: there are no parameters.")]
    else:
        blocks.append(
            Text(
                "Values that this page rests on, in the unit they were given in and in SI. Derived "
                "values follow the parameters in their formula.",
                "note",
            )
        )
    if idle:
        blocks.append(Text(f"In the table but not in these equations: {', '.join(idle)}.", "note"))
    return Section("Parameters", tuple(blocks))


def _with_ancestors(graph: BondGraph, result: StabilityResult) -> set[str]:
    """Return the names of the parameters in the equations and of those they derive from."""
    waiting = list(derive(graph).parameters)
    used: set[str] = set()
    while waiting:
        symbol = waiting.pop()
        if symbol.name in used:
            continue
        used.add(symbol.name)
        row = graph.parameters[symbol]
        if row.derived and symbol.name not in result.overrides:
            waiting += [inner for inner in row.value.free_symbols if inner in graph.parameters]
    return used


def _plain(expression: sympy.Expr) -> str:
    return str(expression).replace("**", "^")


def point_section(result: StabilityResult) -> Section:
    """List states, outputs, inputs and modes at the operating point."""
    point, graph = result.point, result.graph
    units = infer(graph).units
    noise = _noise(result)
    meanings = {name: output.meaning for name, output in graph.outputs.items()}
    units = {**units, **{name: output.unit or "1" for name, output in graph.outputs.items()}}
    units |= {symbol.name: unit for symbol, unit in graph.inputs.items()}
    rows = tuple(
        (
            kind,
            name,
            number(0.0 if abs(value) <= noise.get(name, 0.0) else value),
            pretty(units.get(name) or ""),
            meanings.get(name, ""),
        )
        for kind, table in (
            ("state", point.states),
            ("output", point.outputs),
            ("input", point.inputs),
        )
        for name, value in table.items()
    )
    blocks: list[object] = [
        Text(
            "The steady state that the verdict is about: all rates are zero there. It was found by "
            "solving."
        ),
        Table(("", "name", "value", "unit", "meaning"), rows, "lcrll"),
        Text(
            "States are what the model remembers: q of a spring, capacitor or tank, p of a mass or "
            "coil, by element. Outputs follow from them.",
            "note",
        ),
    ]
    if point.modes:
        held = ", ".join(f"{name}: {mode}" for name, mode in point.modes.items())
        blocks.append(Text(f"Contacts at this point: {held} (slip+ slides forwards, stick holds)."))
    return Section("Operating point", tuple(blocks))


def _noise(result: StabilityResult) -> dict[str, float]:
    """Return the size below which a state or output is nothing but rounding."""
    import scipy.linalg

    system = result.system
    if not system.states:
        return {}
    scale = numpy.diag(scipy.linalg.matrix_balance(system.A, permute=False)[1])
    x = numpy.array(list(result.point.states.values()))
    states = NOISE * numpy.abs(x / scale).max() * scale
    outputs = numpy.abs(system.C) @ states
    names = (*system.states, *system.outputs)
    return dict(zip(names, map(float, (*states, *outputs)), strict=True))


def equation_section(equations: Equations) -> Section:
    """Show the state equations as formulas, and the assignments as they are computed."""
    formulas = state_equations(equations)
    blocks: list[object] = []
    if equations.contacts:
        blocks.append(
            Text(
                "While slipping; σ is +1 or -1, the direction of slip. A contact that sticks holds "
                "its slip at zero, and its effort follows from the rates."
            )
        )
    if formulas:
        blocks.append(Markup(f'<div class="formulas">{"".join(formulas)}</div>'))
    blocks.append(Text("In full, with the assignments in the order they are computed in:"))
    blocks.append(Text(to_text(equations), "code"))
    return Section("Equations", tuple(blocks))


def assumption_section(result: StabilityResult) -> Section:
    """List warnings, notes of the graph, and what the verdict takes for granted."""
    said = [
        *result.warnings,
        *result.graph.notes,
        *(f"units: {text}" for text in infer(result.graph).problems),
        "the eigenvalues are those of the linearised equations: they tell of small motions about "
        "the operating point",
    ]
    return Section("Warnings and assumptions", (Bullets(tuple(dict.fromkeys(said))),))
