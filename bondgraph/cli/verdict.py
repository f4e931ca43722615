"""A stability verdict on the terminal, in the order of the report's page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rich.console import Console

from .show import new_console, new_table

if TYPE_CHECKING:
    from bondgraph.attractors import Motions
    from bondgraph.report import Plane
    from bondgraph.stability import Mode, StabilityResult

# Rows of a table on a terminal: what matters most, not all there is.
ROWS = 6


def stability_tables(
    result: StabilityResult, maps: Sequence[Plane] = (), motions: Motions | None = None
) -> None:
    """Print a verdict for reading: what decides, what to change, then the tables."""
    from bondgraph.report import headline
    from bondgraph.stability.verdict import along

    console = new_console()
    distances = [along(locus) for locus in result.loci]
    rest = [sentence for sentence in result.reasons if sentence not in distances]
    attractors = None if motions is None else motions.attractors
    console.print(f"[bold]{headline(result, attractors)}[/bold]")
    for sentence in result.verdict.splitlines():
        console.print(sentence, soft_wrap=False, markup=False)
    _deciding(console, result.critical, rest)
    _changing(console, result)
    _eigenvalues(console, result)
    _edges(console, result, distances)
    for found in (shown.points for shown in maps):
        stable, solved = int(found.stable.sum()), int(found.ok.sum())
        console.print(
            f"map of {' and '.join(found.axes)}: {stable} of {solved} points stable, "
            f"{len(found) - solved} without a result",
            markup=False,
        )
    if motions is not None:
        console.print("\n[bold]Limit cycles beside the verdict[/bold]")
        for words in _motion_words(motions):
            console.print(words, soft_wrap=False, markup=False)


def map_json(shown: Plane) -> dict[str, Any]:
    """Return what ``--json`` tells of a map."""
    found = shown.points
    return {
        "axes": list(found.axes),
        "shape": list(found.shape),
        "stable": int(found.stable.sum()),
        "outcomes": found.counts(),
    }


def _deciding(console: Console, mode: Mode | None, rest: list[str]) -> None:
    if mode is None:
        return
    console.print("\n[bold]What decides it[/bold]")
    for sentence in rest:
        console.print(sentence, soft_wrap=False, markup=False)
    table = new_table("", "element", "takes part", "holds energy", "feeds (+), drains (-) [1/s]")
    table.title = None
    for column in table.columns[1:]:
        column.justify = "right"
    for name in _telling(mode):
        shares = (mode.carriers.get(name), mode.energies.get(name))
        told = ["" if share is None else f"{share:.1%}" for share in shares]
        table.add_row(name, *told, f"{mode.feeds[name]:+.4g}" if name in mode.feeds else "")
    console.print(table)


def _telling(mode: Mode) -> list[str]:
    """Return the elements that matter most, storages first."""
    least = 1e-3 * max(map(abs, mode.feeds.values()), default=0.0)
    parts = [name for name, share in mode.carriers.items() if share > 1e-3][:ROWS]
    feeds = sorted(mode.feeds, key=lambda name: -abs(mode.feeds[name]))
    feeds = [name for name in feeds if abs(mode.feeds[name]) > least][:ROWS]
    return list(dict.fromkeys([*parts, *feeds]))


def _changing(console: Console, result: StabilityResult) -> None:
    from bondgraph.plot import pretty
    from bondgraph.report import ranked, unmoved
    from bondgraph.units import from_si

    if result.critical is None:
        return
    console.print("\n[bold]What to change[/bold]")
    if unmoved(result):
        console.print(unmoved(result))
    effects = ranked(result)[:ROWS]
    if effects:
        edges = {item.parameter: item for item in result.margins if item.nearest is not None}
        table = new_table(
            "", "parameter", "now", "edge at", "growth [1/s]", "frequency [Hz]", "to calm"
        )
        table.title = None
        for column in table.columns[1:5]:
            column.justify = "right"
        for item in effects:
            growth, frequency = item.growth(0.1), item.frequency(0.1)
            near = edges[item.parameter].nearest if item.parameter in edges else None
            table.add_row(
                item.parameter,
                f"{from_si(item.value, item.unit):.5g} {pretty(item.unit)}".strip(),
                "" if near is None else f"{from_si(near.value, item.unit):.5g}",
                f"{growth:+.3g}",
                f"{frequency:+.3g}",
                "lower it" if growth > 0 else "raise it",
            )
        console.print(table)
        console.print(
            "Growth and frequency: changes of the critical mode for 10 % more of the parameter. "
            "Edge: where stability is lost or won, between a tenth and ten times the value now.",
            soft_wrap=False,
        )
    for note in result.sensitivities.notes:
        console.print(f"note: {note}", markup=False, soft_wrap=False)


def _eigenvalues(console: Console, result: StabilityResult) -> None:
    table = new_table(
        "\nEigenvalues", "eigenvalue [1/s]", "frequency [Hz]", "damping", "stable", "carried by"
    )
    for column in table.columns[:3]:
        column.justify = "right"
    for row in result.rows:
        value = row.eigenvalue
        shown = f"{value.real:.6g}" + (f" {value.imag:+.6g}j" if value.imag else "")
        ratio = "" if row.damping_ratio is None else f"{row.damping_ratio:.4g}"
        table.add_row(
            shown,
            f"{row.frequency_hz:.6g}",
            ratio,
            {1: "NO", 0: "neither", -1: "yes"}[row.growth],
            ", ".join(row.elements),
        )
    console.print(table)


def _edges(console: Console, result: StabilityResult, distances: list[str]) -> None:
    from bondgraph.plot import pretty
    from bondgraph.units import from_si

    if distances:
        console.print("\n[bold]How far the edge is[/bold]")
    for sentence in distances:
        console.print(sentence, soft_wrap=False, markup=False)
    for edge in result.edges:
        onset = "" if edge.onset is None else f", onset {edge.onset.kind}"
        frequency = f", {edge.frequency_hz:.6f} Hz" if edge.frequency_hz else ""
        value = f"{from_si(edge.value, edge.unit):.9g} {pretty(edge.unit)}".strip()
        console.print(
            f"edge: {edge.kind} at {edge.parameter} = {value}{frequency}{onset}",
            markup=False,
        )


def _motion_words(motions: Motions) -> list[str]:
    """Return what runs tell, a paragraph each."""
    found, trends = motions.attractors, motions.trends
    furthers = {
        word: ", ".join(item.parameter for item in trends if item.furthers == sense)
        for word, sense in (("more", 1), ("less", -1))
    }
    told = [f"{word} {names}" for word, names in furthers.items() if names]
    return [
        found.words,
        *(item.words for item in motions.reaches),
        *(
            [f"Runs of the own start are led towards vibration by {'; by '.join(told)}."]
            if told
            else []
        ),
        *(f"note: {note}" for note in (*found.notes, *motions.notes)),
    ]
