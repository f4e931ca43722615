"""A discovery on the terminal, for reading."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape

from bondgraph.discrepancy.discovery import Discovery, Estimate, NamedEffect, Verdict
from bondgraph.discrepancy.report.model import diff_lines
from bondgraph.discrepancy.report.words import KINDS, changed, estimated, figure, headline, share
from bondgraph.plot import pretty

from .show import new_console, new_table

if TYPE_CHECKING:
    from bondgraph.discrepancy.report import Written

MOST = 5  # alternatives shown


def print_discovery(found: Discovery, written: Written | None = None) -> None:
    """Print verdict, effects, gaps, changes and advice.

    Parameters
    ----------
    found : Discovery
    written : Written, optional
        Where the report is.
    """
    console = new_console()
    console.print(f"[bold]{escape(found.graph.name)}: {escape(headline(found))}[/bold]")
    for sentence in found.words:
        console.print(sentence, markup=False)
    if found.effects and found.verdict != Verdict.NONE:
        title = "Nearest" if found.verdict == Verdict.UNNAMED else "Effects"
        _effects(console, title, found.effects)
    _gaps(console, found)
    _parameters(console, found)
    if found.alternatives:
        _effects(console, "Alternatives", found.alternatives[:MOST])
    if found.improved is not None and found.diff:
        console.print("\n[bold]Changes[/bold]")
        for line in diff_lines(found):
            console.print(line, markup=False)
    console.print()
    for word, lines in (
        ("not told", found.unseen),
        ("measure next", found.advice),
        ("warning", found.warnings),
    ):
        for line in lines:
            console.print(f"{word}: {line}", markup=False)
    if written is not None:
        console.print(f"report: {written.page}", markup=False)
        if written.improved is not None:
            console.print(f"improved model: {written.improved}", markup=False)


def _effects(console: Console, title: str, effects: tuple[NamedEffect, ...]) -> None:
    table = new_table(f"\n{title}", "effect", "at", "element", "parameters", "drop of BIC")
    for effect in effects:
        values = ", ".join(f"{k} = {estimated(v)}" for k, v in effect.parameters.items())
        cells = (effect.name, effect.site, effect.element, values, figure(effect.delta_bic))
        table.add_row(*map(escape, cells))
    console.print(table)


def _gaps(console: Console, found: Discovery) -> None:
    more = changed(found)
    columns = ["signal", "recordings", "as given", "before", "noise floor", "unit"]
    if more:
        columns[4:4] = ["after"]
        columns.insert(6, "removed")
    table = new_table("\nGap, root mean square", *columns)
    for kind, word in KINDS.items():
        for signal, gap in found.gap.get(kind, {}).items():
            cells = [signal, word, figure(gap.nominal), figure(gap.before)]
            cells += [figure(gap.after)] * more + [figure(gap.noise_floor)]
            cells += [share(gap.removed)] * more + [pretty(gap.unit or "1")]
            table.add_row(*map(escape, cells))
    console.print(table)


def _parameters(console: Console, found: Discovery) -> None:
    if not found.parameters:
        return
    table = new_table("\nThe model's own parameters", "name", "as given", "fitted")
    for name, estimate in found.parameters.items():
        nominal = found.nominal.get(name, float("nan"))
        table.add_row(escape(name), figure(nominal, 6), escape(_told(estimate)))
    console.print(table)


def _told(estimate: Estimate) -> str:
    return estimated(estimate) + ("" if estimate.std < float("inf") else " (not told)")
