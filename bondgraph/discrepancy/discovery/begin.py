"""Where recordings begin: start states that are sought, and those that follow from others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...graph import BondGraph
from ...simulation import CompiledModel
from ..grafting import Grafted, graft
from ..measurement import Measurement
from .bench import Added, Bench


def grown(graph: BondGraph, added: Sequence[Added]) -> tuple[BondGraph, tuple[Grafted, ...]]:
    """Grow effects into a graph one after the other."""
    grafts = []
    for item in added:
        found = graft(graph, item.effect, item.site, parameters=dict(item.starts))
        grafts.append(found)
        graph = found.graph
    return graph, tuple(grafts)


def ties_of(
    grafts: Sequence[Grafted], model: CompiledModel, parameters: Mapping[str, float]
) -> dict[str, dict[str, float]]:
    """Return how starts of new elements follow those of the states that were there before them."""
    found: dict[str, dict[str, float]] = {}
    states = [state.name for state in model.equations.states]
    new = {state for item in grafts for state in item.starts}
    for item in grafts:
        known = {key: value for key, value in parameters.items() if key in _names(item.graph)}
        found |= item.ties([name for name in states if name not in new], known)
    return found


def begun_at(
    initial: Mapping[str, float],
    found: Mapping[str, float],
    ties: Mapping[str, Mapping[str, float]],
) -> dict[str, float]:
    """Return where a recording begins, with what a fit found and what follows from it."""
    known = {**initial, **found}
    following = {
        name: sum(factor * known.get(other, 0.0) for other, factor in shares.items())
        for name, shares in ties.items()
    }
    return known | following


def fitted_by(grafts: Sequence[Grafted]) -> list[str]:
    """Return the parameters of effects that data tell."""
    return [
        name
        for item in grafts
        for key, name in item.parameters.items()
        if key in item.effect.fitted
    ]


def open_states(
    bench: Bench, model: CompiledModel, ties: Mapping[str, Mapping[str, float]]
) -> list[str]:
    """Return the states whose start is sought: those not known, and new ones that follow none."""
    before = {state.name for state in bench.model.equations.states}
    names = [state.name for state in model.equations.states]
    return [
        name for name in names if name in bench.states or (name not in before and name not in ties)
    ]


def _names(graph: BondGraph) -> set[str]:
    return {symbol.name for symbol in graph.parameters}


def states_of(model: CompiledModel) -> set[str]:
    """Return the names of a model's states."""
    return {state.name for state in model.equations.states}


def started(
    row: Measurement,
    start: Mapping[str, float],
    grafts: Sequence[Grafted],
    sought: Sequence[str],
) -> Measurement:
    """Return a recording that begins where the smoother says, new springs beside old ones."""
    known = {**row.initial, **{name: start[name] for name in sought if name in start}}
    for item in grafts:
        known = item.initial(known)
    return row.changed(initial=known)
