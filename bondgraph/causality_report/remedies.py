"""How a model could do without a loop: each way that is named has been tried."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

from ..blocks import AlgebraicLoop
from ..causality import Stroke
from ..elements import C, Element, I, Junction, R, Storage, Zero
from ..equations import Equations, derive
from ..errors import BondGraphError
from ..graph import BondGraph, GraphBond

# No storage is tried in a larger graph, and no more than so many in any.
MOST_BONDS = 60
MOST_TRIALS = 8


def remedy(equations: Equations, strokes: Mapping[str, list[Stroke]], loop: AlgebraicLoop) -> str:
    """Say how a model could do without a loop.

    Parameters
    ----------
    equations : Equations
    strokes : mapping of str to list of Stroke
        Of each element's bonds.
    loop : AlgebraicLoop

    Returns
    -------
    str
        A law to be given the other way round, or a storage at a junction of the
        loop that opens it: each was added to the graph and the equations derived.
    """
    graph = equations.graph
    if loop.kind != "algebraic loop":
        stores = [name for name, _ in graph.of(Storage) if _answers(equations, name, loop)]
        named = " and ".join(stores) or "its storages"
        return f"join {named} into one storage, or put a compliance or resistance between them"
    ways = list(_laws(equations, strokes, loop))
    junctions = [
        (name, item)
        for name, item in graph.of(Junction)
        if _has(equations, f"{name}.{item.shared[0]}", loop)
    ]
    if len(graph.bonds) > MOST_BONDS:
        places = ", ".join(repr(name) for name, _ in junctions[:MOST_TRIALS])
        ways.append(f"add a storage at one of its junctions {places}" if places else "")
    else:
        ways += [
            f"add {'a C' if isinstance(item, Zero) else 'an I'} at {item.kind}-junction {name!r}"
            for name, item in junctions[:MOST_TRIALS]
            if _opens(graph, loop, name, item)
        ]
    return ", or ".join(way for way in ways if way) or "add compliances or inertias in it"


def _has(equations: Equations, port: str, loop: AlgebraicLoop) -> bool:
    """Whether a port's variable is one of a loop's."""
    return str(equations.ports[port]) in loop.variables


def _answers(equations: Equations, name: str, loop: AlgebraicLoop) -> bool:
    """Whether what a storage's bond brings it, or takes, is in a loop."""
    return any(_has(equations, f"{name}.{port}", loop) for port in "ef")


def _laws(
    equations: Equations, strokes: Mapping[str, list[Stroke]], loop: AlgebraicLoop
) -> Iterator[str]:
    """Name the resistors whose law gives the variable that causality does not ask for."""
    for name, element in equations.graph.of(R):
        asked = "effort" if strokes[name][0].effort_out_of == name else "flow"
        if getattr(element, asked) is None and _has(equations, f"{name}.{asked[0]}", loop):
            yield f"give R {name!r} its law as {asked}="


def _opens(graph: BondGraph, loop: AlgebraicLoop, junction: str, element: Element) -> bool:
    """Whether a storage at a junction leaves no loop through what was in this one."""
    name = "store"
    while name in graph.elements:
        name += "_"
    store = C(name, 1) if isinstance(element, Zero) else I(name, 1)
    wider = replace(
        graph,
        elements=MappingProxyType({**graph.elements, name: store}),
        bonds=(*graph.bonds, GraphBond(f"{junction}>{name}", junction, name)),
    )
    try:
        equations = derive(wider)
    except BondGraphError:
        return False
    inside = set(loop.variables)
    independent = name in equations.causal.integral
    return independent and all(inside.isdisjoint(other.variables) for other in equations.loops)
