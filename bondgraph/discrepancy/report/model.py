"""What changed in the model: its graph, and its own parameters."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from ...causality import assign_causality
from ...graph import BondGraph
from ...plot import pretty
from ...report import Section, Table, Text
from ...report.drawing import drawing
from ..discovery import Discovery, Verdict
from .words import changed, figure, rounded, share, spread

_ROW = re.compile(r"(\+ parameter '(.*)' = )\S+(.*)")


def graph_section(found: Discovery) -> Section:
    """Draw the graph with what is new in blue, and list the changes."""
    graph = found.chosen.graph
    picture = drawing(
        assign_causality(graph), "bond-graph", accented=tuple(new_elements(found.graph, graph))
    )
    if not changed(found):
        return Section("The model", (Text("Nothing was added."), *picture))
    lead = {
        Verdict.NAMED: "Blue: what was added.",
        Verdict.AMBIGUOUS: "Blue: how the first of them would be added.",
    }.get(
        found.verdict, "Blue: how the nearest would be added, which is not to say that it is there."
    )
    blocks: list[object] = [Text(lead), *picture]
    if found.diff:
        blocks += [
            Text("Added (+), removed (-) and changed (~), with fitted values:"),
            Text("\n".join(diff_lines(found)), "code"),
        ]
    return Section(
        "The improved model" if found.improved is not None else "The model", tuple(blocks)
    )


def diff_lines(found: Discovery) -> list[str]:
    """Return what was changed in the graph, with fitted values in the place of first ones."""
    values = found.chosen.fit.values
    lines = []
    for line in found.diff:
        match = _ROW.match(line)
        if match is not None and match[2] in values:
            line = f"{match[1]}{figure(values[match[2]], 6)}{match[3]}"
        lines.append(line)
    return lines


def new_elements(old: BondGraph, new: BondGraph) -> Iterable[str]:
    """Yield the elements of a graph that another one lacks or has with another law."""
    for name, element in new.elements.items():
        if old.elements.get(name) is not element:
            yield name


def parameter_section(found: Discovery) -> Section | None:
    """List the model's own parameters as given and as fitted; None where none was sought."""
    if not found.parameters:
        return None
    rows = tuple(
        (
            name,
            figure(nominal, 6),
            rounded(estimate.value, estimate.std),
            spread(estimate.std),
            pretty(estimate.unit or "1"),
            _change(nominal, estimate.value),
            _in_std(nominal, estimate.value, estimate.std),
        )
        for name, estimate in found.parameters.items()
        for nominal in (found.nominal.get(name, math.nan),)
    )
    head = ("parameter", "as given", "fitted", "std", "unit", "change", "change over std")
    also = ", together with the effects" if changed(found) else ""
    note = (
        f"SI, fitted to the recordings{also}. A change of many standard deviations says that the "
        "value given was not that of this machine, or that the parameter takes a part of what is "
        "missing."
    )
    table = Table(head, rows, "crrrlrr", labelled=True)
    return Section("The model's own parameters", (table, Text(note, "note")))


def _change(nominal: float, value: float) -> str:
    if not nominal:
        return "–"
    text = share(value / nominal - 1)
    return f"+{text}" if value > nominal and text != "0 %" else text


def _in_std(nominal: float, value: float, std: float) -> str:
    return figure((value - nominal) / std, 2) if std > 0 and math.isfinite(std) else "–"
