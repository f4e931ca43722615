"""Eight small nominal models, with units, inputs and outputs, that effects are grown into.

Each is a function that builds a fresh graph; `MACHINES` names them. `RUNS` has a span and functions
of time for the inputs that move every state well.
"""

from __future__ import annotations

from math import cos, sin

from numpy import linspace
from sympy import Symbol, symbols

from bondgraph import GY, RS, TF, BondGraph, C, I, Integrator, One, R, Se, Sf, Zero, assemble
from bondgraph.discrepancy.candidates import Scale


def mass_spring() -> BondGraph:
    m, k, b = symbols("m k b", positive=True)
    push = Symbol("push", real=True)
    carriage, mass = One("carriage"), I("mass", m)
    spring = C("spring", stiffness=k, initial=0.01)
    return assemble(
        "mass_spring",
        Se("actuator", push) >> carriage >> (mass, spring, R("damper", b)),
        parameters={m: (2, "kg"), k: (800, "N/m"), b: (4, "N*s/m")},
        inputs={push: "N"},
        outputs={"x": (spring.q, "m"), "v": (carriage.f, "m/s")},
    )


def two_mass_chain() -> BondGraph:
    m1, m2, k1, k2, b1, b2 = symbols("m1 m2 k1 k2 b1 b2", positive=True)
    push = Symbol("push", real=True)
    first, second, link, way = One("first"), One("second"), Zero("link"), One("way")
    ground = C("ground", stiffness=k1)
    return assemble(
        "two_mass_chain",
        Se("actuator", push) >> first >> (I("mass1", m1), ground, R("damper1", b1)),
        first >> link >> second,
        link >> way >> (C("spring", stiffness=k2), R("damper2", b2)),
        second >> I("mass2", m2),
        parameters={
            m1: (1, "kg"),
            m2: (0.5, "kg"),
            k1: (400, "N/m"),
            k2: (300, "N/m"),
            b1: (2, "N*s/m"),
            b2: (1, "N*s/m"),
        },
        inputs={push: "N"},
        outputs={"v1": (first.f, "m/s"), "v2": (second.f, "m/s")},
    )


def dc_motor() -> BondGraph:
    resistance, inductance, constant = symbols("Ra La kt", positive=True)
    rotor, load, stiffness, loss, drag = symbols("Jm Jl ks bs bl", positive=True)
    voltage = Symbol("voltage", real=True)
    armature, motor, shaft, twist, wheel = (
        One("armature"),
        One("motor"),
        Zero("shaft"),
        One("twist"),
        One("wheel"),
    )
    return assemble(
        "dc_motor",
        Se("supply", voltage) >> armature >> (R("winding", resistance), I("coil", inductance)),
        armature >> GY("torque_constant", constant) >> motor >> I("rotor", rotor),
        motor >> shaft >> wheel >> (I("load", load), R("bearing", drag)),
        shaft >> twist >> (C("torsion", stiffness=stiffness), R("twist_loss", loss)),
        parameters={
            resistance: (1.2, "ohm"),
            inductance: (5, "mH"),
            constant: (0.08, "N*m/A"),
            rotor: (4e-4, "kg*m^2"),
            load: (1.5e-3, "kg*m^2"),
            stiffness: (6, "N*m/rad"),
            loss: (2e-3, "N*m*s/rad"),
            drag: (8e-4, "N*m*s/rad"),
        },
        inputs={voltage: "V"},
        outputs={"current": (armature.f, "A"), "speed": (wheel.f, "rad/s")},
    )


def quarter_car() -> BondGraph:
    ms, mu, ks, cs, kt, ct = symbols("ms mu ks cs kt ct", positive=True)
    road = Symbol("road", real=True)
    body, wheel, strut, tyre = One("body"), One("wheel"), Zero("strut"), Zero("tyre")
    suspension, tread = One("suspension"), One("tread")
    travel = C("spring", stiffness=ks)
    return assemble(
        "quarter_car",
        Sf("surface", road) >> tyre >> wheel >> (I("unsprung", mu), strut),
        tyre >> tread >> (C("air", stiffness=kt), R("carcass", ct)),
        strut >> body >> I("sprung", ms),
        strut >> suspension >> (travel, R("damper", cs)),
        parameters={
            ms: (300, "kg"),
            mu: (40, "kg"),
            ks: (18, "N/mm"),
            cs: (1200, "N*s/m"),
            kt: (180, "N/mm"),
            ct: (100, "N*s/m"),
        },
        inputs={road: "m/s"},
        outputs={"travel": (travel.q, "m"), "body_speed": (body.f, "m/s")},
    )


def two_tanks() -> BondGraph:
    c1, c2, r12, r2 = symbols("C1 C2 R12 R2", positive=True)
    inflow = Symbol("inflow", real=True)
    first, pipe, second = Zero("first"), One("pipe"), Zero("second")
    return assemble(
        "two_tanks",
        Sf("pump", inflow) >> first >> C("tank1", c1, initial=0.1),
        first >> pipe >> (R("valve", r12), second),
        second >> (C("tank2", c2, initial=0.05), R("outlet", r2)),
        parameters={
            c1: (2e-5, "m^3/Pa"),
            c2: (1e-5, "m^3/Pa"),
            r12: (4e6, "Pa*s/m^3"),
            r2: (6e6, "Pa*s/m^3"),
        },
        inputs={inflow: "m^3/s"},
        outputs={"p1": (first.e, "Pa"), "p2": (second.e, "Pa")},
    )


def hydraulic_cylinder() -> BondGraph:
    area, oil, mass, valve, drag, load = symbols("A Coil M Rv B K", positive=True)
    supply = Symbol("supply", real=True)
    line, chamber, rod = One("line"), Zero("chamber"), One("rod")
    return assemble(
        "hydraulic_cylinder",
        Se("pump", supply) >> line >> (R("valve", valve), chamber),
        chamber >> C("oil", oil),
        chamber >> TF("piston", 1 / area) >> rod,
        rod >> (I("ram", mass), R("seal", drag), C("load", stiffness=load)),
        parameters={
            area: (2e-3, "m^2"),
            oil: (2e-12, "m^3/Pa"),
            mass: (50, "kg"),
            valve: (2e9, "Pa*s/m^3"),
            drag: (400, "N*s/m"),
            load: (2e5, "N/m"),
        },
        inputs={supply: "Pa"},
        outputs={"pressure": (chamber.e, "Pa"), "speed": (rod.f, "m/s")},
    )


def thermal_brake() -> BondGraph:
    inertia, rub, heat, cooling = symbols("J br Cd Rc", positive=True)
    torque = Symbol("torque", real=True)
    wheel, disc = One("wheel"), Zero("disc")
    angle = Integrator("angle", wheel.f)
    return assemble(
        "thermal_brake",
        Se("drive", torque) >> wheel >> I("flywheel", inertia),
        wheel >> RS("pad", rub, pseudo=True) >> disc,
        disc >> (C("iron", heat), R("air", cooling)),
        angle,
        parameters={
            inertia: (0.5, "kg*m^2"),
            rub: (0.8, "N*m*s/rad"),
            heat: (150, "J/K"),
            cooling: (0.6, "K/W"),
        },
        inputs={torque: "N*m"},
        outputs={"speed": (wheel.f, "rad/s"), "temperature": (disc.e, "K")},
    )


def rlc() -> BondGraph:
    resistance, inductance, capacitance = symbols("Re Le Ce", positive=True)
    voltage = Symbol("voltage", real=True)
    loop, node = One("loop"), Zero("node")
    return assemble(
        "rlc",
        Se("generator", voltage) >> loop >> (R("resistor", resistance), I("coil", inductance)),
        loop >> node >> (C("capacitor", capacitance), R("load", 50)),
        parameters={
            resistance: (2, "ohm"),
            inductance: (10, "mH"),
            capacitance: (100, "uF"),
        },
        inputs={voltage: "V"},
        outputs={"current": (loop.f, "A"), "u": (node.e, "V")},
    )


MACHINES = {
    build.__name__: build
    for build in (
        mass_spring,
        two_mass_chain,
        dc_motor,
        quarter_car,
        two_tanks,
        hydraulic_cylinder,
        thermal_brake,
        rlc,
    )
}
RUNS = {
    "mass_spring": (1.0, {"push": lambda t: 8 * sin(9 * t)}),
    "two_mass_chain": (1.0, {"push": lambda t: 8 * sin(9 * t)}),
    "dc_motor": (0.3, {"voltage": lambda t: 12 * sin(25 * t)}),
    "quarter_car": (1.0, {"road": lambda t: 0.3 * sin(8 * t)}),
    "two_tanks": (120.0, {"inflow": lambda t: 2e-4 * (1 + cos(0.1 * t))}),
    "hydraulic_cylinder": (0.5, {"supply": lambda t: 2e6 * sin(12 * t)}),
    "thermal_brake": (4.0, {"torque": lambda t: 10 * sin(3 * t)}),
    "rlc": (0.03, {"voltage": lambda t: 10 * sin(700 * t)}),
}
# How large effort, flow and displacement are, by domain; a run's span is the duration.
_BODY = {"translation": (8.0, 0.3, 0.02)}
SIZES = {
    "mass_spring": _BODY,
    "two_mass_chain": _BODY,
    "dc_motor": {"electrical": (12.0, 5.0, 0.1), "rotation": (0.5, 30.0, 1.0)},
    "quarter_car": {"translation": (1000.0, 0.3, 0.03)},
    "two_tanks": {"hydraulic": (5000.0, 2e-4, 0.1)},
    "hydraulic_cylinder": {"hydraulic": (2e6, 4e-4, 2e-5), "translation": (4000.0, 0.2, 0.02)},
    "thermal_brake": {"rotation": (10.0, 5.0, 3.0), "thermal": (0.4, 20.0, 60.0)},
    "rlc": {"electrical": (10.0, 1.0, 1e-3)},
}


def scale_at(machine: str, domain: str) -> Scale:
    sizes = SIZES[machine]
    return Scale(*sizes.get(domain, next(iter(sizes.values()))), duration=RUNS[machine][0])


def samples(machine: str) -> dict:
    """Inputs as tables, as recordings give them."""
    span, inputs = RUNS[machine]
    times = linspace(0, span, 101)
    return {name: (times, [function(t) for t in times]) for name, function in inputs.items()}
