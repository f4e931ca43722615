"""What to change: which parameters move the critical mode, which way and how far."""

from __future__ import annotations

import numpy

from ..plot import pretty, sensitivity_bars
from ..stability import Effect, StabilityResult
from ..units import from_si
from .blocks import Bullets, Figure, Panel, Section, Table, Text
from .summary import CHANGE, advice, ranked
from .words import number


def changing_section(result: StabilityResult) -> Section | None:
    """Rank the parameters by what they do to the critical mode's growth rate."""
    if result.critical is None:
        return None
    effects = ranked(result)
    notes = [Bullets(result.sensitivities.notes)] if result.sensitivities.notes else []
    if not effects:
        nothing = Text("No parameter moves the growth rate of the critical mode.")
        return Section("What to change", (nothing, *notes))
    blocks = (
        Text(advice(result)),
        _figure(result, effects),
        _table(effects),
        Text(_READING, "note"),
    )
    return Section("What to change", (*blocks, *notes))


_READING = (
    "How to read it: each row raises one parameter by 10 % and leaves all others; values derived "
    "from it follow, and so does the operating point. A negative change of the growth rate calms "
    "the mode. The changes are slopes at the operating point, good for small steps; how far an "
    "edge is tells a locus or a map."
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
        for item in effects
    )
    head = (
        "parameter",
        "now",
        "growth rate for +10 % [1/s]",
        "frequency for +10 % [Hz]",
        "to calm the mode",
        "meaning",
    )
    return Table(head, rows, "crrrll", labelled=True)
