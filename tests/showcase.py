"""One small graph for each kind of element beside the textbook's nine."""

from __future__ import annotations

import random

import sympy

from bondgraph import (
    RS,
    TIME,
    Block,
    C,
    CField,
    CheckValve,
    Clutch,
    De,
    Df,
    Diode,
    EndStop,
    Friction,
    I,
    ICField,
    IField,
    Integrator,
    Lag,
    One,
    R,
    RField,
    Se,
    Sf,
    Switch,
    Zero,
    assemble,
)


def cfield():
    beam = CField("beam", ("tip", "middle"), stiffness=[[2, -5], [-5, 16]])
    a, b = One("a"), One("b")
    driven = Se("F", 1) >> a >> (I("m", 1), beam["tip"])
    return assemble("cfield", driven, b >> (I("n", 1), R("r", 1), beam["middle"]))


def three_ports():
    frame = CField("frame", "abc", stiffness=[[3, 1, 0], [1, 3, 1], [0, 1, 3]])
    speeds = [One(f"v{number}") for number in range(3)]
    parts = [v >> (I(f"m{k}", 1), frame["abc"[k]]) for k, v in enumerate(speeds)]
    return assemble("three_ports", Se("F", 1) >> speeds[0], speeds[1] >> R("r", 1), parts)


def ifield():
    coils = IField("coils", ("primary", "secondary"), inertance=[[2, 1], [1, 2]])
    a, b = One("a"), One("b")
    first = Se("E", 1) >> a >> (R("r", 1), coils["primary"])
    return assemble("ifield", first, b >> (R("load", 2), coils["secondary"]))


def icfield():
    solenoid = ICField("solenoid", {"coil": "I", "gap": "C"}, energy=lambda p, x: p**2 * (1 + x))
    a, b = One("a"), One("b")
    electric = Se("E", 1) >> a >> (R("r", 1), solenoid["coil"])
    return assemble("icfield", electric, b >> (I("m", 1), C("k", 1), solenoid["gap"]))


def rfield():
    wall = RField("wall", ("hot", "cold"), flow=lambda t, u: (3 * (t - u) / t, 3 * (u - t) / u))
    hot, cold = Zero("inside"), Zero("outside")
    heated = Sf("heater", 1) >> hot >> (C("air", 5, initial=300), wall["hot"])
    return assemble("rfield", heated, cold >> (C("ground", 8, initial=300), wall["cold"]))


def warm():
    v, rotor = One("v"), Zero("rotor")
    rub = RS("pad", 20, pseudo=True)
    heated = v >> rub >> rotor >> (C("heat", 500), R("air", 2))
    return assemble("warm", Se("F", 1) >> v >> I("m", 2), heated)


def warm_friction():
    v, rotor = One("v"), Zero("rotor")
    rub = RS(Friction("pad", kinetic=lambda speed: 8), pseudo=True)
    return assemble("warm", Se("F", 9) >> v >> I("m", 2), v >> rub >> rotor >> C("heat", 500))


def sensed():
    v, node = One("v"), Zero("node")
    parts = Se("F", 1) >> v >> (I("m", 2), Df("tacho"), R("b", 1)), v >> node
    return assemble("sensed", parts, node >> (C("k", 1), De("gauge")))


def controlled():
    tank = Zero("tank")
    gauge = Lag("gauge", tank.e, 0.5)
    error = Integrator("error", 3 - gauge.y)
    gate = Block("gate", rate=lambda y: error.y - y**3)
    flow = Sf("pump", 2 * (3 - gauge.y) + gate.y)
    return assemble(
        "controlled", flow >> tank >> (C("water", 4), R("valve", 2)), gauge, error, gate
    )


def choke():
    loop = One("loop")
    source = Se("E", sympy.sin(TIME))
    return assemble("choke", source >> loop >> (Diode("d"), I("coil", 2), R("r", 3)))


def rectifier():
    loop, out = One("loop"), Zero("out")
    source = Se("E", sympy.sin(TIME)) >> loop >> (Diode("d", drop=0.6), R("r", 3))
    relay = Switch("relay", closed=TIME - 1)
    return assemble("rectifier", source, loop >> out >> (C("c", 1), R("load", 5), relay))


def ball():
    v, height = One("v"), C("height", stiffness=0, initial=1)
    floor = EndStop("floor", gap=height.q, restitution=0.8)
    return assemble("ball", Se("g", -9.81) >> v >> (I("m", 2), height, floor))


def clutch():
    a, b, slip, pressure = One("a"), One("b"), Zero("slip"), sympy.Symbol("pressure")
    shafts = a >> (I("j1", 1), R("b1", 1)), b >> (I("j2", 2), R("b2", 1))
    plates = slip >> Clutch("plates", 12 * pressure)
    return assemble("clutch", Se("engine", 10) >> a >> slip >> b, shafts, plates, inputs=[pressure])


def pump():
    chamber = Zero("chamber")
    outlet = CheckValve("outlet", resistance=2)
    return assemble("pump", Sf("piston", sympy.sin(TIME)) >> chamber >> (C("oil", 1), outlet))


GRAPHS = {
    graph.__name__: graph
    for graph in (
        cfield,
        three_ports,
        ifield,
        icfield,
        rfield,
        warm,
        warm_friction,
        sensed,
        controlled,
        choke,
        rectifier,
        ball,
        clutch,
        pump,
    )
}


def mixture(seed):
    """Draw a tree of junctions with elements of all kinds hanging on it, a field and a lag."""
    draw = random.Random(seed)
    nodes = [draw.choice([One, Zero])(f"j{k}") for k in range(draw.randint(3, 6))]
    parts = [nodes[draw.randrange(k)] >> node for k, node in enumerate(nodes) if k]
    for place, node in enumerate(nodes):
        for number in range(draw.randint(1, 3)):
            parts.append(_hung(draw, node, f"{place}_{number}"))
    field = CField("field", "abc", stiffness=[[3, 1, 0], [1, 3, 1], [0, 1, 3]])
    if draw.random() < 0.5:
        field = IField("field", ("primary", "secondary"), inertance=[[2, 1], [1, 2]])
    parts += [draw.choice(nodes) >> port for port in field.ports.values()]
    shared = nodes[0].e if isinstance(nodes[0], Zero) else nodes[0].f
    lag = Lag("lag", shared, 2)
    return assemble("mixture", parts, lag, nodes[0] >> R("heard", 1 + lag.y**2))


def _hung(draw, node, number):
    """Bond one element, drawn at random, to a junction."""
    if draw.random() < 0.1:
        warm = Zero(f"temperature{number}")
        return node >> RS(f"rub{number}", 3) >> warm >> C(f"heat{number}", 4, initial=300)
    sensor = De if isinstance(node, Zero) else Df
    kinds = [
        lambda: R(f"r{number}", 2),
        lambda: C(f"c{number}", 3),
        lambda: I(f"i{number}", 2),
        lambda: Se(f"e{number}", 1),
        lambda: Sf(f"f{number}", 1),
        lambda: Diode(f"diode{number}"),
        lambda: Switch(f"switch{number}", closed=TIME - 1),
        lambda: Friction(f"friction{number}", kinetic=lambda speed: 3),
        lambda: CheckValve(f"valve{number}", resistance=2),
        lambda: sensor(f"sensor{number}"),
    ]
    element = draw.choice(kinds)()
    return element >> node if isinstance(element, Se | Sf) else node >> element
