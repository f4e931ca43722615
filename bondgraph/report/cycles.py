"""Limit cycles beside the verdict: what runs end in, which eigenvalues do not tell."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..errors import BondGraphError
from ..plot import attractor_plot, pretty, reach_plot
from .blocks import Bullets, Figure, Panel, Section, Table, Text
from .words import number, slug

if TYPE_CHECKING:
    from ..attractors import Attractor, Attractors, Motions, Reach, ReachPoint, Trend

# Swings of this many outputs stand in the table; what hardly swings is left out.
MOST = 4
STILL = 1e-9


def cycle_section(motions: Motions | None) -> Section | None:
    """Show what the model ends in from several starts, and what that depends on."""
    if motions is None:
        return None
    found = motions.attractors
    blocks: list[object] = [Text(_INTRODUCTION), Text(found.words), _table(found)]
    blocks.append(Text(_READING, "note"))
    figure = _figure(found)
    if figure is not None:
        blocks.append(figure)
    blocks += [block for item in motions.reaches for block in _reach(item)]
    blocks += _trends(motions.trends)
    notes = [*found.notes, *(note for item in found.found for note in item.notes), *motions.notes]
    notes += [note for item in motions.reaches for note in item.notes]
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


def _reach(found: Reach) -> list[object]:
    """Show what the own start ends in along a parameter."""
    if not any(point.outcome in ("steady", "cycle") for point in found.points):
        return [Text(found.words)]
    panel = Panel(
        f"reach-{slug(found.name)}",
        reach_plot(found),
        f"What the model's own start ends in over {found.name}",
    )
    caption = (
        f"{found.words} Full dots: a cycle, hollow: a steady state; dashed: where it changes. An edge "
        "of the eigenvalues is another matter: that tells of small motions about the steady state."
    )
    return [Figure(f"What the model's own start ends in along {found.name}.", (panel,), caption)]


def _trends(found: Sequence[Trend]) -> list[object]:
    """Tell which way each parameter leads towards vibration, as runs of the own start say."""
    told = [item for item in found if item.furthers]
    if not told:
        return []
    share = f"{100 * told[0].change:.0f} %"
    rows = tuple(
        (
            item.parameter,
            "more" if item.furthers > 0 else "less",
            *_ends(item),
            item.meaning,
        )
        for item in told
    )
    head = (
        "parameter",
        "vibration is furthered by",
        f"{share} less",
        "now",
        f"{share} more",
        "meaning",
    )
    reading = (
        "How to read it: the model's own start is run again with one parameter changed. What the "
        "run ends in, and how near its contacts come to sticking on the way (least slip, SI), or, where "
        "it vibrates anyway, how far the output named swings (SI), says which way leads towards "
        "vibration. Eigenvalues know nothing of it: how fast a load comes on moves none of them and "
        "may decide all the same."
    )
    return [
        Text("What furthers vibration, as runs tell:"),
        Table(head, rows, "clllll", labelled=True),
        Text(reading, "note"),
    ]


def _ends(trend: Trend) -> tuple[str, str, str]:
    """Say what the start ends in at the three values, and what is compared there."""
    points = (trend.lower, trend.here, trend.upper)
    told = [_ended(point) for point in points]
    if trend.swings is not None and all(point.outcome == "cycle" for point in points):
        name, *sizes = trend.swings
        told = [f"{word}, {name} {number(size, 4)}" for word, size in zip(told, sizes, strict=True)]
    return told[0], told[1], told[2]


def _ended(point: ReachPoint) -> str:
    slip = min(point.margins.values(), default=None)
    if point.outcome == "cycle" and point.frequency_hz is not None:
        return f"cycle, {number(point.frequency_hz, 4)} Hz"
    words = {"steady": "settles"}.get(point.outcome, point.outcome)
    return words if slip is None else f"{words}, least slip {number(slip, 4)}"
