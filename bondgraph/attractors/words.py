"""Two or three plain sentences about what a model may end in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..units import from_si
from .value import Attractor, Attractors, BasinEdge

if TYPE_CHECKING:
    from .reached import Change, ReachPoint


def in_words(result: Attractors) -> str:
    """Say what lives beside what, and where the model's own start leads.

    Parameters
    ----------
    result : Attractors

    Returns
    -------
    str
    """
    return " ".join(filter(None, (_living(result), _own(result), _edge(result), _open(result))))


def listed(names: list[str]) -> str:
    """Join names as a sentence does.

    Examples
    --------
    >>> listed(["a", "b", "c"])
    'a, b and c'
    """
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def cycles_words(items: Sequence[Attractor]) -> str:
    """Name cycles in a sentence.

    Examples
    --------
    >>> cycles_words([])
    ''
    """
    said = []
    for kind, some in (
        ("stick-slip cycle", [item for item in items if item.sticks]),
        ("cycle", [item for item in items if not item.sticks]),
    ):
        rates = listed([f"{item.frequency_hz:.4g}" for item in some])
        if some:
            said.append(f"a {kind} of {rates} Hz" if len(some) == 1 else f"{kind}s of {rates} Hz")
    return listed(said)


def _living(result: Attractors) -> str:
    steady, cycles = _steady_words(result), cycles_words(result.cycles)
    one = len(result.cycles) == 1
    grows = any(item.kind == "unbounded" for item in result.found)
    if result.beside:
        return f"{steady} is stable for small motions, yet {cycles} live{'s' if one else ''} beside it."
    if cycles and result.point is not None:
        state = (
            "is not stable"
            if any(p.real > 0 for p in result.point.eigenvalues)
            else "does not last"
        )
        return f"{steady} {state}; {cycles} {'was' if one else 'were'} found."
    if cycles:
        return f"{cycles[0].upper()}{cycles[1:]} {'was' if one else 'were'} found, and no steady state."
    if grows:
        beside = (
            f"{steady} is stable for small motions, but runs grow" if result.steady else "Runs grow"
        )
        return f"{beside} without bound from some starts."
    if len(result.steady) > 1:
        return f"There are {len(result.steady)} stable steady states, and no cycle was found."
    if any(not item.isolated for item in result.found if item.kind == "cycle"):
        return f"{steady} neither attracts nor repels: cycles of any size lie about it."
    if result.steady:
        return f"{steady} is stable, and every start that settled ends in it: no cycle was found."
    if any(item.kind == "steady" for item in result.found):
        return "Runs come to rest, but whether small motions about it decay is not known."
    return "Neither a stable steady state nor a cycle was found."


def _steady_words(result: Attractors) -> str:
    """Name the steady state by what its contacts do."""
    modes = result.point.modes if result.point is not None else {}
    sliding = [name for name, mode in modes.items() if mode.startswith("slip")]
    stuck = [name for name, mode in modes.items() if mode == "stick"]
    if sliding and not stuck:
        return "Steady sliding"
    if stuck and not sliding:
        return "The steady state, stuck,"
    return "The steady state"


def _own(result: Attractors) -> str:
    item = result.own
    if item is None or len(result.found) < 2:
        return ""
    ends = {
        "cycle": "in the cycle" if len(result.cycles) == 1 else "",
        "steady": "in the steady state" if len(result.steady) == 1 else "in one of them",
        "unbounded": "beyond all bounds",
    }.get(item.kind)
    if ends is None:
        return ""
    if item.kind == "cycle" and not ends:
        ends = f"in that of {item.frequency_hz:.4g} Hz"
    return f"The model's own start ends {ends}."


def _edge(result: Attractors) -> str:
    edge = result.edge
    if edge is None or edge.leaves == float("inf"):
        return ""
    size = _size(edge, result)
    item = None if edge.to is None else result.found[edge.to]
    where = "leads elsewhere"
    if item is not None and item.kind == "unbounded":
        where = "grows without bound"
    elif item is not None and item.kind == "cycle":
        where = "leads to the cycle"
        where += f" of {item.frequency_hz:.4g} Hz" if len(result.cycles) > 1 else ""
    return f"Pushed along {edge.along} it returns after up to {size}; a larger push {where}."


def _size(edge: BasinEdge, result: Attractors) -> str:
    """Say a push by the output that it moves most beside its swing in the cycle."""
    best, most = None, 0.0
    cycle = next(iter(result.cycles), None)
    for name, change in edge.outputs.items():
        swing = cycle.amplitudes[name].peak_to_peak if cycle and name in cycle.amplitudes else 0.0
        share = abs(change) / swing if swing > 0 else 0.0
        if share > most:
            best, most = name, share
    energy = "" if edge.energy is None else f"{edge.energy:.3g} J"
    if best is None:
        return energy or f"{edge.returns:.3g} of its eigenvector"
    unit = next((item.units.get(best, "") for item in result.cycles), "")
    moved = f"a change of {best} by {abs(edge.outputs[best]):.3g}{' ' + unit if unit else ''}"
    return f"{moved} ({energy})" if energy else moved


def _open(result: Attractors) -> str:
    left = [name for item in result.found if item.kind == "unsettled" for name in item.starts]
    if not left:
        return ""
    runs = f"{len(left)} of {len(result.ends)} runs"
    return f"{runs} had not settled when {'it' if len(left) == 1 else 'they'} ended."


def reach_words(
    name: str, unit: str, points: Sequence[ReachPoint], changes: Sequence[Change]
) -> str:
    """Say what a model's own start ends in along a parameter.

    Examples
    --------
    >>> reach_words("tau", "s", [], [])
    ''
    """
    if not points:
        return ""
    parts: list[tuple[float | None, float | None, ReachPoint]] = []
    low: float | None = None
    for change in changes:
        parts.append((low, change.value, change.before))
        low = change.value
    parts.append((low, None, points[-1]))
    said = []
    for low, high, point in parts:
        where = f" from {_valued(low, unit)}" if low is not None else ""
        where += f" up to {_valued(high, unit)}" if high is not None else ""
        where = where if high is not None or low is None else f" above {_valued(low, unit)}"
        said.append(f"{_ending(point)}{where}")
    if len(said) == 1:
        return f"At every {name} looked at the own start ends {said[0]}."
    return f"With {name} the own start ends {'; '.join(said)}."


def _valued(value: float | None, unit: str) -> str:
    assert value is not None
    return f"{from_si(value, unit):.4g}{' ' + unit if unit else ''}"


def _ending(point: ReachPoint) -> str:
    if point.outcome == "cycle":
        kind = "a stick-slip cycle" if any(0 < s < 1 for s in point.held.values()) else "a cycle"
        return f"in {kind} ({point.frequency_hz:.4g} Hz there)"
    return {
        "steady": "in the steady state",
        "unbounded": "beyond all bounds",
        "unsettled": "unsettled",
        "stopped": "early, stopped by the solver",
        "refused": "nowhere, as the run cannot begin",
    }[point.outcome]
