"""What was found: effects with their parameters, laws and sources."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

import sympy

from ...plot import learned_law, pretty
from ...report import Bullets, Figure, Panel, Section, Table, Text
from ...report.blocks import Markup
from ...report.mathml import formula
from ..candidates import DISPLACEMENT, EFFECTS, EFFORT, FLOW, MEMORY, MOMENTUM, SIGNAL
from ..discovery import Discovery, NamedEffect, Verdict
from .words import figure, file_names, rounded, spread

_TITLES = {
    Verdict.NAMED: "What was found",
    Verdict.AMBIGUOUS: "What it may be",
    Verdict.UNNAMED: "The nearest of the known effects",
}
_LEADS = {
    Verdict.AMBIGUOUS: "These explain the recordings equally well: one of them is missing, and the "
    "recordings cannot tell which.",
    Verdict.UNNAMED: "These come nearest, but do not pass the tests that a name must pass. Do not "
    "take them for the cause.",
}
_LETTERS = {
    FLOW: "flow",
    EFFORT: "effort",
    DISPLACEMENT: "displacement, the flow's integral",
    MOMENTUM: "momentum, the effort's integral",
    SIGNAL: "what stood there before",
    MEMORY: "inner state",
}
# how the keys of a law read before an equals sign
_LEFT = {"kinetic": "size of the effort in slip", "slip": "flow that slips"}


def found_section(found: Discovery) -> Section | None:
    """List effects and parameters; None where nothing is missing."""
    if found.verdict == Verdict.NONE or not found.effects:
        return None
    lead = _LEADS.get(found.verdict)
    failed = found.chosen.failed if found.verdict == Verdict.UNNAMED else ()
    blocks: list[object] = [Text(lead)] if lead else []
    if failed:
        blocks += [Text("Why it may not be named:"), Bullets(tuple(failed))]
    blocks += [*_effects(found.effects), *_parameters(found.effects), *_laws(found.effects)]
    return Section(_TITLES[found.verdict], tuple(blocks))


def _effects(effects: Iterable[NamedEffect]) -> list[object]:
    rows = tuple(
        (
            effect.name,
            effect.site,
            effect.element,
            figure(effect.delta_bic),
            effect.words or (known.meaning if (known := EFFECTS.get(effect.name)) else ""),
            EFFECTS[effect.name].reference if effect.name in EFFECTS else "",
        )
        for effect in effects
    )
    head = ("effect", "at", "element in the graph", "drop of BIC", "what it is", "reference")
    note = (
        "Drop of BIC: by how much the Bayesian information criterion falls with it, counted in "
        "independent samples. Ten is strong evidence."
    )
    return [Table(head, rows, "clcrll", labelled=True), Text(note, "note")]


def _parameters(effects: Iterable[NamedEffect]) -> list[object]:
    rows = tuple(
        (
            name,
            effect.label,
            rounded(estimate.value, estimate.std),
            spread(estimate.std),
            pretty(estimate.unit or "1"),
            _meaning(effect.name, name),
        )
        for effect in effects
        for name, estimate in effect.parameters.items()
    )
    head = ("parameter", "of", "value", "std", "unit", "meaning")
    note = "Std: standard deviation, from the curvature of the fit."
    return [Table(head, rows, "clrrll", labelled=True), Text(note, "note")]


def _meaning(effect: str, coefficient: str) -> str:
    known = EFFECTS[effect].coefficients if effect in EFFECTS else ()
    return next((item.meaning for item in known if item.name == coefficient), "")


def _laws(effects: Iterable[NamedEffect]) -> list[object]:
    """Show each kind of effect's law as a formula, once, with what the letters mean."""
    names = [name for name in dict.fromkeys(effect.name for effect in effects) if name in EFFECTS]
    if not names:
        return []
    lines, used = [], set[sympy.Basic]()
    for name in names:
        lines.append(f"<p><code>{escape(name)}</code></p>")
        for key, law in EFFECTS[name].law.items():
            left = f"<mtext>{escape(_LEFT.get(key, key))}</mtext>"
            lines.append(
                f'<math display="block"><mrow>{left}<mo>=</mo>{formula(law)}</mrow></math>'
            )
            used |= law.free_symbols
    letters = "; ".join(f"{symbol}: {word}" for symbol, word in _LETTERS.items() if symbol in used)
    blocks: list[object] = [Markup(f'<div class="formulas">{"".join(lines)}</div>')]
    return [*blocks, Text(f"{letters}.", "note")] if letters else blocks


def law_section(found: Discovery) -> Section | None:
    """Show laws over the data that say so."""
    if not found.laws:
        return None
    numbered = [f"{number} {law.effect}" for number, law in enumerate(found.laws, start=1)]
    files = file_names(numbered)
    figures = tuple(
        Figure(
            f"{law.effect}.",
            (
                Panel(
                    f"law-{files[name]}",
                    learned_law(law),
                    f"{law.along} over {law.across}",
                ),
            ),
            "Dots: what the recordings ask for at each moment, before any law is chosen. Line: the "
            "law that was fitted; the band about it is two standard deviations wide on either side.",
        )
        for name, law in zip(numbered, found.laws, strict=True)
    )
    return Section("The law in the data", figures)
