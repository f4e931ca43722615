"""Results on the terminal: rich tables for people, plain values for JSON."""

from __future__ import annotations

import math
import sys
from typing import Any

import click
import sympy
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from bondgraph.causality import CausalGraph
from bondgraph.describe import mode_words
from bondgraph.dimensions import si_unit
from bondgraph.elements import DryFriction, Element, SignalBlock, Storage, Switched
from bondgraph.graph import BondGraph
from bondgraph.resolver import resolve
from bondgraph.simulation import Trajectory

from .options import print_json


def new_console() -> Console:
    """Return a console for tables; a pipe gets lines of one width."""
    wide = None if sys.stdout.isatty() else 120  # a pipe has no width of its own
    return Console(highlight=False, soft_wrap=True, width=wide)


def new_table(title: str, *columns: str) -> Table:
    """Return an empty table in the dress that all commands share."""
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for column in columns:
        table.add_column(column, overflow="fold")
    return table


def as_json_object(causal: CausalGraph) -> dict[str, Any]:
    """Return what `bondgraph show --json` prints."""
    graph = causal.graph
    values = resolve(graph.parameters, partial=True)
    return {
        "schema": 1,
        "model": graph.name,
        "elements": [
            {"name": name, "kind": element.kind} for name, element in graph.elements.items()
        ],
        "bonds": [
            {"name": stroke.bond, "effort_out_of": stroke.effort_out_of, "reason": stroke.because}
            for stroke in causal.strokes
        ],
        "signals": [
            {"from": f"{signal.source}.{signal.variable}", "to": signal.target}
            for signal in graph.signals
        ],
        "parameters": {
            symbol.name: {
                "value": values.get(symbol.name),
                "unit": si_unit(row.unit),
                "meaning": row.meaning,
                "source": row.source,
            }
            for symbol, row in graph.parameters.items()
        },
        "inputs": {symbol.name: unit for symbol, unit in graph.inputs.items()},
        "outputs": {name: output.unit for name, output in graph.outputs.items()},
        "integral": list(causal.integral),
        "derivative": list(causal.derivative),
        "warnings": [*graph.warnings, *causal.warnings],
        "notes": list(graph.notes),
    }


def as_tables(causal: CausalGraph) -> None:
    """Print a graph for reading."""
    graph, console = causal.graph, new_console()
    console.print(
        f"[bold]{graph.name}[/bold]: {len(graph.elements)} elements, {len(graph.bonds)} bonds\n"
    )
    elements = new_table("Elements", "element", "kind", "law")
    laws = _laws(graph)
    for name, element in graph.elements.items():
        elements.add_row(name, element.kind, laws[name])
    console.print(elements)
    bonds = new_table("\nBonds", "bond", "effort out of", "because")
    for stroke in causal.strokes:
        bonds.add_row(stroke.bond, stroke.effort_out_of, stroke.because)
    console.print(bonds)
    _print_parameters(console, causal)
    for line in (*graph.warnings, *causal.warnings):
        console.print(f"\nwarning: {line}", markup=False)
    for line in graph.notes:
        console.print(f"note: {line}", markup=False)


def print_causality(causal: CausalGraph, as_json: bool) -> None:
    """Print what `bondgraph show --causality` does."""
    from bondgraph.causality_report import report_causality, to_json, to_text

    report = report_causality(causal)
    if as_json:
        print_json(to_json(report))
    else:
        click.echo(to_text(report))


def _print_parameters(console: Console, causal: CausalGraph) -> None:
    graph = causal.graph
    if not graph.parameters:
        return
    values = resolve(graph.parameters, partial=True)
    table = new_table("\nParameters", "name", "value", "SI unit", "given as", "meaning", "source")
    for symbol, row in graph.parameters.items():
        given = "" if row.value is None else f"{row.value} {row.unit}".strip()
        value = f"{values[symbol.name]:.9g}" if symbol.name in values else "to be given"
        table.add_row(symbol.name, value, si_unit(row.unit), given, row.meaning, row.source)
    console.print(table)


def _laws(graph: BondGraph) -> dict[str, str]:
    """Write each element's law: its own variables by letter, those of others by qualified name."""
    foreign = {
        symbol: sympy.Symbol(f"{name}.{key}")
        for name, element in graph.elements.items()
        for key, symbol in element.symbols.items()
    }
    return {name: _law(element, foreign) for name, element in graph.elements.items()}


def _law(element: Element, foreign: dict[sympy.Basic, sympy.Basic]) -> str:
    plain = foreign | {symbol: sympy.Symbol(key) for key, symbol in element.symbols.items()}
    if isinstance(element, Switched) and not isinstance(element, DryFriction):
        return mode_words(element, plain)
    shown = {key: law.xreplace(plain) for key, law in element.laws.items()}
    if isinstance(element, SignalBlock):
        return f"der(y) = {shown['rate']}"
    if isinstance(element, Storage):
        return f"{'e' if element.kind == 'C' else 'f'} = {shown['law']}"
    names = {"effort": "e", "flow": "f", "kinetic": "abs(e)", "ratio": "ratio"}
    return next((f"{names[key]} = {law}" for key, law in shown.items() if key in names), "")


def run_json(trajectory: Trajectory) -> dict[str, Any]:
    """Return what `bondgraph simulate --json` prints."""
    energy = trajectory.energy
    return {
        "schema": 1,
        "model": trajectory.model.equations.name,
        "outcome": trajectory.outcome.value,
        "t_end": trajectory.t_end,
        "final": {
            name: value if math.isfinite(value) else None
            for name, value in trajectory.final.items()
        },
        "events": [
            {"t": event.t, "element": event.element, "from": event.from_mode, "to": event.to_mode}
            for event in trajectory.events
        ],
        "energy": {
            "supplied": energy.supplied,
            "stored": energy.stored,
            "dissipated": energy.dissipated,
            "relative_residual": energy.relative_residual,
        },
        "undefined": [{"name": name, "t": t} for name, t in trajectory.undefined.items()],
        "backend": trajectory.backend,
        "solver": {"name": trajectory.solver, "reason": trajectory.solver_reason},
        "steps": trajectory.steps,
    }


def run_tables(trajectory: Trajectory) -> None:
    """Print a run for reading."""
    console = new_console()
    console.print(
        f"[bold]{trajectory.model.equations.name}[/bold]: {trajectory.outcome.value} at "
        f"{trajectory.t_end:.9g} s, {trajectory.steps} steps, {len(trajectory.events)} events ({trajectory.backend})\n"
        f"{escape(trajectory.solver_reason)}\n"
    )
    final = new_table("Final values", "name", "value", "unit")
    for name, value in trajectory.final.items():
        final.add_row(name, f"{value:.9g}", trajectory.unit(name))
    console.print(final)
    if trajectory.events:
        events = new_table("\nEvents", "t [s]", "element", "from", "to")
        for event in trajectory.events[:10]:
            events.add_row(f"{event.t:.9f}", event.element, event.from_mode, event.to_mode)
        console.print(events)
        if len(trajectory.events) > 10:
            console.print(f"... and {len(trajectory.events) - 10} more")
    energy = trajectory.energy
    stored = "unknown" if energy.stored is None else f"{energy.stored:.9g} J"
    residual = "unknown" if energy.relative_residual is None else f"{energy.relative_residual:.1e}"
    console.print(
        f"\nEnergy: supplied {energy.supplied:.9g} J, stored {stored}, dissipated {energy.dissipated:.9g} J, "
        f"relative residual {residual}"
    )
