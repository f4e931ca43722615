"""Quarter car: a body and a wheel between suspension, tyre and road."""

from __future__ import annotations

import sympy

from bondgraph.elements import C, I, One, R, Se, Sf, Zero
from bondgraph.graph import BondGraph, assemble
from bondgraph.parameters import Parameter

m_s, m_u, k_s, k_t = sympy.symbols("m_s m_u k_s k_t", positive=True)
b_s, g = sympy.symbols("b_s g", nonnegative=True)
v_road = sympy.Symbol("v_road", real=True)

# What a report follows the eigenvalues over unless it is told otherwise, and the pairs that it
# maps: NAME, LO, HI, N in SI.
VARY = (("b_s", 100.0, 6000.0, 200),)
MAPS = ((("b_s", 100.0, 6000.0, 60), ("k_s", 5e3, 60e3, 60)),)


def graph() -> BondGraph:
    """Build the bond graph of a quarter car.

    Returns
    -------
    BondGraph
        Input v_road (m/s), the vertical speed of the road under the tyre;
        outputs of body speed and acceleration and of both deflections. Starts
        at rest on its springs.

    References
    ----------
    Karnopp, Margolis, Rosenberg, System Dynamics, 5th ed., Wiley 2012.

    Examples
    --------
    >>> sorted(graph().outputs)
    ['acceleration', 'suspension', 'tyre', 'v_body']
    """
    contact, wheel, strut, body = Zero("contact"), One("wheel"), Zero("strut"), One("body")
    damper = One("suspension")
    sprung = I("sprung", m_s)
    spring = C("spring", stiffness=k_s, initial=m_s * g / k_s)
    tyre = C("tyre", stiffness=k_t, initial=(m_s + m_u) * g / k_t)
    return assemble(
        "quarter_car",
        Sf("road", v_road) >> contact >> (tyre, wheel),
        wheel >> (I("unsprung", m_u), strut),
        wheel >> Se("weight_unsprung", m_u * g),
        strut >> damper >> (spring, R("damper", b_s)),
        strut >> body >> sprung,
        body >> Se("weight_sprung", m_s * g),
        parameters={
            m_s: Parameter(300.0, "kg", "sprung mass", "example"),
            m_u: Parameter(40.0, "kg", "unsprung mass", "example"),
            k_s: Parameter(20.0, "kN/m", "suspension stiffness", "example"),
            k_t: Parameter(180.0, "kN/m", "tyre stiffness", "example"),
            b_s: Parameter(1200.0, "N*s/m", "suspension damping", "example"),
            g: Parameter(9.81, "m/s^2", "gravity", "standard"),
        },
        inputs={v_road: "m/s"},
        outputs={
            "v_body": (sprung.f, "m/s", "body speed, upwards"),
            "acceleration": (sprung.e / m_s, "m/s^2", "body acceleration"),
            "suspension": (spring.q, "m", "compression of the suspension"),
            "tyre": (tyre.q, "m", "compression of the tyre"),
        },
    )
