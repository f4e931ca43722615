"""A bank of probes: every effect at every site, in one graph, with a coefficient of zero.

Of an effect whose law is proportional to a coefficient, the score test needs only what it is
multiplied by. So all effects of a site stand in one resistor, whatever elements they are made of
when they are grown into the graph for good.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import sympy

from ...elements import Integrator, R
from ...errors import BondGraphError
from ...graph import BondGraph
from ..candidates import DISPLACEMENT, EFFORT, FLOW, Change, Coefficient, Effect, Place, Scale
from ..candidates import effects as effects_of
from ..candidates.builders import source
from ..candidates.places import FLOW_JUNCTION, FLOW_PAIR, JUNCTIONS
from ..grafting import Site, graft, sites


@dataclass(frozen=True)
class Probe:
    """One effect at one site, as the score test sees it.

    Attributes
    ----------
    effect, site : str
        Names.
    coefficient : str
        Of the effect.
    parameter : str
        Of the bank's graph; zero.
    signed : bool
        Whether a negative value is physical.
    """

    effect: str
    site: str
    coefficient: str
    parameter: str
    signed: bool


@dataclass(frozen=True, eq=False)
class Bank:
    """A graph with probes.

    Attributes
    ----------
    graph : BondGraph
        Moves as the one without them.
    probes : tuple of Probe
    refused : tuple of (str, str)
        Sites that take no probe, and why.
    """

    graph: BondGraph
    probes: tuple[Probe, ...]
    refused: tuple[tuple[str, str], ...]


def bank(
    graph: BondGraph,
    effects: Iterable[Effect] | None = None,
    scales: Mapping[str, Scale] | None = None,
) -> Bank:
    """Put probes of effects at all junctions of a graph, and between them.

    Parameters
    ----------
    graph : BondGraph
    effects : iterable of Effect, optional
        The whole library unless given. Those that keep a memory of their own, or act on sources
        and outputs, are left out.
    scales : mapping of str to Scale, optional
        How large things are at a site, by its name: for laws with a width or a threshold, which
        are left out at sites without one.

    Returns
    -------
    Bank

    Examples
    --------
    >>> from bondgraph import C, I, One, R, Se, assemble
    >>> v = One("v")
    >>> graph = assemble("msd", Se("push", 1) >> v >> (I("m", 2), C("k", stiffness=8), R("b", 1)))
    >>> [probe.effect for probe in bank(graph).probes if probe.site == "v"]
    ['viscous_damping', 'coulomb_friction', 'quadratic_drag', 'linear_stiffness', 'cubic_stiffness', 'effort_bias']
    """
    known = tuple(effects_of() if effects is None else effects)
    grown, probes, refused = graph, [], []
    for site in sites(graph):
        if site.kind not in JUNCTIONS:
            continue
        scale = (scales or {}).get(site.name)
        shares = _shares(known, site, scale)
        if not shares:
            continue
        names = {f"{effect.name}_{item.name}": (effect, item) for effect, item, _ in shares}
        law = [share for _, _, share in shares]
        try:
            found = graft(
                grown, _probe(site, names, law), site, parameters=dict.fromkeys(names, 0.0)
            )
        except BondGraphError as error:
            refused.append((site.name, str(error)))
            continue
        grown = found.graph
        probes += [
            Probe(effect.name, site.name, item.name, found.parameters[name], item.signed)
            for name, (effect, item) in names.items()
        ]
    return Bank(grown, tuple(probes), tuple(refused))


Share = tuple[Effect, Coefficient, sympy.Expr]


def _shares(effects: Iterable[Effect], site: Site, scale: Scale | None) -> list[Share]:
    """Return what each coefficient of each effect that fits is multiplied by; nothing twice."""
    found: list[Share] = []
    for effect in effects:
        if not site.fits(effect):
            continue
        for item in effect.coefficients:
            share = share_of(effect, item, scale) if item.linear else None
            if share is not None and share not in (known for _, _, known in found):
                found.append((effect, item, share))
    return found


def share_of(effect: Effect, item: Coefficient, scale: Scale | None = None) -> sympy.Expr | None:
    """Return what an effect's effort or flow is per unit of a coefficient, to first order.

    Parameters
    ----------
    effect : Effect
    item : Coefficient
        Absent at zero.
    scale : Scale, optional
        For the other coefficients.

    Returns
    -------
    Expr or None
        In FLOW and DISPLACEMENT, or EFFORT; None where the law has a memory, or other
        coefficients and no scale to set them by.

    Examples
    --------
    >>> from bondgraph.discrepancy.candidates import EFFECTS
    >>> coulomb = EFFECTS["coulomb_friction"]
    >>> share_of(coulomb, coulomb.coefficients[0])
    sign(f)
    """
    law = _decided(effect)
    if law is None:
        return None
    symbols = effect.symbols
    gone = {symbols[name]: value for name, value in effect.absent.items()}
    share = sympy.diff(law, item.symbol).subs(gone)
    others = {
        symbols[c.name]: c for c in effect.coefficients if symbols[c.name] in share.free_symbols
    }
    if others and scale is None:
        return None
    if scale is not None:
        share = share.subs(
            {symbol: sympy.Float(c.start(scale), 17) for symbol, c in others.items()}
        )
    if share == 0 or share.free_symbols - {FLOW, EFFORT, DISPLACEMENT}:
        return None
    return -share if effect.build is source else share


def _decided(effect: Effect) -> sympy.Expr | None:
    """Return an effect's effort or flow where it is a function of the site's own variables."""
    law = effect.law
    if not effect.static and "energy" not in law:
        return None
    if "effort" in law:
        return law["effort"]
    if "flow" in law:
        return law["flow"]
    if "energy" in law:
        return sympy.diff(law["energy"], DISPLACEMENT)
    if "kinetic" in law:
        return law["kinetic"].subs(FLOW, sympy.Abs(FLOW)) * sympy.sign(FLOW)
    return None


def _probe(
    site: Site, names: Mapping[str, tuple[Effect, Coefficient]], law: list[sympy.Expr]
) -> Effect:
    """Return an effect that is the sum of others."""
    coefficients = tuple(
        Coefficient(name, item.unit, item.meaning, lambda s: 0.0, 0.0, True, signed=True)
        for name, (_, item) in names.items()
    )
    decided = "effort" if site.kind in (FLOW_JUNCTION, FLOW_PAIR) else "flow"
    total = sympy.Add(*(item.symbol * share for item, share in zip(coefficients, law, strict=True)))

    def build(
        place: Place, law: Mapping[str, sympy.Expr], symbols: Mapping[str, sympy.Symbol]
    ) -> Change:
        if decided == "flow":
            element = R(place.name, flow=lambda effort: law["flow"].xreplace({EFFORT: effort}))
            return Change((place.node >> element,))
        way, blocks = place.displacement, []
        if way is None and DISPLACEMENT in law["effort"].free_symbols:
            blocks = [Integrator(f"{place.name}_way", place.flow)]
            way = blocks[0].y
        moved = law["effort"].xreplace({DISPLACEMENT: way})
        element = R(place.name, effort=lambda flow: moved.xreplace({FLOW: flow}))
        return Change((place.node >> element,), blocks=tuple(blocks), first=(element,))

    return Effect(
        "probe",
        (site.kind,),
        coefficients,
        {decided: total},
        build,
        "effects to be scored",
        "Rao, Proc. Cambridge Phil. Soc. 44 (1948) 50-57",
        passive=False,
    )
