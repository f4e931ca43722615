"""`infer`: units of all variables of a graph, domains, contradictions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import sympy

from ..elements import C, De, Df, Element, Integrator, Lag, SignalBlock, Storage, TwoPort
from ..graph import BondGraph
from .claims import Regions, Symbols, claims
from .forms import DISPLAY, INTEGRALS, PSEUDO, TEMPERATURE, UNKNOWN, Form, named_unit
from .laws import lag_law
from .solver import Solver


@dataclass(frozen=True)
class Dimensions:
    """Units of a graph's variables, as far as declared units tell them.

    Attributes
    ----------
    units : mapping of str to str or None
        SI unit of every port variable and state by qualified name, such as
        ``rear.mass.p``, and of every sensor's output; None where nothing is known.
    domains : mapping of str to str
        ``translation``, ``rotation``, ``hydraulic``, ``electrical``,
        ``thermal`` or ``unknown`` by name of bond and of element; a two-port
        between two domains has both, such as ``rotation>translation``.
    problems : tuple of str
        Where units contradict each other: the element and both claims.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> dimensions = infer(bicycle_brake.graph())
    >>> dimensions.units["rear.mass.p"], dimensions.units["wheel.spokes.q"]
    ('N*s', 'rad')
    >>> dimensions.domains["rotor_radius"], dimensions.problems
    ('rotation>translation', ())
    """

    units: Mapping[str, str | None]
    domains: Mapping[str, str]
    problems: tuple[str, ...] = ()


def infer(graph: BondGraph) -> Dimensions:
    """Infer the units of a graph's port variables and states.

    Parameters
    ----------
    graph : BondGraph

    Returns
    -------
    Dimensions
        Contradictions are reported in ``problems``, never raised.

    Examples
    --------
    >>> import sympy
    >>> from bondgraph import C, One, Sf, assemble
    >>> k, w = sympy.symbols("k w", positive=True)
    >>> shaft = Sf("motor", w) >> One("shaft") >> C("spring", stiffness=k)
    >>> turning = assemble("turning", shaft, parameters={k: (3, "N*m/rad"), w: (1, "rad/s")})
    >>> infer(turning).units["spring.q"]
    'rad'
    >>> wrong = assemble("wrong", shaft, parameters={k: (3, "N/m"), w: (1, "rad/s")})
    >>> infer(wrong).problems[0].split(", but ")[1]
    "Sf 'motor' (w in rad/s) makes it N*m and rad/s here"
    """
    regions = Regions(graph)
    symbols = Symbols(graph, regions)
    solver = Solver(claims(graph, regions, symbols), regions.pseudo, regions.of_block.values())
    by_symbol = {
        symbol: _unit(element, symbol, symbols.variables[symbol], solver)
        for element in graph.elements.values()
        for symbol in element.symbols.values()
    }
    for _, block in graph.of(SignalBlock):
        by_symbol[block.y] = _signal_unit(block, by_symbol, symbols, solver)
    units = {
        f"{name}.{key}": by_symbol[symbol]
        for name, element in graph.elements.items()
        for key, symbol in element.symbols.items()
        if key != "speed"  # the slip speed of a contact's law is its flow
    }
    for name, sensor in graph.of((De, Df)):
        units[name] = by_symbol[sensor.e if isinstance(sensor, De) else sensor.f]
    domains = {
        bond.name: solver.domain(region)
        for bond, region in zip(graph.bonds, regions.of_bond, strict=True)
    }
    domains |= {
        name: _domain(element, name, regions, solver) for name, element in graph.elements.items()
    }
    problems = (*symbols.problems, *solver.problems())
    return Dimensions(MappingProxyType(units), MappingProxyType(domains), problems)


def _unit(element: Element, symbol: sympy.Symbol, form: Form, solver: Solver) -> str | None:
    region = next((key for key in form if isinstance(key, int)), None)
    if region is None and form:
        units: tuple[str, str, str, str] | None = PSEUDO
    elif region is None or region not in solver.effort:
        return None
    else:
        units = DISPLAY.get(solver.domain(region))
    if units is None:
        return named_unit(solver.resolved(form))
    effort, flow, displacement, momentum = units
    if isinstance(element, Storage) and symbol is element.state:
        return displacement if isinstance(element, C) else momentum
    return effort if form in ({region: 1}, TEMPERATURE) else flow


def _signal_unit(
    block: SignalBlock,
    known: Mapping[sympy.Basic, str | None],
    symbols: Symbols,
    solver: Solver,
) -> str | None:
    """Return the unit of what a block says; what it hears tells radians from pure numbers."""
    form = solver.resolved(symbols.variables[block.y])
    if any(isinstance(key, int) for key in form):
        return None
    heard = lag_law(block)[0] if isinstance(block, Lag) else block.rate
    unit = known.get(heard)
    if unit and isinstance(block, Lag):
        return unit
    if unit and isinstance(block, Integrator):
        return INTEGRALS.get(unit, named_unit(form))
    return named_unit(form)


def _domain(element: Element, name: str, regions: Regions, solver: Solver) -> str:
    bonds = regions.at[name]
    if not bonds:
        return UNKNOWN
    if not isinstance(element, TwoPort):
        return solver.domain(regions.of_bond[bonds[0]])
    sides = [solver.domain(regions.of_bond[bond]) for bond in regions.sides(name)]
    return sides[0] if sides[0] == sides[1] else ">".join(sides)
