"""What decides: the critical mode, what takes part in it, what feeds it and what drains it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy

from ..plot import feed_bars, share_bars
from ..stability import Mode, StabilityResult
from ..stability.verdict import along, duration
from .blocks import Figure, Panel, Section, Table, Text
from .words import number

# Smaller shares are left out of the table.
NEGLIGIBLE = 1e-3
# Of many elements the table holds those with the largest shares and feeds.
MOST = 15


def deciding_section(result: StabilityResult) -> Section:
    """Describe the critical mode."""
    mode = result.critical
    if mode is None:
        nothing = Text("Without states nothing can move, grow or decay.")
        return Section("What decides it", (nothing,))
    distances = [along(locus) for locus in result.loci]  # told beside the loci
    sentences = [Text(sentence) for sentence in result.reasons if sentence not in distances]
    return Section(
        "What decides it",
        (
            Text(_introduced(mode)),
            *sentences,
            _table(mode),
            Text(_reading(mode), "note"),
            *_plots(mode),
        ),
    )


def _introduced(mode: Mode) -> str:
    """Say which mode is meant, and what a mode is."""
    kind = (
        f"an oscillation at {number(mode.frequency_hz, 4)} Hz"
        if mode.eigenvalue.imag
        else "a motion without oscillation"
    )
    rate = number(mode.eigenvalue.real, 4)
    ratio = mode.damping_ratio
    damping = (
        "" if ratio is None or not mode.eigenvalue.imag else f", damping ratio {number(ratio, 4)}"
    )
    if mode.growth:
        way = "grows" if mode.growth > 0 else "decays"
        time = (
            f" Left alone it {way} by a factor of 2.7 every {duration(mode.time_constant)}, and by "
            f"a factor of 10 every {duration(mode.time_constant * float(numpy.log(10)))}."
        )
    else:
        time = " Left alone it neither grows nor decays."
    return (
        "Any small motion is a sum of modes, patterns that each grow or decay at a rate of their "
        f"own. The critical mode, the one nearest to growing or growing fastest, is {kind} "
        f"(growth rate {rate}\u00a01/s{damping}).{time}"
    )


def _elements(mode: Mode) -> list[str]:
    """Return the elements that have something to do with a mode, storages first."""
    least = NEGLIGIBLE * max(map(abs, mode.feeds.values()), default=0.0)
    kept = [name for shares in (mode.carriers, mode.energies) for name in _worth(shares)[:MOST]]
    feeds = sorted(mode.feeds.items(), key=lambda item: -abs(item[1]))[:MOST]
    return list(dict.fromkeys([*kept, *(name for name, rate in feeds if abs(rate) > least)]))


def _worth(shares: Mapping[str, float]) -> list[str]:
    return [name for name, share in shares.items() if abs(share) > NEGLIGIBLE]


def _table(mode: Mode) -> Table:
    rows = tuple(
        (
            name,
            _percent(mode.carriers.get(name)),
            _percent(mode.energies.get(name)),
            f"{mode.feeds[name]:+.4g}" if name in mode.feeds else "",
        )
        for name in _elements(mode)
    )
    head = ("element", "takes part", "holds energy", "feeds (+) or drains (-) [1/s]")
    return Table(head, rows, "crrr", labelled=True)


def _percent(share: float | None) -> str:
    if share is None:
        return ""
    return f"{share:.1%}"


def _reading(mode: Mode) -> str:
    text = (
        "How to read it: an element takes part as far as its state moves in the mode and the mode "
        "answers to it (participation factors, 100 % in all). Elements below 0.1 % are left out, and "
        f"of very many all but the {MOST} largest."
    )
    if mode.energies and not mode.feeds:
        return f"{text} Nothing feeds or drains this mode."
    if not mode.feeds:
        return f"{text} The energy of this mode cannot be told, so neither can what feeds it."
    text += (
        " It holds energy as the mode's stored energy lies in it. What feeds or drains is its "
        "power in the mode over twice the mode's energy; these add up to the growth rate, "
        f"{number(mode.eigenvalue.real, 4)} 1/s."
    )
    if not mode.telling:
        text += (
            " Most energy of this mode lies outside the elements that take part most: it drives "
            "them, and what feeds or drains is their balance."
        )
    return text


def _plots(mode: Mode) -> list[Figure]:
    panels = [
        Panel(
            "mode-shares",
            share_bars(mode),
            f"Bars: share of each element in the critical mode; most in {', '.join(mode.elements)}",
            _share_numbers(mode),
        )
    ]
    if mode.feeds:
        panels.append(
            Panel(
                "mode-feeds",
                feed_bars(mode),
                "Bars: what each element adds to the growth rate of the critical mode",
                {
                    "element": numpy.array(list(mode.feeds)),
                    "adds to the growth rate [1/s]": numpy.array(list(mode.feeds.values())),
                },
            )
        )
    caption = (
        "First: where the motion and its energy are. Second: orange bars feed the motion, blue "
        "bars take energy out of it; it grows where orange outweighs blue. Bars below 1 % are left "
        "out."
        if mode.feeds
        else "Where the motion is."
    )
    return [Figure("The critical mode.", tuple(panels), caption)]


def _share_numbers(mode: Mode) -> dict[str, numpy.ndarray]:
    names = list(dict.fromkeys([*mode.carriers, *mode.energies]))
    columns = {"element": numpy.array(names)}
    for heading, shares in (("takes part [1]", mode.carriers), ("holds energy [1]", mode.energies)):
        if shares:
            columns[heading] = numpy.array([shares.get(name, 0.0) for name in names])
    return columns
