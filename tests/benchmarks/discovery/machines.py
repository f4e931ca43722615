"""Nominal models: the eight small machines, and some with a part left out or a number known.

A number that no signal tells, such as the mass that sets the scale of all forces where the input is
a speed, stands in the law; so coefficients can be compared with the truth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import sympy

from bondgraph import BondGraph

from ...discrepancy import machines


def without(graph: BondGraph, *labels: str) -> BondGraph:
    """Return a graph without one-ports, and without the rows only they used."""
    elements = {name: part for name, part in graph.elements.items() if name not in labels}
    bonds = tuple(b for b in graph.bonds if not {b.tail, b.head} & set(labels))
    used: set[sympy.Basic] = set().union(
        *(law.free_symbols for part in elements.values() for law in part.laws.values())
    )
    rows = {symbol: row for symbol, row in graph.parameters.items() if symbol in used}
    return replace(graph, elements=elements, bonds=bonds, parameters=rows)


def known(graph: BondGraph, name: str, value: float) -> BondGraph:
    """Return a graph in which a parameter is a number of the law."""
    (symbol,) = (each for each in graph.parameters if each.name == name)
    number = {symbol: sympy.nsimplify(value, rational=True)}
    elements = {label: part.replaced(number) for label, part in graph.elements.items()}
    rows = {each: row for each, row in graph.parameters.items() if each != symbol}
    return replace(graph, elements=elements, parameters=rows)


def quarter_car() -> BondGraph:
    return known(machines.quarter_car(), "ms", 300)


def hydraulic_cylinder() -> BondGraph:
    return known(machines.hydraulic_cylinder(), "A", 2e-3)


def undamped_chain() -> BondGraph:
    return without(machines.two_mass_chain(), "damper1")


def unheld_chain() -> BondGraph:
    return without(machines.two_mass_chain(), "ground")


def free_motor() -> BondGraph:
    return without(machines.dc_motor(), "bearing")


def rc() -> BondGraph:
    return without(machines.rlc(), "coil")


def weighed_mass() -> BondGraph:
    return known(machines.mass_spring(), "m", 2)


def weighed_chain() -> BondGraph:
    return known(machines.two_mass_chain(), "m2", 0.5)


MACHINES: dict[str, Callable[[], BondGraph]] = {
    "mass_spring": machines.mass_spring,
    "two_mass_chain": machines.two_mass_chain,
    "undamped_chain": undamped_chain,
    "unheld_chain": unheld_chain,
    "dc_motor": machines.dc_motor,
    "free_motor": free_motor,
    "quarter_car": quarter_car,
    "two_tanks": machines.two_tanks,
    "hydraulic_cylinder": hydraulic_cylinder,
    "thermal_brake": machines.thermal_brake,
    "rlc": machines.rlc,
    "rc": rc,
    "weighed_mass": weighed_mass,
    "weighed_chain": weighed_chain,
}
