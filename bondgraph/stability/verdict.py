"""The verdict: what the numbers mean, in two or three sentences."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ..linear import LinearSystem, Mode
from ..units import from_si
from .edges import Edge
from .locus import Locus
from .margins import Margin

# Contributions below this share of the largest are left out of the sentence.
WORTH_SAYING = 0.02
# Above this ratio a distance is told as a factor.
FAR = 3.0


def verdict(
    system: LinearSystem, modes: Sequence[Mode], margins: Sequence[Margin] | None = None
) -> str:
    """Say in two sentences whether a steady state is stable and how far the edge is.

    Parameters
    ----------
    system : LinearSystem
    modes : sequence of Mode
        From `bondgraph.linear.modal_table`.
    margins : sequence of Margin, optional
        Nearest first. Where they were not asked for, the second sentence says what feeds and
        drains the mode instead.

    Returns
    -------
    str
        A sentence a line.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble, linearize
    >>> from bondgraph.stability import modal_table
    >>> v = One("v")
    >>> graph = assemble("cart", Se("F", 1) >> v >> (I("m", 2), R("b", 4)))
    >>> system = linearize(graph)
    >>> print(verdict(system, modal_table(system)))
    cart is stable at this operating point: its slowest mode, carried by m, dies away by a factor e in 500 ms.
    b takes 2 1/s out of it.
    """
    if not modes:
        return f"{system.at.equations.name} has no states: there is nothing to be unstable."
    mode = critical(modes)
    second = balance(mode) if margins is None else [_edge_of(margins, is_stable(modes))]
    return "\n".join([_state(system, modes, mode), *second])


def reasons(modes: Sequence[Mode], slopes: Mapping[str, float]) -> tuple[str, ...]:
    """Say what decides: who carries, feeds and drains the critical mode, and which law falls.

    Parameters
    ----------
    modes : sequence of Mode
    slopes : mapping of str to float
        From `incremental_resistances`.

    Returns
    -------
    tuple of str
        Sentences.

    Examples
    --------
    >>> mode = Mode(complex(1, 50), 1, {"m": 0.5, "k": 0.5}, {"m": 0.5, "k": 0.5}, {"belt": 1.0})
    >>> for sentence in reasons([mode], {"belt": -2.0}):
    ...     print(sentence)
    The critical mode is carried by m (50 %) and k (50 %).
    belt feeds it with 1 1/s.
    The law of belt falls: for small motions it is a damper of -2 (SI), which feeds them.
    """
    if not modes:
        return ()
    mode = critical(modes)
    said = []
    if mode.elements:
        told = [f"{name} ({mode.carriers[name]:.0%})".replace("%", " %") for name in mode.elements]
        said.append(f"The critical mode is carried by {listed(told)}.")
    said += balance(mode)
    largest = max(map(abs, mode.telling.values()), default=0.0)
    said += [
        f"The law of {name} falls: for small motions it is a damper of {value:.4g} (SI), which "
        f"feeds them."
        for name, value in slopes.items()
        if value < 0 and mode.telling.get(name, 0.0) > WORTH_SAYING * largest
    ]
    return tuple(said)


def critical(modes: Sequence[Mode]) -> Mode:
    """Return the mode that decides.

    The fastest growing one; where none grows, one that does neither; else the
    oscillation with the least damping ratio; else the slowest decay.

    Examples
    --------
    >>> critical([Mode(complex(-1, 0), -1), Mode(complex(-2, 50), -1)]).eigenvalue
    (-2+50j)
    """
    worst = max(mode.growth for mode in modes)
    if worst >= 0:
        candidates = [mode for mode in modes if mode.growth == worst]
        return max(candidates, key=lambda mode: (mode.eigenvalue.real, mode.eigenvalue.imag))
    waves = [mode for mode in modes if mode.eigenvalue.imag > 0]
    if waves:
        return min(waves, key=lambda mode: -mode.eigenvalue.real / abs(mode.eigenvalue))
    return max(modes, key=lambda mode: mode.eigenvalue.real)


def is_stable(modes: Iterable[Mode]) -> bool:
    """Whether every mode decays."""
    return all(mode.stable for mode in modes)


def listed(names: Sequence[str], most: int = 3) -> str:
    """Join names as a sentence does, the last of many as a number.

    Examples
    --------
    >>> listed(["a", "b", "c"])
    'a, b and c'
    >>> listed(["a", "b", "c", "d", "e"])
    'a, b, c and 2 more'
    """
    shown = [*names[:most], f"{len(names) - most} more"] if len(names) > most + 1 else [*names]
    return " and ".join(filter(None, [", ".join(shown[:-1]), *shown[-1:]]))


def duration(seconds: float) -> str:
    """Write a time with a unit that suits it.

    Examples
    --------
    >>> duration(0.0206), duration(300.0)
    ('20.6 ms', '300 s')
    """
    scales = ((1.0, "s"), (1e3, "ms"), (1e6, "µs"))
    factor, unit = next((item for item in scales if seconds * item[0] >= 1), (1e9, "ns"))
    return f"{seconds * factor:.3g} {unit}"


def _state(system: LinearSystem, modes: Sequence[Mode], mode: Mode) -> str:
    name, held = system.at.equations.name, _modes_in_words(system.at.modes)
    carriers = listed(mode.elements)
    carried = f", carried by {carriers}," if carriers else ""
    kind = f"{mode.frequency_hz:.4g} Hz mode" if mode.eigenvalue.imag else "real mode"
    if mode.growth > 0:
        count = sum(item.growth > 0 and item.eigenvalue.imag >= 0 for item in modes)
        others = f"; {count - 1} more of its modes grow" if count > 1 else ""
        return (
            f"{name} is unstable at this operating point{held}: its {kind}{carried} grows by a "
            f"factor e every {duration(mode.time_constant)}{others}."
        )
    if mode.growth == 0:
        return (
            f"{name} is neither stable nor unstable at this operating point{held}: its {kind}"
            f"{carried} neither grows nor decays."
        )
    if mode.eigenvalue.imag:
        return (
            f"{name} is stable at this operating point{held}: its least damped mode, "
            f"{mode.frequency_hz:.4g} Hz{carried} dies away by a factor e in "
            f"{duration(mode.time_constant)} (damping ratio {mode.damping_ratio:.3g})."
        )
    return (
        f"{name} is stable at this operating point{held}: its slowest mode{carried} dies away by "
        f"a factor e in {duration(mode.time_constant)}."
    )


def _modes_in_words(modes: Mapping[str, str]) -> str:
    words = {"stick": "stuck", "slip+": "slipping", "slip-": "slipping backwards"}
    said = [f"{name} {words.get(mode, mode)}" for name, mode in modes.items()]
    return f" ({listed(said)})" if said else ""


def balance(mode: Mode) -> list[str]:
    """Say which elements feed the mode and which drain it; of a neutral mode there is nothing."""
    if mode.growth == 0:
        return []
    largest = max(map(abs, mode.telling.values()), default=0.0)
    told = {name: rate for name, rate in mode.telling.items() if abs(rate) > WORTH_SAYING * largest}
    feeding = [f"{name} feeds it with {rate:.3g} 1/s" for name, rate in told.items() if rate > 0]
    draining = [f"{name} takes {-rate:.3g} 1/s" for name, rate in told.items() if rate < 0]
    draining.reverse()
    parts = []
    if feeding:
        parts.append(listed(feeding))
    if draining:
        parts.append(f"{listed(draining)} out of it")
    if not parts:
        return []
    text = ", ".join(parts)
    return [f"{text}."]


def _edge_of(margins: Sequence[Margin], stable: bool) -> str:
    """Say which parameter is nearest to its edge."""
    nearest = next((item for item in margins if item.nearest is not None), None)
    if nearest is None:
        return (
            "Of the parameters followed none, taken alone, makes it "
            + ("unstable" if stable else "stable")
            + " within the factors searched."
        )
    edge = nearest.nearest
    assert edge is not None
    until = "for it to become unstable" if stable else "for it to become stable"
    if edge.kind == "fold" and edge.unstable_above is None:
        until = "for this steady state to vanish"
    return f"The nearest edge: {way(nearest, edge)} {until} ({crossing(edge)})."


def way(margin: Margin, edge: Edge) -> str:
    """Say how far a parameter has to go to an edge.

    Examples
    --------
    >>> import types
    >>> edge = types.SimpleNamespace(value=1.2, unit="m/s")
    >>> way(types.SimpleNamespace(parameter="V0", value=1.0, unit="m/s"), edge)
    'V0 has to rise by 20.0 % to 1.2 m/s'
    """
    unit = f" {margin.unit}" if margin.unit else ""
    value = from_si(edge.value, margin.unit)
    ratio = edge.value / margin.value
    sense = "rise" if abs(edge.value) > abs(margin.value) else "fall"
    if ratio > FAR:
        return f"{margin.parameter} has to rise to {ratio:.3g} times its value, {value:.6g}{unit}"
    return f"{margin.parameter} has to {sense} by {100 * abs(ratio - 1):.1f} % to {value:.6g}{unit}"


def crossing(edge: Edge) -> str:
    """Say what happens at an edge."""
    if edge.kind == "fold":
        return "fold: a real mode" + (", the branch turns" if edge.unstable_above is None else "")
    onset = {
        "soft": ", soft: the vibration grows from nothing",
        "hard": ", hard: the vibration is large at once",
        "degenerate": ", neither soft nor hard in these equations",
    }
    return f"Hopf, {edge.frequency_hz:.5g} Hz{onset.get(edge.onset.kind, '') if edge.onset else ''}"


def along(locus: Locus) -> str:
    """Say how far the nearest edge along one varied parameter is.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> from bondgraph.stability import assess
    >>> along(assess(bicycle_brake.graph(), vary=["V0=0.5:1.2:50"]).loci[0])
    'Along V0 there is no edge from 0.5 to 1.2 m/s.'
    """
    unit = f" {locus.unit}" if locus.unit else ""
    low, high = (from_si(value, locus.unit) for value in (locus.values[0], locus.values[-1]))
    here = from_si(locus.at, locus.unit)
    edge = locus.nearest
    if edge is None:
        return f"Along {locus.name} there is no edge from {low:.4g} to {high:.4g}{unit}{_holes(locus)}."
    value = from_si(edge.value, locus.unit)
    return (
        f"Along {locus.name} the nearest edge is at {value:.6g}{unit}, {_distance(value, here)} "
        f"({crossing(edge)}{_side(edge)}){_holes(locus)}."
    )


def _distance(value: float, here: float) -> str:
    side = "above" if value > here else "below"
    if not here:
        return f"{abs(value - here):.3g} {side} the operating point"
    if value / here > FAR:
        return f"{value / here:.3g} times the operating point's {here:.4g}"
    return f"{100 * abs(value - here) / abs(here):.1f} % {side} the operating point's {here:.4g}"


def _side(edge: Edge) -> str:
    if edge.unstable_above is None:
        return "; no steady state beyond"
    return "; unstable above" if edge.unstable_above else "; unstable below"


def _holes(locus: Locus) -> str:
    if not locus.gaps:
        return ""
    return (
        f"; {len(locus.gaps)} of its {len(locus.values)} points have no steady state in this mode"
    )
