"""Motors, gears, a rack, a differential, a ram, a crane: from mechanics by hand."""

import sympy
from sympy import Rational as Q

from bondgraph import GY, TF, C, I, One, R, Se, Sf, Zero, assemble

from .case import Case, quantities

U, F, T = sympy.symbols("U F T", real=True)
L, r, k, J, b, n, h, G, c, m, a, g, M = sympy.symbols("L r k J b n h G c m a g M", positive=True)


def _motor():
    circuit, rotor = One("circuit"), One("rotor")
    bonds = (
        Se("supply", U) >> circuit >> (I("coil", L), R("winding", r), GY("motor", k) >> rotor),
        rotor >> (I("J", J), R("bearing", b)),
    )
    return rotor, bonds


MOTOR = {L: Q(1, 100), r: 2, k: Q(3, 10), J: Q(1, 500), b: Q(1, 1000), n: Q(1, 5)}


def motor_gear_and_shaft() -> Case:
    """The gear's output turns at n times the rotor; the shaft twists between it and the load."""
    x, (i, w, y, v, di, dw, dy, dv) = quantities("i w y v")
    rotor, bonds = _motor()
    shaft, load = Zero("shaft"), One("load")
    graph = assemble(
        "servo",
        *bonds,
        rotor >> TF("gear", n) >> shaft >> (C("twist", stiffness=h), load),
        load >> (I("G", G), R("brush", c)),
        inputs=[U],
    )
    balances = (
        L * di + r * i + k * w - U,
        J * dw + b * w - k * i + n * h * y,
        dy - n * w + v,
        G * dv + c * v - h * y,
    )
    states = {"coil.p": L * i, "J.p": J * w, "twist.q": y, "G.p": G * v}
    return Case(graph, x, balances, states, MOTOR | {h: 40, G: Q(1, 20), c: Q(1, 30)})


def motor_and_rigid_gear() -> Case:
    """On a rigid shaft the load's inertia follows the rotor's."""
    x, (i, w, di, dw) = quantities("i w")
    rotor, bonds = _motor()
    graph = assemble(
        "servo",
        *bonds,
        rotor >> TF("gear", n) >> One("load") >> (I("G", G), R("brush", c)),
        inputs=[U],
    )
    balances = (L * di + r * i + k * w - U, (J + n**2 * G) * dw + (b + n**2 * c) * w - k * i)
    states = {"coil.p": L * i, "J.p": J * w}
    return Case(graph, x, balances, states, MOTOR | {G: Q(1, 20), c: Q(1, 30)})


def capacitor_behind_a_gyrator() -> Case:
    """A capacitor across a motor's far side is an inertia to the near one: ``L + k^2 c``."""
    x, (i, di) = quantities("i")
    near, far = One("near"), Zero("far")
    graph = assemble(
        "gyrated",
        Se("s", U) >> near >> (I("L", L), R("r", r), GY("gy", k) >> far),
        far >> (C("c", c), R("leak", b)),
        inputs=[U],
    )
    balances = ((L + k**2 * c) * di + (r + k**2 / b) * i - U,)
    return Case(graph, x, balances, {"L.p": L * i}, {L: 2, k: 3, c: Q(1, 4), r: Q(1, 2), b: 5})


def inertia_behind_a_gyrator() -> Case:
    """The dual: an inertia is a capacitance ``J / k^2``."""
    x, (u, du) = quantities("u")
    near, far = Zero("near"), One("far")
    graph = assemble(
        "gyrated",
        Sf("s", U) >> near >> (C("c", c), R("r", r), GY("gy", k) >> far),
        far >> (I("J", J), R("b", b)),
        inputs=[U],
    )
    # u = k w and the torque k i: i = (J du/k + b u/k)/k
    balances = ((c + J / k**2) * du + (1 / r + b / k**2) * u - U,)
    return Case(graph, x, balances, {"c.q": c * u}, {c: Q(1, 4), r: 2, k: 3, J: 5, b: 7})


def motor_and_generator() -> Case:
    """Two gyrators in a row are a gear: the second rotor's speed is k/h of the first's."""
    x, (w, dw) = quantities("w")
    first, wire, second = One("first"), Zero("wire"), One("second")
    graph = assemble(
        "ward",
        Se("torque", T) >> first >> (I("J", J), R("b", b), GY("generator", k) >> wire),
        wire >> GY("motor", h) >> second >> (I("G", G), R("c", c)),
        inputs=[T],
    )
    balances = ((J + (k / h) ** 2 * G) * dw + (b + (k / h) ** 2 * c) * w - T,)
    values = {J: 2, k: 3, h: 4, G: 5, b: Q(1, 2), c: Q(1, 3)}
    return Case(graph, x, balances, {"J.p": J * w}, values)


def rack_and_pinion() -> Case:
    """A pinion of radius r drives a rack of mass m against a spring."""
    x, (w, y, dw, dy) = quantities("w y")
    pinion, rack = One("pinion"), One("rack")
    graph = assemble(
        "rack",
        Se("torque", T) >> pinion >> (I("J", J), R("bearing", b), TF("radius", r) >> rack),
        rack >> (I("m", m), C("k", stiffness=k), R("slide", c)),
        inputs=[T],
    )
    balances = ((J + m * r**2) * dw + (b + c * r**2) * w + r * k * y - T, dy - r * w)
    values = {J: Q(1, 10), m: 2, r: Q(1, 20), k: 3000, b: Q(1, 50), c: 8}
    return Case(graph, x, balances, {"J.p": J * w, "k.q": y}, values)


def differential() -> Case:
    """Both axles carry one torque, and their speeds add up to twice the cage's."""
    x, (v, w, dv, dw) = quantities("v w")  # cage, left axle; the right one turns at 2 v - w
    cage, split, left, right = One("cage"), Zero("split"), One("left"), One("right")
    graph = assemble(
        "differential",
        Se("torque", T) >> cage >> (I("J", J), TF("halves", 2) >> split),
        split >> (left, right),
        left >> (I("G", G), R("b", b)),
        right >> (I("M", M), R("c", c)),
        inputs=[T],
    )
    torque = G * dw + b * w
    balances = (J * dv + 2 * torque - T, torque - M * (2 * dv - dw) - c * (2 * v - w))
    values = {J: 3, G: 2, M: 5, b: Q(1, 2), c: Q(7, 3)}
    return Case(graph, x, balances, {"J.p": J * v, "G.p": G * w}, values)


def _ram(leak):
    chamber, rod = Zero("chamber"), One("rod")
    return assemble(
        "ram",
        Sf("pump", U) >> chamber >> (C("fluid", c), leak, TF("area", 1 / a) >> rod),
        rod >> (I("m", m), R("seal", b), C("load", stiffness=k)),
        inputs=[U],
    )


RAM = {c: Q(1, 10**4), a: Q(1, 50), m: 4, b: 3, k: 50}
RAM_X, (p, v, y, dp, dv, dy) = quantities("p v y")
RAM_STATES = {"fluid.q": c * p, "m.p": m * v, "load.q": y}


def hydraulic_ram() -> Case:
    """Pressure on area a pushes; the fluid is compressible and the piston leaks."""
    balances = (c * dp - U + p / r + a * v, m * dv - a * p + b * v + k * y, dy - v)
    return Case(_ram(R("leak", r)), RAM_X, balances, RAM_STATES, RAM | {r: 9000})


def hydraulic_ram_with_an_orifice() -> Case:
    """Leakage as the root of the pressure, about the pressure of 4 that the pump keeps up."""
    leak = R("leak", flow=lambda e: n * sympy.sqrt(e))
    balances = (c * dp - U + n * sympy.sqrt(p) + a * v, m * dv - a * p + b * v + k * y, dy - v)
    rest = {p: sympy.Integer(4), y: 4 * a / k, U: 2 * n}
    rest = {
        symbol: sympy.sympify(value).subs(RAM | {n: Q(1, 300)}) for symbol, value in rest.items()
    }
    return Case(_ram(leak), RAM_X, balances, RAM_STATES, RAM | {n: Q(1, 300)}, (rest,))


def cart_pendulum() -> Case:
    """About both of its rests: hanging and upright."""
    x, (v, w, y, q, dv, dw, dy, dq) = quantities("v w y q")
    cart, arm, across, upwards, sway = (
        *(One("cart"), One("arm"), One("across")),
        *(One("upwards"), Zero("sway")),
    )
    angle = C("angle", stiffness=0)
    cos, sin = sympy.cos, sympy.sin
    graph = assemble(
        "crane",
        Se("push", F) >> cart >> (I("M", M), C("rail", stiffness=k), R("wheels", b), sway),
        arm >> (I("J", J), R("hinge", c), angle),
        arm >> TF("cos", h * cos(angle.q)) >> sway >> across >> I("mx", m),
        arm >> TF("sin", h * sin(angle.q)) >> upwards >> (I("my", m), Se("weight", m * g)),
        inputs=[F],
    )
    swing = m * h * cos(q)
    balances = (
        (M + m) * dv + swing * dw - m * h * sin(q) * w**2 + b * v + k * y - F,
        (J + m * h**2) * dw + swing * dv + m * g * h * sin(q) + c * w,
        dy - v,
        dq - w,
    )
    states = {"M.p": M * v, "J.p": J * w, "rail.q": y, "angle.q": q}
    values = {
        M: 2,
        m: Q(1, 2),
        h: Q(3, 4),
        J: Q(1, 30),
        k: 20,
        b: Q(1, 2),
        c: Q(1, 25),
        g: Q(981, 100),
    }
    return Case(graph, x, balances, states, values, ({}, {q: sympy.pi}))


CASES = (
    *(motor_gear_and_shaft, motor_and_rigid_gear, capacitor_behind_a_gyrator),
    *(inertia_behind_a_gyrator, motor_and_generator, rack_and_pinion, differential),
    *(hydraulic_ram, hydraulic_ram_with_an_orifice, cart_pendulum),
)
