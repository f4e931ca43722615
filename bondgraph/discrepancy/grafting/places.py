"""Where in a graph effects can go."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations

from ...dimensions import Dimensions, infer
from ...elements import C, De, Df, Friction, Heat, I, One, OnePort, R, Se, Sf, Zero
from ...errors import GraphError, suggestion
from ...graph import BondGraph
from ..candidates.places import (
    BOND,
    DISSIPATOR,
    EFFORT_JUNCTION,
    EFFORT_PAIR,
    FLOW_JUNCTION,
    FLOW_PAIR,
    INERTIA,
    MECHANICAL,
    OUTPUT,
    POTENTIAL,
    SOURCE,
)
from ..candidates.value import Effect

UNKNOWN = "unknown"
# a series compliance is felt through none of these: they decide the effort, or take none
_STIFF = (Zero, C, Se, De, Df, Heat)


@dataclass(frozen=True)
class Site:
    """A place where an effect can act.

    Attributes
    ----------
    kind : str
        One of `bondgraph.discrepancy.candidates.places.KINDS`.
    at : tuple of str
        Qualified names: one element, bond or output, or the two of a pair.
    domain : str
        ``translation``, ``rotation``, ``hydraulic``, ``electrical``, ``thermal`` or ``unknown``.

    Examples
    --------
    >>> Site("between 1-junctions", ("rear.caliper", "rim"), "translation").name
    'between rear.caliper and rim'
    """

    kind: str
    at: tuple[str, ...]
    domain: str = UNKNOWN

    @property
    def name(self) -> str:
        """The junction's name, ``between a and b``, or kind and name."""
        if self.kind in (FLOW_JUNCTION, EFFORT_JUNCTION):
            return self.at[0]
        if self.kind in (FLOW_PAIR, EFFORT_PAIR):
            return f"between {self.at[0]} and {self.at[1]}"
        return f"{self.kind} {self.at[0]}"

    def fits(self, effect: Effect) -> bool:
        """Whether an effect may act here; an unknown domain may be any."""
        known = self.domain != UNKNOWN and effect.domains
        return self.kind in effect.sites and not (known and self.domain not in effect.domains)


def sites(graph: BondGraph, effect: Effect | None = None) -> tuple[Site, ...]:
    """Return the places where effects can go, in the order of the graph.

    Parameters
    ----------
    graph : BondGraph
    effect : Effect, optional
        Only those that this one fits.

    Returns
    -------
    tuple of Site

    Examples
    --------
    >>> from bondgraph import C, I, One, OnePort, R, Se, assemble
    >>> v = One("v")
    >>> graph = assemble("msd", Se("push", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 1)))
    >>> [site.name for site in sites(graph)]
    ['v', 'bond v>m', 'bond v>b', 'source push', 'inertia m', 'dissipator b']
    """
    domains = infer(graph)
    found = [
        *_junctions(graph, domains),
        *_pairs(graph, domains),
        *_bonds(graph, domains),
        *_elements(graph, domains),
        *(Site(OUTPUT, (name,)) for name in graph.outputs),
    ]
    return tuple(site for site in found if effect is None or site.fits(effect))


def find_site(graph: BondGraph, effect: Effect, site: Site | str) -> Site:
    """Return a site of a graph by its name, among those that fit an effect.

    Parameters
    ----------
    graph : BondGraph
    effect : Effect
    site : Site or str

    Returns
    -------
    Site

    Raises
    ------
    GraphError
        Where there is none of that name, or the effect does not fit it.
    """
    known = sites(graph)
    name = site.name if isinstance(site, Site) else site
    named = [
        each for each in known if each.name == name or (len(each.at) == 1 and each.at[0] == name)
    ]
    if reverse := _reversed(name):
        named += [Site(s.kind, s.at[::-1], s.domain) for s in known if s.name == reverse]
    fitting = [each for each in named if each.fits(effect)]
    if fitting:
        return fitting[0]
    if named:
        raise GraphError(
            f"graph {graph.name!r}: {effect.name} fits {' or '.join(effect.sites)}"
            f"{' (' + ', '.join(effect.domains) + ')' if effect.domains else ''}; "
            f"{name!r} is {named[0].kind}, {named[0].domain}",
            elements=named[0].at,
        )
    hint = suggestion(name, [each.name for each in known if each.fits(effect)])
    raise GraphError(f"graph {graph.name!r} has no site {name!r}; {hint or 'see sites(graph)'}")


def _reversed(name: str) -> str:
    if not name.startswith("between ") or " and " not in name:
        return ""
    first, _, second = name.removeprefix("between ").partition(" and ")
    return f"between {second} and {first}"


def _junctions(graph: BondGraph, dimensions: Dimensions) -> Iterable[Site]:
    for name, element in graph.of((One, Zero)):
        kind = FLOW_JUNCTION if isinstance(element, One) else EFFORT_JUNCTION
        yield Site(kind, (name,), dimensions.domains[name])


def _pairs(graph: BondGraph, dimensions: Dimensions) -> Iterable[Site]:
    """Yield pairs of bodies, or of vessels and nodes; power runs from the first to the second."""
    for kind, junction, domains in ((FLOW_PAIR, One, MECHANICAL), (EFFORT_PAIR, Zero, POTENTIAL)):
        names = [name for name, _ in graph.of(junction) if not _difference(graph, name)]
        for first, second in combinations(names, 2):
            domain = dimensions.domains[first]
            if domain == dimensions.domains[second] and domain in (*domains, UNKNOWN):
                yield Site(kind, (first, second), domain)


def _difference(graph: BondGraph, name: str) -> bool:
    """Whether a junction only holds the difference of two others: a spring's own 1-junction."""
    junction = graph.elements[name]
    bonds = graph.bonds_of(name)
    ends = [graph.elements[bond.head if bond.tail == name else bond.tail] for bond in bonds]
    own = I if isinstance(junction, One) else C
    joined = [end for end in ends if not isinstance(end, OnePort)]
    return len(joined) < 2 and not any(isinstance(end, own | Se | Sf) for end in ends)


def _bonds(graph: BondGraph, dimensions: Dimensions) -> Iterable[Site]:
    for bond in graph.bonds:
        ends = graph.elements[bond.tail], graph.elements[bond.head]
        if not any(isinstance(end, _STIFF) for end in ends):
            yield Site(BOND, (bond.name,), dimensions.domains[bond.name])


def _elements(graph: BondGraph, dimensions: Dimensions) -> Iterable[Site]:
    for name, element in graph.elements.items():
        kind = ""
        if isinstance(element, Se | Sf):
            kind = SOURCE
        elif isinstance(element, I) and not element.partners:
            kind = INERTIA
        elif isinstance(element, R | Friction) and not getattr(element, "partners", None):
            kind = DISSIPATOR
        if kind:
            yield Site(kind, (name,), dimensions.domains[name])
