"""What a site tells an effect: its node, flow, displacement, and how things start there."""

from __future__ import annotations

import sympy

from ...elements import C, I, Integrator, Junction, One, Se, Sf, SignalBlock, Storage, Zero
from ...graph import BondGraph, GraphBond
from ..candidates.place import Place
from ..candidates.places import BOND, EFFORT_PAIR, FLOW_JUNCTION, FLOW_PAIR, OUTPUT
from .places import Site


def place_of(graph: BondGraph, site: Site, name: str) -> Place:
    """Return a site as an effect sees it; pairs and bonds get a junction of their own.

    Parameters
    ----------
    graph : BondGraph
    site : Site
    name : str
        Of the effect's element, without its submodel.

    Returns
    -------
    Place
    """
    start = starts(graph)
    if site.kind == OUTPUT:
        return Place(name, signal=graph.outputs[site.at[0]].expression, start=start)
    if site.kind == BOND:
        return Place(name, Zero(f"{name}_split"), start=start)
    ends = [graph.elements[label] for label in site.at]
    if site.kind in (FLOW_PAIR, EFFORT_PAIR):
        pseudo = any(end.pseudo for end in ends if isinstance(end, Junction))
        if site.kind == EFFORT_PAIR:
            return Place(name, One(f"{name}_between", pseudo=pseudo), start=start)
        first, second = ends
        assert isinstance(first, One) and isinstance(second, One)
        return Place(
            name,
            Zero(f"{name}_between", pseudo=pseudo),
            first.f - second.f,
            displacement=relative(graph, *site.at),
            start=start,
        )
    element = ends[0]
    if isinstance(element, Junction):
        flow = element.f if isinstance(element, One) else None
        way = displacement(graph, site.at[0]) if site.kind == FLOW_JUNCTION else None
        return Place(name, element, flow, displacement=way, start=start)
    signal = None
    if isinstance(element, Se | Sf):
        signal = element.effort if isinstance(element, Se) else element.flow
    return Place(name, element=element, signal=signal, start=start)


def displacement(graph: BondGraph, junction: str) -> sympy.Expr | None:
    """Return the integral of a 1-junction's flow, where a state of the graph is just that."""
    flow = graph.elements[junction].symbols["f"]
    for bond in graph.bonds_of(junction):
        other = graph.elements[bond.head if bond.tail == junction else bond.tail]
        if isinstance(other, C) and not other.partners:
            return other.q
    for _, block in graph.of(Integrator):
        if block.rate == flow:
            return block.y
    return None


def relative(graph: BondGraph, first: str, second: str) -> sympy.Expr | None:
    """Return the integral of the difference of two flows, where states tell it."""
    for label, _ in graph.of(Zero):
        bonds = graph.bonds_of(label)
        sign = {bond.tail: 1 for bond in bonds if bond.head == label}
        sign |= {bond.head: -1 for bond in bonds if bond.tail == label}
        between = [end for end in sign if end not in (first, second)]
        if {first, second} <= sign.keys() and len(between) == 1 and sign[first] != sign[second]:
            way = _elongation(graph, between[0])
            if way is not None:
                return sign[first] * sign[between[0]] * -way
    ways = displacement(graph, first), displacement(graph, second)
    if ways[0] is None or ways[1] is None:
        return None
    return ways[0] - ways[1]


def _elongation(graph: BondGraph, label: str) -> sympy.Expr | None:
    """Return the integral of the flow that a branch takes: a spring, or a 1-junction that has one.

    Taken along the branch's bond, so that its sign is told by that bond.
    """
    element = graph.elements[label]
    if isinstance(element, C) and not element.partners:
        return element.q
    return displacement(graph, label) if isinstance(element, One) else None


def starts(graph: BondGraph) -> dict[sympy.Basic, sympy.Expr]:
    """Return what states begin with, and efforts and flows in states, as far as storage tells.

    Inputs are told apart from parameters: what they begin with is not known.
    """
    found: dict[sympy.Basic, sympy.Expr] = {}
    for label, element in graph.elements.items():
        if isinstance(element, SignalBlock):
            found[element.y] = element.initial
        if isinstance(element, Storage) and not element.partners:
            found[element.state] = element.initial
            found[element.coenergy] = element.law
            shared = One if isinstance(element, I) else Zero
            for bond in graph.bonds_of(label):
                end = graph.elements[bond.tail]
                if isinstance(end, shared):
                    found[end.symbols["f" if shared is One else "e"]] = element.law
    found |= {flow: value for flow, value in _driven(graph).items() if flow not in found}
    return found | {symbol: sympy.Dummy(symbol.name) for symbol in graph.inputs}


def _driven(graph: BondGraph) -> dict[sympy.Basic, sympy.Expr]:
    """Return flows of 1-junctions that a flow source moves, as if compliances between were rigid.

    So something that was rigid, and yields, begins as it did: unloaded, both ends at one flow.
    """
    found: dict[sympy.Basic, sympy.Expr] = {}
    for label, source in graph.of(Sf):
        edge = [(bond, label, source.flow) for bond in graph.bonds_of(label)]
        seen = {label}
        while edge:
            bond, last, flow = edge.pop()
            other = bond.head if bond.tail == last else bond.tail
            end = graph.elements[other]
            if other in seen or not isinstance(end, One | Zero):
                continue
            seen.add(other)
            bonds = [each for each in graph.bonds_of(other) if each is not bond]
            if isinstance(end, One):
                found.setdefault(end.f, flow)
                edge += [(each, other, flow) for each in bonds]
            elif len(through := [each for each in bonds if not _yields(graph, each, other)]) == 1:
                # at a 0-junction flows add up: along the bonds, or against both of them
                against = (bond.head == other) == (through[0].head == other)
                edge.append((through[0], other, -flow if against else flow))
    return found


def _yields(graph: BondGraph, bond: GraphBond, junction: str) -> bool:
    """Whether a bond leads from a junction to a compliance, or to a 1-junction that has one."""
    label = bond.head if bond.tail == junction else bond.tail
    end = graph.elements[label]
    beyond = (each.head if each.tail == label else each.tail for each in graph.bonds_of(label))
    own = isinstance(end, One) and any(isinstance(graph.elements[each], C) for each in beyond)
    return isinstance(end, C) or (own and len(graph.bonds_of(label)) > 1)
