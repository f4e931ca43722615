"""Bond graphs of a double pendulum and of a cart with a pendulum.

Velocities across (x) and upwards (y) are 1-junctions, made from the rates of the angles by
modulated transformers. Angles are measured from hanging. The bobs' masses sit in x and y and are in
derivative causality wherever a rod has an inertia of its own.
"""

from __future__ import annotations

import sympy
from sympy import cos, sin

from bondgraph import TF, C, I, One, Se, Zero, assemble
from bondgraph.graph import BondGraph

m1, m2, l1, l2, g, M, k = sympy.symbols("m1 m2 l1 l2 g M k", positive=True)
J1, J2 = sympy.symbols("J1 J2", positive=True)
F = sympy.Symbol("F", real=True)

DOUBLE = {m1: 1.3, m2: 0.7, l1: 0.9, l2: 0.6, J1: 0.05, J2: 0.02, g: 9.81}
CART = {M: 1.7, m1: 0.8, l1: 0.7, J1: 0.03, k: 25.0, g: 9.81, F: 0.0}


def double_pendulum(
    values: dict[sympy.Symbol, float] | None = None, rods: bool = True
) -> BondGraph:
    """Two bobs on two rods; without rods, the bobs' own momenta across are the states."""
    w1, w2 = One("w1"), One("w2")
    x1, y1, x2, y2 = One("x1"), One("y1"), One("x2"), One("y2")
    across, upwards = Zero("across"), Zero("upwards")
    angle1, angle2 = C("angle1", stiffness=0), C("angle2", stiffness=0)
    inertias = (w1 >> I("J1", J1), w2 >> I("J2", J2)) if rods else ()
    return assemble(
        "double_pendulum",
        *inertias,
        w1 >> angle1,
        w2 >> angle2,
        w1 >> TF("cos1", l1 * cos(angle1.q)) >> x1 >> (I("m1x", m1), across),
        w1 >> TF("sin1", l1 * sin(angle1.q)) >> y1 >> (I("m1y", m1), Se("g1", m1 * g), upwards),
        w2 >> TF("cos2", l2 * cos(angle2.q)) >> across >> x2 >> I("m2x", m2),
        w2 >> TF("sin2", l2 * sin(angle2.q)) >> upwards >> y2 >> (I("m2y", m2), Se("g2", m2 * g)),
        parameters=values or {},
    )


def cart_pendulum(values: dict[sympy.Symbol, float] | None = None) -> BondGraph:
    """A cart on a spring along its rail, pushed by F, with a bob on a rod."""
    cart, arm, across, upwards, sway = (
        One("cart"),
        One("arm"),
        One("across"),
        One("upwards"),
        Zero("sway"),
    )
    angle = C("angle", stiffness=0)
    return assemble(
        "cart_pendulum",
        Se("push", F) >> cart >> (I("M", M), C("rail", stiffness=k), sway),
        arm >> (I("J", J1), angle),
        arm >> TF("cos", l1 * cos(angle.q)) >> sway >> across >> I("mx", m1),
        arm >> TF("sin", l1 * sin(angle.q)) >> upwards >> (I("my", m1), Se("weight", m1 * g)),
        parameters=values or {},
    )
