"""What else was fitted, what the data cannot tell, and what was done."""

from __future__ import annotations

from collections.abc import Sequence

import numpy

from ...report import Bullets, Section, Table, Text
from ..discovery import Discovery, Explanation
from ..measurement import Measurement
from .words import KINDS, estimated, figure, share

MOST = 25  # explanations listed


def alternative_section(found: Discovery) -> Section | None:
    """List all that was fitted, best first, with the evidence; None where nothing was."""
    if not found.ranked:
        return None
    rows = tuple(_explanation(item, found) for item in found.ranked[:MOST])
    head = ("explanation", "drop of BIC", "held-out gap removed", "parameters", "verdict")
    note = (
        "Best first. Drop of BIC: evidence over the model by itself, in independent samples. "
        "Held-out gap removed: share above the noise floor."
    )
    blocks: list[object] = [Table(head, rows, "lrrll", labelled=True), Text(note, "note")]
    if len(found.ranked) > MOST:
        blocks.append(Text(f"{len(found.ranked) - MOST} more were worse.", "note"))
    return Section("What else was tried", tuple(blocks))


def _explanation(item: Explanation, found: Discovery) -> tuple[str, ...]:
    values = [
        f"{name} = {estimated(estimate)}"
        for effect in item.effects
        for name, estimate in effect.parameters.items()
    ]
    if item.failed:
        said = "not named: " + "; ".join(item.failed)
    elif not item.effects:
        said = "the model by itself"
    else:
        said = "may be named"
    mark = " (shown above)" if item is found.chosen and item.effects else ""
    return (
        item.label,
        figure(item.delta_bic),
        share(item.removed) if item.effects else "",
        ", ".join(values),
        said + mark,
    )


def told_sections(found: Discovery, remark: str = "") -> list[Section]:
    """Say what the data cannot tell, what to measure next, and warn."""
    parts = {
        "What the data cannot tell": found.unseen,
        "What to measure next": found.advice,
        "Warnings": (*found.warnings, *filter(None, [remark])),
    }
    sections = [
        Section(title, (Bullets(tuple(dict.fromkeys(lines))),))
        for title, lines in parts.items()
        if lines
    ]
    if found.alike:
        sections.insert(bool(found.unseen), _alike_section(found.alike))
    return sections


def _alike_section(classes: Sequence[Sequence[str]]) -> Section:
    """List effects whose traces in these recordings are alike."""
    rows = tuple((str(len(members)), ", ".join(members)) for members in classes[:MOST])
    note = (
        "To first order, with the model's own parameters free: had the one been missing, the others "
        "would explain it nearly as well."
    )
    return Section(
        "What these data cannot tell apart",
        (Table(("effects", "at their sites"), rows, "rl"), Text(note, "note")),
    )


def done_section(found: Discovery) -> Section:
    """List recordings, time spent and what was taken for granted."""
    rows = [
        *(_recording(run, KINDS["train"]) for run in found.recordings),
        *(_recording(run, KINDS["validation"]) for run in found.held_out),
    ]
    blocks: list[object] = []
    if rows:
        head = ("recording", "used as", "samples", "from [s]", "to [s]", "step [s]", "columns")
        blocks.append(Table(head, tuple(rows), "llrrrrl", labelled=True))
    tried = len(found.ranked)
    blocks.append(
        Text(
            f"{tried} explanation{'s' * (tried != 1)} of {found.graph.name} "
            f"{'were' if tried != 1 else 'was'} fitted in {found.seconds:.1f} s."
        )
    )
    blocks += [Text("Taken for granted:"), Bullets(tuple(_assumptions(found)))]
    return Section("What was done", tuple(blocks))


def _recording(run: Measurement, kind: str) -> tuple[str, ...]:
    return (
        run.name,
        kind,
        str(len(run)),
        figure(float(run.t[0]), 6),
        figure(float(run.t[-1]), 6),
        figure(float(numpy.median(numpy.diff(run.t)))),
        ", ".join(run.columns),
    )


def _assumptions(found: Discovery) -> Sequence[str]:
    runs = (*found.recordings, *found.held_out)
    held: dict[str, set[str]] = {}
    for symbol in found.graph.inputs:
        for run in runs:
            if symbol.name in run.columns:
                held.setdefault(symbol.name, set()).add(run.holds.get(symbol.name, "linear"))
    words = {
        "zero": "held at its last sample",
        "linear": "a straight line",
        "band": "band-limited",
    }
    lines = [
        f"between samples, {name} is {' or '.join(words[kind] for kind in sorted(kinds))}"
        for name, kinds in held.items()
    ]
    lines.append("noise of the sensors adds to the signals and is no larger than the noise floor")
    lines.append("what is missing is the same in all recordings")
    if not found.held_out:
        lines.append("nothing was held out: the gaps are those of the recordings it learned from")
    return lines
