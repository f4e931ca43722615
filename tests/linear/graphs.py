"""Small models whose linear systems are known, and what compares their numbers."""

import numpy
import pytest
import sympy

from bondgraph import C, I, One, R, Se, Sf, Zero, assemble, linearize, models


def close(found, expected, rel=1e-6):
    return numpy.asarray(found) == pytest.approx(numpy.asarray(expected), rel=rel, abs=1e-12)


def pairs(*expected):
    """Poles with their conjugates, least stable first."""
    both = [
        value for pole in expected for value in ([pole, pole.conjugate()] if pole.imag else [pole])
    ]
    return numpy.array(both)


def oscillator(force=1, **laws):
    v = One("v")
    mass, spring = I("m", 2), C("k", stiffness=8)
    graph = assemble("osc", Se("F", force) >> v >> (mass, spring, R("b", 0.5)), **laws)
    return graph, mass, spring


def driven():
    """One input; of three outputs one has a direct part."""
    F = sympy.Symbol("F")
    mass, spring = I("m", 2), C("k", stiffness=8)
    graph = assemble(
        "driven",
        Se("push", F) >> One("v") >> (mass, spring, R("b", 0.5)),
        inputs={F: "N"},
        outputs={"x": (spring.q, "m"), "a": (mass.e / 2, "m/s^2"), "v": (mass.f, "m/s")},
    )
    return linearize(graph)


def pulled():
    """Two masses with a soft spring between; a force on each, a speed and a force as outputs."""
    F, G = sympy.symbols("F G")
    a, b, node = One("a"), One("b"), Zero("node")
    m_a, spring = I("m_a", 2), C("soft", stiffness=5)
    graph = assemble(
        "pulled",
        Se("push", F) >> a >> (m_a, R("b_a", 0.7), C("k_a", stiffness=20)),
        Se("pull", G) >> b >> (I("m_b", 3), R("b_b", 1.1)),
        a >> node >> b,
        node >> spring,
        inputs={F: "N", G: "N"},
        outputs={"v_a": (m_a.f, "m/s"), "tie": (spring.e, "N")},
    )
    return linearize(graph)


def ladder(cells):
    """An electrical ladder: 2 states a cell, no zeros from the source to the last capacitor."""
    E, end = sympy.Symbol("E"), None
    bonds, before = [], Se("source", E)
    for k in range(cells):
        loop, node, end = One(f"loop{k}"), Zero(f"node{k}"), C(f"c{k}", 1e-6)
        bonds += [
            before >> loop >> (I(f"l{k}", 1e-3 * (1 + k)), R(f"r{k}", 0.1), node),
            node >> end,
        ]
        before = node
    bonds.append(before >> R("load", 50))
    return linearize(assemble("ladder", *bonds, inputs={E: "V"}, outputs={"u": (end.e, "V")}))


def unseen():
    """Not minimal: an angle that nothing shows, and a mass that nothing drives."""
    F = sympy.Symbol("F")
    mass = I("m", 2)
    graph = assemble(
        "unseen",
        Se("push", F) >> One("v") >> (mass, R("b", 3), C("far", stiffness=0)),
        One("alone") >> (I("other", 1), R("rub", 5)),
        inputs={F: "N"},
        outputs={"v": (mass.f, "m/s")},
    )
    return linearize(graph)


def algebraic():
    """A law that cannot be turned round leaves an algebraic variable."""
    E = sympy.Symbol("E")
    charge = C("c", 0.5)
    hard = R("hard", effort=lambda f: f**3 + f)
    graph = assemble(
        "algebraic",
        Se("E", E) >> One("i") >> (hard, charge),
        inputs={E: "V"},
        outputs={"u": (charge.e, "V"), "i": (hard.f, "A")},
    )
    return linearize(graph, at={"c.q": 0.3}, inputs={"E": 2.0})


def floating():
    """An integrator: position of a mass with a damper, and its speed."""
    F = sympy.Symbol("F")
    mass, path = I("m", 2), C("path", stiffness=0)
    graph = assemble(
        "floating",
        Se("push", F) >> One("v") >> (mass, R("b", 4), path),
        inputs={F: "N"},
        outputs={"x": (path.q, "m"), "v": (mass.f, "m/s")},
    )
    return linearize(graph)


def following():
    """A dependent storage that needs the rate of its input."""
    V = sympy.Symbol("V")
    mass, spring, lag = I("m", 2), C("k", stiffness=3), C("tank", 0.5)
    graph = assemble(
        "following",
        Sf("shake", V) >> One("v") >> (mass, spring),
        Se("again", mass.e) >> One("flow") >> (R("r", 4), lag),
        inputs={V: "m/s"},
        outputs={"force": (mass.e + spring.e, "N"), "p": (lag.e, "N")},
    )
    return linearize(graph)


SYSTEMS = {
    "driven": driven,
    "pulled": pulled,
    "unseen": unseen,
    "algebraic": algebraic,
    "quarter_car": lambda: linearize(models.quarter_car.graph()),
    "brake": lambda: (
        linearize(models.bicycle_brake.graph(), {"V0": 1.2, "mu_s": 0.5})
        .with_inputs("omega_t", "p_l")
        .with_outputs("pads.e")
    ),
}
