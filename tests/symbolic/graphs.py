"""Graphs whose equations have closed forms in textbooks."""

from __future__ import annotations

import sympy

from bondgraph import GY, TF, C, Friction, I, One, R, Se, Sf, Zero, assemble


def positive(names):
    return sympy.symbols(names, positive=True)


u = sympy.Symbol("u", real=True)


def oscillator():
    """Mass, spring and damper pushed by a force."""
    m, b, k = positive("m b k")
    v, spring = One("v"), C("spring", stiffness=k)
    parts = (I("mass", m), spring, R("damper", b))
    return assemble("msd", Se("push", u) >> v >> parts, inputs=[u], outputs={"x": spring.q})


def motor():
    """DC motor that drives a load through a gear; the load's inertia has no state of its own."""
    L, r, K, J_m, J_l, b_m, b_l, n = positive("L R K J_m J_l b_m b_l n")
    current, rotor, load = One("current"), One("rotor"), One("load")
    inertia = I("load_inertia", J_l)
    return assemble(
        "motor",
        Se("supply", u) >> current >> (I("coil", L), R("winding", r)),
        current >> GY("motor", K) >> rotor >> (I("rotor_inertia", J_m), R("bearing", b_m)),
        rotor >> TF("gear", n) >> load >> (inertia, R("drag", b_l)),
        inputs=[u],
        outputs={"speed": load.f},
    )


def ladder(cells, kinds):
    """Series R, L or both, shunt C in each cell; every part has a symbol of its own."""
    parts, before = [], Se("supply", u)
    for place in range(1, cells + 1):
        one, zero = One(f"one{place}"), Zero(f"zero{place}")
        parts.append(before >> one >> zero >> C(f"c{place}", positive(f"C{place}")))
        if "R" in kinds:
            parts.append(one >> R(f"r{place}", positive(f"R{place}")))
        if "L" in kinds:
            parts.append(one >> I(f"l{place}", positive(f"L{place}")))
        before = zero
    return assemble("ladder", parts, inputs=[u], outputs={"y": before.e})


def pendulum():
    """A pendulum, driven by a torque, with its angle as a compliance without stiffness."""
    J, weight, b = positive("J weight b")
    angle, w = C("angle", stiffness=0), One("w")
    return assemble(
        "pendulum",
        Se("torque", u) >> w >> (I("inertia", J), angle, R("bearing", b)),
        w >> TF("lever", sympy.sin(angle.q)) >> Se("weight", weight),
        inputs=[u],
        outputs={"angle": angle.q},
    )


def implicit():
    """A resistor whose law is not inverted, in a loop: its flow stays an algebraic variable."""
    c, v = positive("c"), One("v")
    law = R("odd", effort=lambda f: f**3 + f)
    return assemble(
        "implicit", Se("E", u) >> v >> (law, C("c", c)), inputs=[u], outputs={"flow": law.f}
    )


def van_der_pol():
    """Van der Pol's oscillator: damping that is negative near the origin."""
    mu, v, spring = positive("mu"), One("v"), C("spring", 1)
    law = R("valve", effort=lambda f: -mu * (1 - spring.q**2) * f)
    return assemble("van_der_pol", v >> (I("mass", 1), spring, law))


def belt(law):
    """A mass on a belt under any law of friction."""
    m, c, k, v_b = positive("m c k v_b")
    drive, body = Zero("drive"), One("body")
    return assemble(
        "belt",
        Sf("speed", v_b) >> drive >> body >> (I("mass", m), C("spring", stiffness=k), R("c", c)),
        drive >> Friction("contact", kinetic=law),
        parameters={m: 1, c: 1, k: 1, v_b: 1},
    )
