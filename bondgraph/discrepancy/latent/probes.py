"""A model with a probe at every site: an unknown effort or flow of zero that effects may be.

What an effect does is a probe's amount over time. So one graph serves all effects, those with a
memory too: their columns are computed from the smoothed signals of the site.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import sympy

from ...elements import I, One, R, Se, Sf
from ...equations import derive
from ...errors import BondGraphError
from ...graph import BondGraph
from ..candidates import Change, Coefficient, Effect, Place
from ..candidates.builders import resourced, stands_for, weakened
from ..candidates.places import (
    BOND,
    DISSIPATOR,
    EFFORT_JUNCTION,
    EFFORT_PAIR,
    FLOW_JUNCTION,
    FLOW_PAIR,
    INERTIA,
    JUNCTIONS,
    OUTPUT,
    SOURCE,
)
from ..grafting import Site, graft, sites
from ..grafting.local import displacement, relative

AMOUNT = Coefficient("amount", "", "unknown effort or flow", lambda s: 0.0, 0.0, True, signed=True)


@dataclass(frozen=True, eq=False)
class Probe:
    """A probe at a site.

    Attributes
    ----------
    site : Site
    parameter : str
        Of the probed graph; zero.
    signals : mapping of str to Expr
        ``flow``, ``displacement``, ``effort``, ``momentum`` as far as the site has them, in the
        graph's variables.
    behind : Site or None
        The 1-junction that a compliance here would set free of its flow source, and that has
        no inertia to move by.
    """

    site: Site
    parameter: str
    signals: Mapping[str, sympy.Expr]
    behind: Site | None = None

    @property
    def errs(self) -> bool:
        """Whether a model's own error may act here: at junctions and between them."""
        return self.site.kind in JUNCTIONS


@dataclass(frozen=True, eq=False)
class Probed:
    """A graph with probes.

    Attributes
    ----------
    graph : BondGraph
        Moves as the one without them.
    probes : tuple of Probe
    refused : tuple of (str, str)
        Sites that take none, and why.
    """

    graph: BondGraph
    probes: tuple[Probe, ...]
    refused: tuple[tuple[str, str], ...]


def probed(graph: BondGraph, effects: Iterable[Effect], within: BondGraph | None = None) -> Probed:
    """Put a probe at every site that one of the effects fits.

    Parameters
    ----------
    graph : BondGraph
    effects : iterable of Effect
    within : BondGraph, optional
        Only at sites that this graph has too: not inside an effect that was grown in before.

    Returns
    -------
    Probed

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble
    >>> from bondgraph.discrepancy.candidates import effects
    >>> v = One("v")
    >>> graph = assemble("msd", Se("push", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 1)))
    >>> [probe.site.name for probe in probed(graph, effects()).probes]
    ['v', 'bond v>m', 'bond v>b', 'source push', 'inertia m', 'dissipator b']
    """
    known = tuple(effects)
    grown, probes, refused = graph, [], []
    equations = derive(graph)
    rates = set(equations.input_rates)
    names = {site.name for site in sites(within or graph)}
    for site in sites(graph):
        if not any(site.fits(effect) for effect in known) or site.name not in names:
            continue
        try:
            found = graft(grown, _effect(site), site, name=None, parameters={"amount": 0.0})
        except BondGraphError as error:
            refused.append((site.name, str(error)))
            continue
        if set(found.equations.input_rates) - rates:
            refused.append((site.name, "it would ask for the rate of an input"))
            continue
        grown, equations = found.graph, found.equations
        amount, said = found.parameters["amount"], _signals(graph, site)
        probes.append(Probe(site, amount, said, _behind(graph, site)))
    felt = {symbol.name for symbol in equations.parameters}  # what nothing depends on is not
    return Probed(
        grown, tuple(probe for probe in probes if probe.parameter in felt), tuple(refused)
    )


def _behind(graph: BondGraph, site: Site) -> Site | None:
    """Return the 1-junction that a bond ties to a flow source and that has no inertia."""
    if site.kind != BOND:
        return None
    bond = next(each for each in graph.bonds if each.name == site.at[0])
    for source, label in ((bond.tail, bond.head), (bond.head, bond.tail)):
        if isinstance(graph.elements[source], Sf) and isinstance(graph.elements[label], One):
            around = {end for each in graph.bonds_of(label) for end in (each.tail, each.head)}
            if not any(isinstance(graph.elements[each], I) for each in around):
                return Site(FLOW_JUNCTION, (label,), site.domain)
    return None


def _effect(site: Site) -> Effect:
    return Effect(
        "probe",
        (site.kind,),
        (AMOUNT,),
        {"amount": AMOUNT.symbol},
        _BUILDERS[site.kind],
        "an unknown effort or flow",
        "Friedland, Treatment of bias in recursive filtering, IEEE Trans. Autom. Control 14 (1969)",
        passive=False,
    )


Law = Mapping[str, sympy.Expr]
Symbols = Mapping[str, sympy.Symbol]


def _taken_effort(place: Place, law: Law, symbols: Symbols) -> Change:
    element = R(place.name, effort=lambda flow: law["amount"])
    return Change((place.node >> element,), first=(element,))


def _taken_flow(place: Place, law: Law, symbols: Symbols) -> Change:
    return Change((place.node >> R(place.name, flow=lambda effort: law["amount"]),))


def _added_signal(place: Place, law: Law, symbols: Symbols) -> Change:
    assert place.signal is not None
    signal = place.signal + law["amount"]
    if place.element is None:
        return Change(signal=signal)
    return Change(replaced={place.element: resourced(place.element, signal)})


def _added_flow(place: Place, law: Law, symbols: Symbols) -> Change:
    old = place.element
    new = I(
        old.name,
        flow=lambda p: (old.law + law["amount"]).xreplace({old.p: p}),
        initial=old.initial,
    )
    return Change(replaced={old: stands_for(new, old)})


def _weakened(place: Place, law: Law, symbols: Symbols) -> Change:
    return Change(replaced={place.element: weakened(place.element, 1 - law["amount"])})


_BUILDERS = {
    FLOW_JUNCTION: _taken_effort,
    FLOW_PAIR: _taken_effort,
    EFFORT_JUNCTION: _taken_flow,
    EFFORT_PAIR: _taken_flow,
    BOND: _taken_flow,
    SOURCE: _added_signal,
    OUTPUT: _added_signal,
    INERTIA: _added_flow,
    DISSIPATOR: _weakened,
}


def _signals(graph: BondGraph, site: Site) -> dict[str, sympy.Expr]:
    """Return what is to be known at a site, in the variables of the graph."""
    if site.kind == OUTPUT:
        return {"effort": graph.outputs[site.at[0]].expression}
    if site.kind == BOND:
        return {"effort": _bond_effort(graph, site.at[0])}
    ends = [graph.elements[label] for label in site.at]
    first = ends[0]
    if site.kind in (EFFORT_JUNCTION, EFFORT_PAIR):
        effort = first.symbols["e"]
        return {"effort": effort if len(ends) == 1 else effort - ends[1].symbols["e"]}
    if site.kind in (FLOW_JUNCTION, FLOW_PAIR):
        flow = first.symbols["f"]
        pair = len(ends) == 2
        found = {"flow": flow - ends[1].symbols["f"] if pair else flow}
        way = relative(graph, *site.at) if pair else displacement(graph, site.at[0])
        return found if way is None else found | {"displacement": way}
    if site.kind == SOURCE:
        if isinstance(first, Se):
            return {"effort": first.effort}
        assert isinstance(first, Sf)
        return {"effort": first.flow}
    found = {"flow": first.symbols["f"], "effort": first.symbols["e"]}
    return found | {"momentum": first.p} if isinstance(first, I) else found


def _bond_effort(graph: BondGraph, name: str) -> sympy.Expr:
    """Return the effort of a bond, in the variable of one of its ends."""
    bond = next(each for each in graph.bonds if each.name == name)
    for label, port in ((bond.tail, "e_out"), (bond.head, "e_in")):
        symbols = graph.elements[label].symbols
        for key in (port, "e"):
            if key in symbols:
                return symbols[key]
    return sympy.nan  # two 1-junctions in a row: no variable of its own
