"""How each computation behind a report ended."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from ..stability import Locus, StabilityResult
from .blocks import Figure, Section, Table, Text
from .maps import Plane
from .words import number

if TYPE_CHECKING:
    from ..attractors import Motions

# How runs may end that found what they were for.
SETTLED = ("steady", "cycle")


def solver_section(
    result: StabilityResult,
    figures: Iterable[Figure],
    maps: Iterable[Plane] = (),
    motions: Motions | None = None,
) -> Section:
    """List how each computation ended."""
    found = "isolated" if result.point.isolated else "one of many: a state is free"
    rows = [("steady state", "found", found)]
    for locus in result.loci:
        good = len(locus.values) - len(locus.gaps)
        rows.append(
            (f"locus over {locus.name}", f"{good} of {len(locus.values)} points", _reasons(locus))
        )
    for shown in maps:
        item = shown.points
        told = "; ".join(f"{label}: {count}" for label, count in item.counts().items())
        ended = f"{int(item.ok.sum())} of {len(item)} points"
        rows.append((f"map of {' and '.join(item.axes)}", ended, told))
    rows += [] if motions is None else _settled(motions)
    for figure in figures:
        if figure.run is not None:
            rows.append((f"run of {figure.title}", figure.run.outcome.value, _run(figure)))
    reading = Text(
        "What was computed for this page and how it ended. The energy residual of a run is what its "
        "energy balance fails to close by, over all energy supplied.",
        "note",
    )
    head = ("computation", "outcome", "details")
    return Section("Solver outcomes", (Table(head, tuple(rows)), reading))


def _settled(motions: Motions) -> list[tuple[str, str, str]]:
    """Tell how the runs from several starts and along parameters ended."""
    ended = [(item.kind, len(item.starts)) for item in motions.attractors.found]
    good = sum(count for kind, count in ended if kind in SETTLED)
    told = "; ".join(f"{kind}: {count}" for kind, count in ended)
    rows = [("runs from several starts", f"{good} of {sum(c for _, c in ended)} settled", told)]
    for found in motions.reaches:
        good = sum(point.outcome in SETTLED for point in found.points)
        ended_there = f"{good} of {len(found.points)} settled"
        rows.append((f"own start over {found.name}", ended_there, "; ".join(found.notes)))
    if motions.trends:
        points = [p for item in motions.trends for p in (item.lower, item.upper)]
        good = sum(point.outcome in SETTLED for point in points)
        ended_there = f"{good} of {len(points)} settled"
        rows.append(("own start, parameters moved", ended_there, "; ".join(motions.notes)))
    return rows


def _reasons(locus: Locus) -> str:
    return "; ".join(dict.fromkeys(gap.reason for gap in locus.gaps))


def _run(figure: Figure) -> str:
    run = figure.run
    assert run is not None
    residual = run.energy.relative_residual
    energy = "no energy audit" if residual is None else f"relative energy residual {residual:.1e}"
    return (
        f"to {number(run.t_end)} s in {run.steps} steps ({run.backend}), {len(run.events)} changes "
        f"of mode, {energy}"
    )
