"""Eigenvalues in the report: the modal table, the loci with their edges, friction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy

from ..elements import Friction
from ..plot import friction_curve, growth_rates, pretty, root_locus
from ..stability import Edge, Locus, Mode, StabilityResult
from ..stability.advice import CHANGE
from ..stability.verdict import along, duration
from ..units import from_si
from .blocks import Figure, Panel, Section, Table, Text
from .summary import ONSETS
from .words import coherent, number, slug

CARRIERS = 3
# Parameters told for each mode.
MOVERS = 3
# A state matrix of more rows is left to the JSON.
READABLE = 24


def eigenvalue_section(result: StabilityResult) -> Section:
    """List the modes and what carries, feeds and drains them."""
    rows = tuple(_mode_row(mode) for mode in result.rows if mode.eigenvalue.imag >= 0)
    head = (
        "eigenvalue [1/s]",
        "frequency [Hz]",
        "damping ratio",
        "stable?",
        "time constant",
        "dominated by",
        "fed and drained by [1/s]",
    )
    return Section(
        "Eigenvalues",
        (
            Table(head, rows, "rrrlrll"),
            Text(
                "A row for each mode: a pattern of motion with a growth rate (real part of the "
                "eigenvalue; negative decays) and a frequency (imaginary part). Damping ratio: 0 "
                "rings for ever, 1 no longer swings, negative grows. Time constant: in which "
                "the amplitude changes by a factor of 2.7. Dominated by: "
                "participation factors, summed over the states of each element. Fed and drained: "
                "what each dissipator or source adds to the growth rate.",
                "note",
            ),
            *_movers(result),
            *_matrix(result),
        ),
    )


def _movers(result: StabilityResult) -> list[object]:
    """Say of every mode which parameters move its growth and its frequency most."""
    rows = []
    for index, mode in enumerate(result.rows):
        if mode.eigenvalue.imag < 0:
            continue
        growth = result.sensitivities.ranked(index, derived=False, by="growth")[:MOVERS]
        pitch = result.sensitivities.ranked(index, derived=False, by="frequency")[:MOVERS]
        waves = pitch if mode.eigenvalue.imag else ()
        name = f"{number(mode.frequency_hz, 5)} Hz" if mode.eigenvalue.imag else "real"
        rows.append(
            (
                f"{name}, {number(mode.eigenvalue.real, 4)} 1/s",
                ", ".join(f"{e.parameter} {signed(e.growth(CHANGE))}" for e in growth),
                ", ".join(f"{e.parameter} {signed(e.frequency(CHANGE))}" for e in waves),
            )
        )
    if not any(growth or pitch for _, growth, pitch in rows):
        return []
    share = f"{100 * CHANGE:.0f} %"
    head = ("mode", f"growth rate for +{share} [1/s]", f"frequency for +{share} [Hz]")
    words = (
        f"What moves each mode: the {MOVERS} parameters that change its growth rate and its "
        f"frequency most when raised by {share}, to first order. All of them, those that derive from "
        "others too, stand in stability.json."
    )
    return [Text(words), Table(head, tuple(rows), "lll")]


def signed(value: float) -> str:
    """Write a change with its sign.

    Examples
    --------
    >>> signed(0.25), signed(-12.0)
    ('+0.25', '-12')
    """
    return f"{'+' if value > 0 else ''}{number(value, 3)}"


def _matrix(result: StabilityResult) -> list[object]:
    """Show the state matrix, where a page can hold it."""
    states = result.system.states
    if not states:
        return []
    if len(states) > READABLE:
        return [Text(f"The state matrix, {len(states)} x {len(states)}, stands in stability.json.")]
    rows = tuple(
        (name, *(number(value) for value in row))
        for name, row in zip(states, result.system.A, strict=True)
    )
    return [
        Text("State matrix: the rate of each row's state for a change of each column's state."),
        Table(("A [SI]", *states), rows, "c" + "r" * len(states), labelled=True),
    ]


def _mode_row(mode: Mode) -> tuple[str, ...]:
    value = mode.eigenvalue
    pair = f" ± {number(abs(value.imag), 7)}j" if value.imag else ""
    ratio = mode.damping_ratio
    return (
        f"{number(value.real, 7)}{pair}",
        number(mode.frequency_hz),
        "" if ratio is None else number(ratio, 4),
        {1: "unstable", -1: "stable", 0: "neither"}[mode.growth],
        duration(mode.time_constant) if mode.growth else "",
        _shares(mode),
        _feeds(mode),
    )


def _shares(mode: Mode) -> str:
    told = [f"{name} {mode.carriers[name]:.0%}" for name in mode.elements[:CARRIERS]]
    more = len(mode.elements) - CARRIERS
    return ", ".join([*told, *([f"{more} more"] if more > 0 else [])])


def _feeds(mode: Mode) -> str:
    largest = max(map(abs, mode.telling.values()), default=0.0)
    told = sorted(mode.telling.items(), key=lambda item: -abs(item[1]))
    shown = [f"{name} {rate:+.4g}" for name, rate in told if abs(rate) > 1e-3 * largest]
    return ", ".join(shown[: 2 * CARRIERS])


def locus_section(loci: Sequence[Locus]) -> Section | None:
    """Show the eigenvalues along each varied parameter, with their edges."""
    if not loci:
        return None
    blocks: list[object] = []
    for locus in loci:
        blocks += [Text(along(locus)), _locus_figure(locus)]
        if locus.crossings:
            blocks += [_crossings(locus), Text(_CROSSING, "note")]
        else:
            blocks.append(Text(f"No mode changes its stability along {locus.name}."))
    return Section("How far the edge is", tuple(blocks))


_CROSSING = (
    "Each row is a value at which a mode stops decaying. Hopf: it begins to swing. Fold: it drifts "
    "away without swinging, or the steady state ends there. Soft: behind the edge the vibration "
    "starts small and grows with the distance. Hard: it jumps to a large one at once, and a push "
    "can set it off before the edge is reached."
)


def _locus_figure(locus: Locus) -> Figure:
    numbers = _locus_numbers(locus)
    where = f"from {_shown(locus.values[0], locus)} to {_shown(locus.values[-1], locus)}"
    return Figure(
        f"Eigenvalues along {locus.name}.",
        (
            Panel(
                f"locus-{slug(locus.name)}",
                root_locus(locus),
                f"Root locus over {locus.name} {where}",
                numbers,
            ),
            Panel(
                f"growth-{slug(locus.name)}",
                growth_rates(locus),
                f"Growth rate of each mode over {locus.name} {where}",
                numbers,
            ),
        ),
        f"{len(locus.values)} points {where}. Left of zero a mode decays, in the shaded part it "
        f"grows. Crosses: operating point, {locus.name} = {_shown(locus.at, locus)}. Full "
        f"diamonds: edge of stability; hollow: a further mode changes while another one grows "
        f"already. Curves may run on beyond the frame.",
    )


def _locus_numbers(locus: Locus) -> dict[str, numpy.ndarray]:
    columns = {f"{locus.name} [{coherent(locus.unit)}]": locus.values}
    for index, column in enumerate(locus.eigenvalues.T, start=1):
        columns[f"growth rate {index} [1/s]"] = column.real
        columns[f"frequency {index} [Hz]"] = column.imag / (2 * numpy.pi)
    return columns


def _crossings(locus: Locus) -> Table:
    rows = tuple(_crossing(edge, locus) for edge in locus.crossings)
    head = (
        locus.name,
        "unit",
        "kind",
        "frequency [Hz]",
        "grows",
        "onset",
        "meaning",
        "dominated by",
    )
    return Table(head, rows, "rllrllll")


def _crossing(edge: Edge, locus: Locus) -> tuple[str, ...]:
    side = {True: "above", False: "below", None: "the branch ends"}[edge.unstable_above]
    return (
        number(from_si(edge.value, locus.unit), 8),
        pretty(locus.unit or "1"),
        "Hopf" if edge.kind == "hopf" else "fold",
        number(edge.frequency_hz, 8),
        side,
        "" if edge.onset is None else ONSETS.get(edge.onset.kind, edge.onset.kind),
        "edge of stability" if edge.boundary else "a further mode",
        _shares(edge.mode),
    )


def _shown(value: float, locus: Locus) -> str:
    return f"{number(from_si(float(value), locus.unit))}{' ' + pretty(locus.unit) if locus.unit else ''}"


def friction_section(result: StabilityResult) -> Section | None:
    """Show the law of each contact at the operating point."""
    names = [name for name, item in result.graph.of(Friction) if item.smoothing is None]
    if not names:
        return None
    figures = tuple(
        Figure(
            f"{name}.",
            (
                Panel(
                    f"friction-{slug(name)}",
                    friction_curve(result.graph, name, result.point),
                    f"Friction of {name} over its slip",
                ),
            ),
            "Friction over slip with the parameters of this report. At zero slip it takes any "
            "value between the two limits.",
        )
        for name in names
    )
    return Section("Friction", figures)
