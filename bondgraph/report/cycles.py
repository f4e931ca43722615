"""Limit cycles beside the verdict: what runs end in, which eigenvalues do not tell."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import BondGraphError
from ..plot import attractor_plot, pretty
from .blocks import Bullets, Figure, Panel, Section, Table, Text
from .words import number

if TYPE_CHECKING:
    from ..attractors import Attractor, Attractors

# Swings of this many outputs stand in the table; what hardly swings is left out.
MOST = 4
STILL = 1e-9


def cycle_section(found: Attractors | None) -> Section | None:
    """Show what the model ends in from several starts, with the smallest push that matters."""
    if found is None:
        return None
    blocks: list[object] = [Text(_INTRODUCTION), Text(found.words), _table(found)]
    blocks.append(Text(_READING, "note"))
    figure = _figure(found)
    if figure is not None:
        blocks.append(figure)
    notes = [*found.notes, *(note for item in found.found for note in item.notes)]
    if notes:
        blocks += [Text("Notes on the runs:"), Bullets(tuple(dict.fromkeys(notes)))]
    return Section("Limit cycles beside the verdict", tuple(blocks))


_INTRODUCTION = (
    "Eigenvalues tell of small motions. A vibration that keeps itself going, a limit cycle, may live "
    "beside a steady state that is stable for small motions; which of both a run ends in depends on "
    "where it starts. So the model was run from several starts until each had settled."
)
_READING = (
    "How to read it: a row for each thing that runs end in. Stable: whether small disturbances of it "
    "die away. Held: share of a period in which a contact sticks or another switching element holds. "
    "Swings: from least to largest value. Reached from: the starts that lead there; what no start "
    "leads to is not found."
)


def _table(found: Attractors) -> Table:
    rows = tuple(
        (
            {"steady": "steady state", "cycle": "limit cycle"}.get(item.kind, item.kind),
            "" if item.frequency_hz is None else number(item.frequency_hz),
            {True: "yes", False: "no", None: "not known"}[item.stable],
            ", ".join(f"{name} {share:.0%}" for name, share in item.held.items() if share),
            _swings(item),
            ", ".join(item.starts),
        )
        for item in found.found
    )
    head = ("ends in", "frequency [Hz]", "stable", "held", "swings", "reached from")
    return Table(head, rows, "lrllll")


def _swings(item: Attractor) -> str:
    told = [
        f"{name} {number(swing.peak_to_peak, 4)} {pretty(item.units.get(name, ''))}".strip()
        for name, swing in item.amplitudes.items()
        if swing.peak_to_peak > STILL * max(abs(swing.least), abs(swing.most))
    ]
    more = [f"{len(told) - MOST} more"] if len(told) > MOST else []
    return ", ".join([*told[:MOST], *more])


def _figure(found: Attractors) -> Figure | None:
    if not found.cycles:
        return None
    try:
        ax = attractor_plot(found)
    except BondGraphError:  # nothing that could be drawn in a plane
        return None
    caption = (
        "Each loop is once round a cycle. Full dots: a contact begins to stick; hollow: it lets go. "
        "Large dot: the steady state, hollow where it is unstable."
    )
    if found.edge is not None and found.edge.to is not None:
        caption += " The dashed line is the smallest push that leads to a cycle."
    panel = Panel("attractors", ax, "Phase plane with the cycles and steady states found")
    return Figure("What runs end in.", (panel,), caption)
