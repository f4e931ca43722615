"""Textbook graphs: circuits of few elements, ladders, a quarter car, a pendulum, a rubbing mass."""

import sympy
from sympy import Rational as Q

from bondgraph import TF, C, I, One, R, Se, Sf, Zero, assemble

from .case import Case, quantities

E, F, V, U = sympy.symbols("E F V U", real=True)
r, s, R3, a, b, c, d, h, k, m, n, L, g = sympy.symbols("r s R3 a b c d h k m n L g", positive=True)


def rc() -> Case:
    x, (v, dv) = quantities("v")
    graph = assemble("rc", Se("s", E) >> One("i") >> (R("r", r), C("c", c)), inputs=[E])
    return Case(graph, x, (E - v - r * c * dv,), {"c.q": c * v}, {r: 3, c: Q(1, 7)})


def parallel_rlc() -> Case:
    x, (v, i, dv, di) = quantities("v i")
    graph = assemble("rlc", Zero("u") >> (R("r", r), C("c", c), I("l", L)))
    balances = (c * dv + v / r + i, L * di - v)
    return Case(graph, x, balances, {"c.q": c * v, "l.p": L * i}, {r: 1, c: 1, L: 1})


def mass_spring_damper(backwards: bool = False) -> Case:
    x, (v, y, dv, dy) = quantities("v y")
    one, parts = One("v"), (I("m", m), C("k", c), R("b", b))
    bonds = [part >> one if backwards else one >> part for part in parts]
    graph = assemble("msd", Se("F", F) >> one, *bonds, inputs=[F])
    balances = (m * dv + b * v + y / c - F, dy - v)
    return Case(graph, x, balances, {"m.p": m * v, "k.q": y}, {m: 2, c: Q(1, 8), b: Q(1, 2)})


def arrows_backwards() -> Case:
    return mass_spring_damper(backwards=True)


def two_junctions() -> Case:
    x, (v, y, dv, dy) = quantities("v y")
    left, middle, right = One("left"), Zero("middle"), One("right")
    graph = assemble(
        "two",
        Se("s", F) >> left >> (I("i", m), middle),
        Sf("v", V) >> middle >> right >> (C("c", c), R("r", r)),
        inputs=[F, V],
    )
    balances = (m * dv - F + r * (V + v) + y / c, dy - V - v)
    return Case(graph, x, balances, {"i.p": m * v, "c.q": y}, {m: 2, c: Q(1, 5), r: Q(3, 4)})


def transformed_damper() -> Case:
    x, (v, dv) = quantities("v")
    left, right = One("left"), One("right")
    graph = assemble(
        "damper",
        Se("s", F) >> left >> (I("i", m), TF("d", d) >> right),
        right >> R("r", r),
        inputs=[F],
    )
    return Case(graph, x, (m * dv - F + r * d**2 * v,), {"i.p": m * v}, {m: 2, d: Q(1, 3), r: 5})


def wikipedia() -> Case:
    x, (i, u, di, du) = quantities("i u")
    one, zero = One("v"), Zero("u")
    graph = assemble(
        "wikipedia",
        Se("s", E) >> one >> (R("R2", r), I("I3", L)),
        one >> TF("r", n) >> zero >> (C("C6", c), R("R7", s)),
        inputs=[E],
    )
    balances = (L * di - E + r * i + n * u, c * du - n * i + u / s)
    values = {r: 2, L: Q(1, 2), n: Q(3, 10), c: Q(1, 4), s: 4}
    return Case(graph, x, balances, {"I3.p": L * i, "C6.q": c * u}, values)


def rigid_pair() -> Case:
    x, (v, dv) = quantities("v")
    one = Se("F", F) >> One("v")
    graph = assemble("pair", one >> (I("a", a), I("b", b), R("r", r)), inputs=[F])
    balances = ((a + b) * dv + r * v - F,)
    return Case(graph, x, balances, {"a.p": a * v}, {a: 2, b: 3, r: Q(1, 2)})


def gear() -> Case:
    x, (w, dw) = quantities("w")
    one, two = One("a"), One("z")
    graph = assemble(
        "gear",
        Se("s", F) >> one >> (I("i", a), R("r", r)),
        one >> TF("gear", n) >> two >> (I("j", b), R("x", s)),
        inputs=[F],
    )
    balances = ((a + n**2 * b) * dw + (r + n**2 * s) * w - F,)
    values = {a: 2, r: Q(1, 2), n: Q(1, 5), b: 3, s: Q(7, 10)}
    return Case(graph, x, balances, {"i.p": a * w}, values)


def two_capacitors() -> Case:
    x, (v, dv) = quantities("v")
    graph = assemble(
        "two", Sf("s", U) >> Zero("u") >> (C("x", a), C("y", b), R("r", r)), inputs=[U]
    )
    balances = ((a + b) * dv + v / r - U,)
    return Case(graph, x, balances, {"x.q": a * v}, {a: 2, b: 3, r: Q(1, 2)})


def resistive_loop() -> Case:
    """The node between the three resistors has a voltage without a rate."""
    x, (v, u, dv, _) = quantities("v u")
    one, zero, two = One("a"), Zero("u"), One("z")
    graph = assemble(
        "loop",
        Se("s", E) >> one >> (R("r1", r), zero),
        zero >> (R("r2", s), two),
        two >> (R("r3", R3), C("c", c)),
        inputs=[E],
    )
    balances = (R3 * c * dv - u + v, (E - u) / r - u / s - (u - v) / R3)
    values = {r: Q(3, 2), s: Q(5, 2), R3: Q(7, 2), c: Q(2, 5)}
    return Case(graph, x, balances, {"c.q": c * v}, values)


def _ladder(kind, law, cells: int):
    ahead, parts = Se("s", E), []
    for cell in range(1, cells + 1):
        one, zero = One(f"one{cell}"), Zero(f"zero{cell}")
        parts += [ahead >> one >> (kind(f"x{cell}", law), zero), zero >> C(f"c{cell}", c)]
        ahead = zero
    return assemble("ladder", *parts, inputs=[E])


def rc_ladder() -> Case:
    x, every = quantities("v1 v2 v3 v4")
    v, dv = [E, *every[:4]], every[4:]
    currents = [(v[cell] - v[cell + 1]) / r for cell in range(4)] + [0]
    balances = tuple(c * dv[cell] - currents[cell] + currents[cell + 1] for cell in range(4))
    states = {f"c{cell}.q": c * v[cell] for cell in range(1, 5)}
    return Case(_ladder(R, r, 4), x, balances, states, {r: 3, c: Q(1, 4)})


def lc_ladder() -> Case:
    x, every = quantities("v1 v2 v3 i1 i2 i3")
    v, i, dv, di = [E, *every[:3]], [*every[3:6], 0], every[6:9], every[9:]
    balances = [c * dv[cell] - i[cell] + i[cell + 1] for cell in range(3)]
    balances += [L * di[cell] - v[cell] + v[cell + 1] for cell in range(3)]
    states = {f"c{cell}.q": c * v[cell] for cell in range(1, 4)}
    states |= {f"x{cell + 1}.p": L * i[cell] for cell in range(3)}
    return Case(_ladder(I, L, 3), x, tuple(balances), states, {L: 3, c: Q(1, 4)})


def duffing() -> Case:
    """A hardening spring given by its energy; about rest, and about where V holds it."""
    x, (q, i, dq, di) = quantities("q i")
    spring = C("c", energy=lambda q: k * q**2 / 2 + h * q**4 / 4)
    graph = assemble("duffing", Sf("s", V) >> Zero("u") >> (spring, I("i", L)), inputs=[V])
    balances = (dq - V + i, L * di - k * q - h * q**3)
    states = {"c.q": q, "i.p": L * i}
    return Case(graph, x, balances, states, {k: 1, h: 1, L: 1}, ({}, {q: Q(1, 2)}))


def pendulum() -> Case:
    x, (w, q, dw, dq) = quantities("w q")
    arm, angle = One("arm"), C("angle", stiffness=0)
    graph = assemble(
        "pendulum",
        arm >> (I("bob", m * L**2), angle),
        arm >> TF("lever", L * sympy.sin(angle.q)) >> Se("weight", m * g),
    )
    balances = (m * L**2 * dw + m * g * L * sympy.sin(q), dq - w)
    states = {"bob.p": m * L**2 * w, "angle.q": q}
    return Case(graph, x, balances, states, {m: 2, L: 3, g: 10}, ({}, {q: sympy.pi}))


def mass_on_belt() -> Case:
    """Stribeck friction between a belt and a mass, about steady slip."""
    x, (v, y, dv, dy) = quantities("v y")
    belt, body = Zero("belt"), One("body")

    def force(slip):
        return 10 * (Q(1, 4) + Q(3, 20) * sympy.exp(-((10 * slip) ** 2)))

    graph = assemble(
        "belt",
        Sf("drive", U) >> belt >> (R("pad", effort=force), body),
        body >> (I("m", m), C("k", stiffness=k), R("c", b)),
        inputs=[U],
    )
    speed = Q(3, 20)
    balances = (m * dv + b * v + k * y - force(U - v), dy - v)
    rest = {U: speed, y: force(speed) / 100}
    return Case(graph, x, balances, {"m.p": m * v, "k.q": y}, {m: 1, k: 100, b: Q(1, 5)}, (rest,))


def quarter_car() -> Case:
    x, (v, w, y, z, dv, dw, dy, dz) = quantities("v w y z")
    ground, tyre, wheel, strut, body, leg = (
        *(Sf("road", V), Zero("tyre"), One("wheel")),
        *(Zero("strut"), One("body"), One("leg")),
    )
    graph = assemble(
        "car",
        ground >> tyre >> (C("ct", stiffness=k), wheel),
        wheel >> (I("mu", a), Se("gu", a * g), strut),
        strut >> (leg, body),
        leg >> (C("cs", stiffness=h), R("b", b)),
        body >> (I("ms", m), Se("gs", m * g)),
        inputs=[V],
    )
    strut_force = h * z + b * (v - w)  # v: wheel, w: body, both upwards
    balances = (
        a * dv - k * y + a * g + strut_force,
        m * dw + m * g - strut_force,
        dy - V + v,
        dz - v + w,
    )
    states = {"mu.p": a * v, "ms.p": m * w, "ct.q": y, "cs.q": z}
    values = {m: 300, a: 40, h: 20000, k: 180000, b: 1200, g: 10}
    return Case(graph, x, balances, states, values)


CASES = (
    *(rc, parallel_rlc, mass_spring_damper, arrows_backwards, two_junctions, transformed_damper),
    *(wikipedia, rigid_pair, gear, two_capacitors, resistive_loop, rc_ladder, lc_ladder),
    *(duffing, pendulum, mass_on_belt, quarter_car),
)
