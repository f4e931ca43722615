"""The chapter on causality: the drawing with numbered bonds, and every decision with its reason."""

from __future__ import annotations

from ..causality_report import CausalityReport, report_causality
from ..causality_report.as_text import (
    constraint_of,
    effect_of,
    headline,
    listed,
    mode_heading,
    solved_as,
)
from ..equations import Equations
from .blocks import Bullets, Section, Table, Text
from .drawing import drawing


def causality_section(equations: Equations) -> Section:
    """Show strokes, deciding bonds, storages, loops and modes, with the drawing beside."""
    report = report_causality(equations)
    blocks: list[object] = [
        Text(f"{headline(report).partition(': ')[2].capitalize()}."),
        *drawing(equations.causal, "bond-causality", numbers=True),
        Text(
            "Each bond's effort is decided at one end and its flow at the other; the stroke is "
            "drawn where the effort arrives. Numbers are those of the drawing."
        ),
        _bonds(report),
        _junctions(report),
        *_storages(report),
        *_loops(report),
        *_modes(report),
    ]
    if report.turned:
        blocks += [Text("Put right:"), Bullets(report.turned)]
    if report.parts:
        parts = tuple(", ".join(part) for part in report.parts)
        blocks += [Text("Disconnected parts, each solved on its own:"), Bullets(parts)]
    return Section("Causality", tuple(blocks))


def _bonds(report: CausalityReport) -> Table:
    rows = tuple(
        (str(number), item.bond, item.effort_out_of, item.flow_out_of, item.reason, item.because)
        for number, item in enumerate(report.bonds, start=1)
    )
    head = ("", "bond", "effort out of", "flow out of, stroke at", "reason", "because")
    return Table(head, rows, "rcccll")


def _junctions(report: CausalityReport) -> Table:
    rows = tuple(
        (
            f"{item.kind}\u00a0{item.junction}",
            item.shared,
            item.decided_by,
            item.because,
            ", ".join(item.followers),
        )
        for item in report.junctions
    )
    head = ("junction", "shares", "decided by", "because", "these follow")
    return Table(head, rows, "clcll", "The one bond of each junction that decides what is shared.")


def _storages(report: CausalityReport) -> list[object]:
    blocks: list[object] = []
    if not report.dependent:
        blocks.append(Text("All storage is in integral causality."))
    else:
        rows = tuple(
            (
                item.state,
                constraint_of(item),
                ", ".join(item.bound_by),
                item.because,
                item.done + ("; its initial value is not used" if item.idle_initial else ""),
            )
            for item in report.dependent
        )
        head = ("state", "constraint", "bound by", "because", "done about it")
        caption = "Derivative causality: storage without a state of its own."
        blocks.append(Table(head, rows, "cclll", caption))
    if report.input_rates:
        rates = listed(rate for _, rate in report.input_rates)
        blocks.append(Text(f"Rates of inputs are needed, since storage follows them: {rates}."))
    return blocks


def _loops(report: CausalityReport) -> list[object]:
    if not report.loops:
        return []
    rows = tuple(
        (item.kind, " → ".join((*item.variables, item.variables[0])), solved_as(item), item.remedy)
        for item in report.loops
    )
    head = ("loop", "variables", "done about it", "without it")
    return [Table(head, rows, "lcll", "Variables that depend on each other at the same instant.")]


def _modes(report: CausalityReport) -> list[object]:
    if not report.modes:
        return []
    names = tuple(report.modes[0].modes)
    rows = tuple((*(item.modes[name] for name in names), effect_of(item)) for item in report.modes)
    return [Table((*names, "states that it binds"), rows, caption=f"{mode_heading(report)}.")]
