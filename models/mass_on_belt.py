"""Mass on a moving belt, held by a spring: the textbook stick-slip oscillator."""

from __future__ import annotations

import sympy

from bondgraph.elements import C, Friction, I, One, R, Sf, Zero
from bondgraph.graph import BondGraph, assemble
from bondgraph.laws import stribeck
from bondgraph.parameters import Parameter

m, k, v_s, N = sympy.symbols("m k v_s N", positive=True)
c, mu_s, mu_k = sympy.symbols("c mu_s mu_k", nonnegative=True)
v_b = sympy.Symbol("v_b", real=True)

# What a report follows the eigenvalues over unless it is told otherwise, and the pairs that it
# maps: NAME, LO, HI, N in SI.
VARY = (("v_b", 0.02, 0.8, 200),)
MAPS = (
    (("v_b", 0.02, 0.8, 60), ("c", 0.0, 4.0, 60)),
    (("v_b", 0.02, 0.8, 60), ("v_s", 0.03, 0.4, 60)),
)


def graph() -> BondGraph:
    """Build the bond graph of a mass on a belt.

    Returns
    -------
    BondGraph
        Outputs x (m), v (m/s) and slip (m/s); starts at rest, spring relaxed.

    References
    ----------
    Popp, Stelter, Stick-slip vibrations and chaos, Phil. Trans. R. Soc. A 332
    (1990) 89-105.

    Examples
    --------
    >>> sorted(graph().outputs)
    ['slip', 'v', 'x']
    """
    belt, body = Zero("belt"), One("body")
    mass, spring = I("mass", m), C("spring", stiffness=k)
    contact = Friction(
        "contact", kinetic=lambda speed: stribeck(speed, normal=N, mu_s=mu_s, mu_k=mu_k, v_s=v_s)
    )
    return assemble(
        "mass_on_belt",
        Sf("drive", v_b) >> belt >> body >> (mass, spring, R("damper", c)),
        belt >> contact,
        parameters={
            m: Parameter(1.0, "kg", "mass", "example"),
            k: Parameter(100.0, "N/m", "spring stiffness", "example"),
            c: Parameter(0.2, "N*s/m", "damping", "example"),
            N: Parameter(10.0, "N", "normal force", "example"),
            mu_s: Parameter(0.4, "", "static friction coefficient", "example"),
            mu_k: Parameter(0.25, "", "kinetic friction coefficient", "example"),
            v_s: Parameter(0.1, "m/s", "slip sensitivity of the friction", "example"),
            v_b: Parameter(0.15, "m/s", "belt speed", "example"),
        },
        outputs={
            "x": (spring.q, "m", "position"),
            "v": (mass.f, "m/s", "speed"),
            "slip": (contact.f, "m/s", "slip of the belt under the mass"),
        },
    )
