"""What to change: which parameters move the critical mode, which way and how far."""

from __future__ import annotations

import numpy

from ..plot import pretty, sensitivity_bars
from ..stability import Effect, Margin, StabilityResult
from ..stability.advice import CHANGE
from ..units import from_si
from .blocks import Bullets, Figure, Panel, Section, Table, Text
from .summary import onset_words, ranked, unmoved
from .words import number

# Of more parameters the table holds the strongest; the CSV of the plot has all.
MOST = 25


def changing_section(result: StabilityResult) -> Section | None:
    """Rank the parameters by what they do to the critical mode's growth rate."""
    if result.critical is None:
        return None
    effects = ranked(result)
    notes = [Bullets(result.sensitivities.notes)] if result.sensitivities.notes else []
    blocks: list[object] = [Bullets(result.advice)] if result.advice else []
    if not effects:
        blocks.append(Text(unmoved(result)))
    else:
        blocks += [_figure(result, effects), _table(effects), Text(_READING, "note")]
    return Section("What to change", (*blocks, *notes, *_margins(result)))


_READING = (
    "How to read it: each row raises one parameter by 10 % and leaves all others; values derived "
    "from it follow, and so does the operating point. A negative change of the growth rate calms "
    "the mode. The changes are slopes at the operating point, good for small steps only."
)


def _figure(result: StabilityResult, effects: tuple[Effect, ...]) -> Figure:
    numbers = {
        "parameter": numpy.array([item.parameter for item in effects]),
        "change of the growth rate for +10% [1/s]": numpy.array(
            [item.growth(CHANGE) for item in effects]
        ),
        "change of the frequency for +10% [Hz]": numpy.array(
            [item.frequency(CHANGE) for item in effects]
        ),
    }
    panel = Panel(
        "sensitivities",
        sensitivity_bars(effects, CHANGE),
        "Bars: change of the critical mode's growth rate when each parameter is raised by 10 %",
        numbers,
    )
    rate = result.critical.eigenvalue.real if result.critical else 0.0
    caption = (
        "Growth rate of the critical mode when one parameter is raised by 10 %. Blue calms it, "
        f"orange drives it; to lower a parameter does the opposite. It stands at {number(rate, 4)} "
        "1/s now, and the mode grows where it is above zero."
    )
    return Figure("What moves the critical mode.", (panel,), caption)


def _table(effects: tuple[Effect, ...]) -> Table:
    rows = tuple(
        (
            item.parameter,
            f"{number(from_si(item.value, item.unit))} {pretty(item.unit)}".strip(),
            f"{item.growth(CHANGE):+.4g}",
            f"{item.frequency(CHANGE):+.4g}",
            "lower it" if item.growth(CHANGE) > 0 else "raise it",
            item.meaning,
        )
        for item in effects[:MOST]
    )
    head = (
        "parameter",
        "now",
        "growth rate for +10 % [1/s]",
        "frequency for +10 % [Hz]",
        "to calm the mode",
        "meaning",
    )
    caption = f"The {MOST} strongest of {len(effects)}." if len(effects) > MOST else ""
    return Table(head, rows, "crrrll", caption, labelled=True)


def _margins(result: StabilityResult) -> list[object]:
    """Show how far each parameter may go, and name those that have no edge."""
    found = result.margins
    near = [item for item in found if item.nearest is not None]
    if not found:
        return []
    blocks: list[object] = []
    if near:
        rows = tuple(_margin(item) for item in near)
        head = (
            "parameter",
            "now",
            "edge below",
            "edge above",
            "nearest",
            "there",
            "meaning",
        )
        caption = (
            "How far each parameter may go, all others kept, until the system is unstable."
            if result.stable
            else "How far each parameter must go, all others kept, until the system is stable."
        )
        blocks += [Table(head, rows, "crrrrll", caption, labelled=True), Text(_MARGINS, "note")]
    without = [item.parameter for item in found if item.nearest is None]
    if without:
        blocks.append(
            Text(
                f"No edge between a tenth and ten times the present value along {', '.join(without)}."
            )
        )
    return blocks


_MARGINS = (
    "How to read it: the first value at which stability is lost or won when one parameter is "
    "lowered or raised and all others stay; the nearest as a factor on the present value. Soft: "
    "behind the edge a vibration starts small and grows with the distance. Hard: it jumps to a "
    "large one at once, and a push can set it off before the edge is reached."
)


def _margin(item: Margin) -> tuple[str, ...]:
    factor, edge = item.factor, item.nearest
    assert edge is not None
    unit = pretty(item.unit)

    def shown(value: float) -> str:
        return f"{number(from_si(value, item.unit))} {unit}".strip()

    return (
        item.parameter,
        shown(item.value),
        "" if item.below is None else shown(item.below.value),
        "" if item.above is None else shown(item.above.value),
        "" if factor is None else f"x {factor:.3g}",
        onset_words(edge),
        item.meaning,
    )
