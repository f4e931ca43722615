"""Where recordings begin: start states that are sought, and those that follow from others."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from ...graph import BondGraph
from ...simulation import CompiledModel
from ..grafting import Grafted, graft
from ..measurement import Measurement
from .bench import Added, Bench, Draft
from .prepare import Prepared


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
    bench: Bench,
    model: CompiledModel,
    ties: Mapping[str, Mapping[str, float]],
    held: Collection[str] = (),
) -> list[str]:
    """Return the states whose start is sought: those not known, and new ones that follow none."""
    before = {state.name for state in bench.model.equations.states}
    names = [state.name for state in model.equations.states if state.name not in held]
    return [
        name for name in names if name in bench.states or (name not in before and name not in ties)
    ]


def phases(bench: Bench, draft: Draft) -> frozenset[str]:
    """Return displacements whose start may be anything, as coefficients are fitted to it.

    Only where there is one recording: others begin elsewhere.
    """
    if len(bench.recordings) > 1:
        return frozenset()
    names = [
        grafted.name
        for item, grafted in zip(draft.added, draft.grafts, strict=True)
        if item.effect.periodic
    ]
    states = (state.name for state in draft.model.equations.states)
    return frozenset(name for name in states if name.rpartition(".")[0] in names)


def anchored(
    recording: Prepared, model: CompiledModel, parameters: Mapping[str, float]
) -> Prepared:
    """Return a recording that begins, in states that nothing depends on, where the model says.

    An angle that is neither measured nor felt may begin anywhere, as far as the model by itself
    goes; what is periodic in it then has the phase that the model's own angle gives it.
    """
    names = [state.name for state in model.equations.states]
    loose = set(recording.item.free) - _felt(model)
    if not loose:
        return recording
    begins = dict(zip(names, model.initial_state(dict(parameters), {}), strict=True))
    initial = {**recording.item.initial, **{name: float(begins[name]) for name in loose}}
    free = tuple(name for name in recording.item.free if name not in loose)
    return replace(
        recording,
        item=replace(recording.item, initial=initial, free=free),
        plain=recording.plain.changed(initial=initial),
    )


def _felt(model: CompiledModel) -> set[str]:
    """Return the names of all that rates or outputs of a model depend on."""
    equations = model.equations
    parts = [*equations.derivatives, *equations.outputs.values(), *equations.residuals]
    parts += [part for contact in equations.contacts for part in (contact.slip, contact.breakaway)]
    parts += [expression for _, expression in equations.assignments]
    return {symbol.name for part in parts for symbol in part.free_symbols}


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
