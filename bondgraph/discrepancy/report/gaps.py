"""How far the model is from the recordings, signal by signal."""

from __future__ import annotations

from collections.abc import Mapping

import numpy

from ...plot import gap_shares, new_axes, pretty
from ...report import Figure, Panel, Section, Table, Text
from ..discovery import Discovery, Gap
from .words import KINDS, changed, figure, share


def gap_section(found: Discovery) -> Section:
    """List the gaps before and after, of training and held-out recordings."""
    kinds = [kind for kind in KINDS if found.gap.get(kind)]
    if not kinds:
        return Section("How far the model is off", (Text("No signal was compared."),))
    more = changed(found)
    held = "validation" in kinds
    lead = (
        "Root mean square of measured less model. Held-out recordings were not used to learn: "
        "what shrinks there is understood, not only fitted."
        if held
        else "Root mean square of measured less model. No recording was held out: a gap may also "
        "shrink because there is more to fit with."
    )
    figure = Figure(
        "Gaps over their noise floors.",
        tuple(_panel(kind, found.gap[kind], more) for kind in kinds),
        "At the dash-dotted line the model is as good as the sensors."
        + (" First the recordings it learned from, then those held out." if held else ""),
    )
    return Section("How far the model is off", (Text(lead), *_table(found, kinds, more), figure))


def _table(found: Discovery, kinds: list[str], more: bool) -> list[object]:
    head: tuple[str, ...] = ("signal", "recordings", "unit", "as given", "before")
    head += ("after",) * more + ("noise floor",) + ("removed",) * more
    rows = tuple(
        _row(signal, KINDS[kind], gap, more)
        for kind in kinds
        for signal, gap in found.gap[kind].items()
    )
    note = "Before: with the model's own parameters fitted."
    if more:
        note += (
            f" After: with {found.chosen.label}, fitted too. Removed: share of what lies above the "
            "noise floor that is gone."
        )
    return [Table(head, rows, "cllrrrrr", labelled=True), Text(note, "note")]


def _row(signal: str, kind: str, gap: Gap, more: bool) -> tuple[str, ...]:
    cells: tuple[str, ...] = (signal, kind, pretty(gap.unit or "1"))
    cells += (figure(gap.nominal), figure(gap.before))
    cells += (figure(gap.after),) * more + (figure(gap.noise_floor),)
    return cells + (share(gap.removed),) * more


def _panel(kind: str, gaps: Mapping[str, Gap], more: bool) -> Panel:
    ax = gap_shares(gaps, changed=more, ax=new_axes((5.0, 1.3 + 0.32 * len(gaps))))
    numbers = {
        f"{signal}: {word} [{gap.unit or '1'}]": numpy.array([value])
        for signal, gap in gaps.items()
        for word, value in (
            ("as given", gap.nominal),
            ("before", gap.before),
            ("after", gap.after),
            ("noise floor", gap.noise_floor),
        )
    }
    words = f"Gap of each signal over its noise floor, recordings {KINDS[kind]}"
    return Panel(f"gap-{kind}", ax, words, numbers)
