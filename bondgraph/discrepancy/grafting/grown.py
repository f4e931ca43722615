"""`graft`: an effect becomes elements of a graph."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import sympy

from ...elements import De, Df, Element
from ...equations import Equations, derive
from ...errors import BondGraphError, GraphError, ParameterError
from ...graph import BondGraph, GraphBond, Output
from ...graph.structure import check_structure, disconnected
from ...parameters import Parameter, as_parameter, check_unit, unknown_name
from ...resolver import resolve
from ..candidates.place import Change, Place
from ..candidates.places import BOND, EFFORT_PAIR, FLOW_PAIR, OUTPUT
from ..candidates.table import effects
from ..candidates.value import Effect, Scale
from .edits import Edit, edits_of
from .local import place_of, starts
from .places import Site, find_site
from .units import unit_of


@dataclass(frozen=True, eq=False)
class Grafted:
    """A graph with an effect grown into it.

    Attributes
    ----------
    graph : BondGraph
        The new graph; the old one is as it was.
    effect : Effect
    site : Site
    name : str
        Qualified name of the effect's element.
    elements : tuple of str
        Qualified names of all elements added or changed.
    parameters : mapping of str to str
        Name of the new parameter by coefficient.
    edits : tuple of Edit
        What changed, one line each as text.
    starts : mapping of str to Expr
        New states that begin where variables of the graph begin.
    equations : Equations
        Of the new graph.
    """

    graph: BondGraph
    effect: Effect
    site: Site
    name: str
    elements: tuple[str, ...]
    parameters: Mapping[str, str]
    edits: tuple[Edit, ...]
    starts: Mapping[str, sympy.Expr]
    equations: Equations = field(repr=False)

    def ties(
        self, states: Iterable[str], parameters: Mapping[Any, Any] | None = None
    ) -> dict[str, dict[str, float]]:
        """Return how the start of new elements follows that of states, as `fit` takes it.

        Parameters
        ----------
        states : iterable of str
        parameters : mapping, optional
            Overrides of parameters.

        Returns
        -------
        dict of str to dict of str to float
            Of new states that follow any of them.
        """
        known = list(states)
        nothing = dict.fromkeys(known, 0.0)
        base = self.initial(nothing, parameters)
        found: dict[str, dict[str, float]] = {}
        for name in known:
            moved = self.initial({**nothing, name: 1.0}, parameters)
            for state in self.starts:
                share = moved.get(state, 0.0) - base.get(state, 0.0)
                if share:
                    found.setdefault(state, {})[name] = share
        return found

    @property
    def diff(self) -> tuple[str, ...]:
        """What changed, as lines of text."""
        return tuple(map(str, self.edits))

    def initial(
        self, given: Mapping[str, float], parameters: Mapping[Any, Any] | None = None
    ) -> dict[str, float]:
        """Return initial states with those of the new elements that follow from them.

        A new spring beside one that begins stretched begins stretched too.

        Parameters
        ----------
        given : mapping of str to float
            Initial states by name, as for `bondgraph.simulate`.
        parameters : mapping, optional
            Overrides of parameters.

        Returns
        -------
        dict of str to float
        """
        numbers = resolve(self.graph.parameters, parameters, partial=True)
        values = {
            symbol: numbers[symbol.name]
            for symbol in self.graph.parameters
            if symbol.name in numbers
        }
        known: dict[sympy.Basic, sympy.Expr] = dict(starts(self.graph))
        for label, element in self.graph.elements.items():
            for key, symbol in element.symbols.items():
                if f"{label}.{key}" in given:
                    known[symbol] = sympy.Float(given[f"{label}.{key}"], 17)
        found = dict(given)
        for state, expression in self.starts.items():
            number = expression
            for _ in range(3):
                number = number.xreplace(known)
            number = number.subs(values)
            if state not in found and number.is_number:
                found[state] = float(number)
        return found


def graft(
    graph: BondGraph,
    effect: Effect | str,
    site: Site | str,
    name: str | None = None,
    parameters: Mapping[str, Any] | None = None,
    *,
    scale: Scale | None = None,
) -> Grafted:
    """Grow an effect into a graph.

    Parameters
    ----------
    graph : BondGraph
        Stays as it is.
    effect : Effect or str
        A value, or a name of the table `EFFECTS`.
    site : Site or str
        As `sites` names it: ``"carriage"``, ``"between a and b"``, ``"bond a>b"``, ``"output v"``.
    name : str, optional
        Of the new element; the effect's name, numbered where that is taken, unless given.
    parameters : mapping of str to number or (number, unit), optional
        Values by coefficient. Those left out start from `scale`.
    scale : Scale, optional
        Ones unless given.

    Returns
    -------
    Grafted

    Raises
    ------
    GraphError
        For an unknown or unfit site, a name that is taken.
    ParameterError
        For a coefficient that the effect does not have.
    BondGraphError
        Where the graph has no causality or no equations with the effect: the error of
        that stage, which says why, with the effect named.

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble
    >>> v = One("carriage")
    >>> model = assemble("m", Se("push", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 1)))
    >>> grown = graft(model, "coulomb_friction", "carriage", parameters={"level": 3})
    >>> grown.diff[0], sorted(grown.graph.elements.keys() - model.elements.keys())
    ("+ Friction 'coulomb_friction' on 1-junction 'carriage'", ['coulomb_friction'])
    """
    chosen = effects(effect)[0]
    where = find_site(graph, chosen, site)
    prefix = _prefix(graph, where)
    label = _label(graph, prefix, chosen.name if name is None else name, named=name is not None)
    place = place_of(_unsensed(graph, where), where, label.removeprefix(prefix))
    symbols = _symbols(graph, chosen, label)
    in_graph = {item.symbol: symbols[item.name] for item in chosen.coefficients}
    law = {key: value.xreplace(in_graph) for key, value in chosen.law.items()}
    change = chosen.build(place, law, symbols)
    rows = _rows(graph, chosen, where, symbols, parameters or {}, scale)
    grown, labels = _grown(_unsensed(graph, where), where, place, change, prefix, rows)
    try:
        equations = derive(grown)
    except BondGraphError as error:
        words = f"{chosen.name} at {where.name!r} of graph {graph.name!r}: {error}"
        raise type(error)(words, elements=error.elements, bonds=error.bonds) from None
    states = {state.name for state in equations.states}
    changed = tuple(labels[new] for new in labels if labels[new] not in graph.elements)
    changed += tuple(labels[new] for new in change.replaced.values())
    named = {
        f"{labels[element]}.{key}": change.starts[symbol]
        for element in labels
        for key, symbol in element.symbols.items()
        if symbol in change.starts and f"{labels[element]}.{key}" in states
    }
    return Grafted(
        grown,
        chosen,
        where,
        label,
        changed,
        MappingProxyType({key: symbol.name for key, symbol in symbols.items()}),
        edits_of(graph, grown),
        MappingProxyType(named),
        equations,
    )


def _unsensed(graph: BondGraph, site: Site) -> BondGraph:
    """Return the graph without the ideal detector whose output is to say something else.

    The output stays, as an expression in its junction's variable.
    """
    label = site.at[0]
    sensor = graph.elements.get(label)
    if site.kind != OUTPUT or not isinstance(sensor, De | Df):
        return graph
    (bond,) = graph.bonds_of(label)
    junction = graph.elements[bond.tail if bond.head == label else bond.head]
    key = "e" if isinstance(sensor, De) else "f"
    heard = {sensor.symbols[key]: junction.symbols[key]}
    return replace(
        graph,
        elements={
            name: element.replaced(heard) if _hears(element, heard) else element
            for name, element in graph.elements.items()
            if name != label
        },
        bonds=tuple(each for each in graph.bonds if each is not bond),
        outputs={
            name: replace(output, expression=output.expression.xreplace(heard))
            for name, output in graph.outputs.items()
        },
    )


def _hears(element: Element, symbols: Mapping[sympy.Basic, sympy.Basic]) -> bool:
    return any(law.free_symbols & symbols.keys() for law in element.laws.values())


def _prefix(graph: BondGraph, site: Site) -> str:
    """Return the submodel, with its dot, that holds the whole site."""
    if site.kind == OUTPUT:
        return ""
    ends = site.at
    if site.kind == BOND:
        bond = next(bond for bond in graph.bonds if bond.name == site.at[0])
        ends = (bond.tail, bond.head)
    prefixes = {end.rpartition(".")[0] for end in ends}
    return f"{prefixes.pop()}." if len(prefixes) == 1 and "" not in prefixes else ""


def _label(graph: BondGraph, prefix: str, name: str, *, named: bool) -> str:
    """Return a qualified name that is free, with all that begins with it."""
    taken = {label.removeprefix(prefix) for label in graph.elements if label.startswith(prefix)}
    taken_by = [label for label in taken if label == name or label.startswith(f"{name}_")]
    if not taken_by:
        return prefix + name
    if named:
        raise GraphError(
            f"graph {graph.name!r} has an element {prefix + taken_by[0]!r} already; give another name",
            elements=[prefix + taken_by[0]],
        )
    number = 2
    while any(label.startswith(f"{name}{number}") for label in taken):
        number += 1
    return f"{prefix}{name}{number}"


def _symbols(graph: BondGraph, effect: Effect, label: str) -> dict[str, sympy.Symbol]:
    """Return the new parameters' symbols, with what the coefficients assume."""
    taken = {symbol.name for symbol in (*graph.parameters, *graph.inputs)}
    stem = label.replace(".", "_").replace(" ", "_")
    while any(f"{stem}_{item.name}" in taken for item in effect.coefficients):
        stem += "_"
    return {
        item.name: sympy.Symbol(f"{stem}_{item.name}", **item.symbol._assumptions_orig)
        for item in effect.coefficients
    }


def _rows(
    graph: BondGraph,
    effect: Effect,
    site: Site,
    symbols: Mapping[str, sympy.Symbol],
    given: Mapping[str, Any],
    scale: Scale | None,
) -> dict[sympy.Symbol, Parameter]:
    """Return the new rows of the parameter table."""
    for key in given:
        if key not in symbols:
            raise unknown_name(f"{effect.name}: coefficient", str(key), symbols)
    start, rows = effect.start(scale), {}
    for item in effect.coefficients:
        unit = unit_of(graph, site, item)
        row = as_parameter(item.name, given.get(item.name, start[item.name]))
        if row.unit and unit:
            check_unit(item.name, row.unit, unit)
        if row.derived:
            raise ParameterError(
                f"{effect.name}: coefficient {item.name!r} takes a number, not {row.value}"
            )
        meaning = f"{item.meaning}; added by {effect.name} at {site.name}"
        rows[symbols[item.name]] = Parameter(row.value, row.unit or unit, meaning, effect.reference)
    return rows


def _grown(
    graph: BondGraph,
    site: Site,
    place: Place,
    change: Change,
    prefix: str,
    rows: Mapping[sympy.Symbol, Parameter],
) -> tuple[BondGraph, dict[Element, str]]:
    """Return the new graph, and names by element of what is new in it."""
    elements: dict[str, Element] = {prefix + new.name: new for new in change.first}
    elements |= {
        label: change.replaced.get(element, element) for label, element in graph.elements.items()
    }
    names = {element: label for label, element in elements.items()}
    new = {element: names[element] for element in (*change.first, *change.replaced.values())}
    pairs = [(bond.tail, bond.head) for chain in change.bonds for bond in chain.bonds]
    if site.kind in (FLOW_PAIR, EFFORT_PAIR):
        pairs = [
            (elements[site.at[0]], place.node),
            (place.node, elements[site.at[1]]),
            *pairs,
        ]
    bonds = list(graph.bonds)
    if site.kind == BOND:
        cut = next(bond for bond in bonds if bond.name == site.at[0])
        bonds.remove(cut)
        pairs = [(elements[cut.tail], place.node), (place.node, elements[cut.head]), *pairs]
    for element in (*(end for pair in pairs for end in pair), *change.blocks):
        if element not in names:
            names[element] = new[element] = prefix + element.name
            elements[names[element]] = element
    for tail, head in pairs:
        bonds.append(_bond(names[tail], names[head], bonds))
    outputs = dict(graph.outputs)
    if site.kind == OUTPUT and change.signal is not None:
        old = outputs[site.at[0]]
        outputs[site.at[0]] = Output(change.signal, old.unit, old.meaning)
    check_structure(graph.name, elements, bonds, frozenset(graph.ports.values()))
    grown = BondGraph(
        graph.name,
        MappingProxyType(elements),
        tuple(bonds),
        graph.ports,
        MappingProxyType({**graph.parameters, **rows}),
        graph.inputs,
        MappingProxyType(outputs),
        disconnected(graph.name, elements, bonds),
        graph.notes,
    )
    return grown, new


def _bond(tail: str, head: str, bonds: list[GraphBond]) -> GraphBond:
    taken = {bond.name for bond in bonds}
    name, count = f"{tail}>{head}", 1
    while name in taken:
        count += 1
        name = f"{tail}>{head} ({count})"
    return GraphBond(name, tail, head)
