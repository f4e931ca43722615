"""Parts and bonds thrown together with little care: what a careless author may write.

Mostly well formed, so that what is wrong shows late; now and then malformed.
"""

from __future__ import annotations

import random
from typing import Any

import sympy

import bondgraph as bg
from bondgraph.elements import Element, Field, Junction, SignalBlock, TwoPort

INPUT = sympy.Symbol("u")


def kinds(rng: random.Random) -> list[Any]:
    """Makers of all elements, some of them with laws that ask for trouble."""
    resists = rng.choice(
        [
            lambda f: f**3,
            sympy.sin,
            lambda f: sympy.Integer(3),
            lambda f: sympy.Abs(f) * f,
            sympy.sqrt,
            lambda e: 1 / e,
            lambda e: e**2,
            sympy.exp,
        ]
    )
    number = rng.choice([0, 1, 2, -1, INPUT])
    matrix = rng.choice([[[2, 1], [1, 2]], [[1, 1], [1, 1]], [[0, 1], [1, 0]], [[0, 0], [0, 0]]])
    return [
        bg.Zero,
        bg.One,
        lambda name: bg.Zero(name, pseudo=rng.random() < 0.1),
        lambda name: bg.R(name, rng.choice([1, 2, 0, -1])),
        lambda name: bg.R(name, effort=resists),
        lambda name: bg.R(name, flow=resists),
        lambda name: bg.C(name, 2),
        lambda name: bg.C(name, stiffness=0),
        lambda name: bg.C(name, effort=resists),
        lambda name: bg.I(name, 3),
        lambda name: bg.I(name, energy=sympy.cosh),
        lambda name: bg.Se(name, number),
        lambda name: bg.Sf(name, number),
        lambda name: bg.TF(name, rng.choice([2, -1, INPUT])),
        lambda name: bg.GY(name, rng.choice([2, -1, INPUT])),
        bg.De,
        bg.Df,
        bg.Diode,
        lambda name: bg.CheckValve(name, drop=1, resistance=2),
        lambda name: bg.Switch(name, closed=bg.TIME - 1),
        lambda name: bg.Friction(name, kinetic=lambda speed: 1 + speed),
        lambda name: bg.Clutch(name, INPUT),
        lambda name: bg.EndStop(name, gap=1, restitution=0),
        lambda name: bg.CField(name, ("a", "b"), stiffness=matrix),
        lambda name: bg.RField(name, ("a", "b"), conductance=matrix),
        lambda name: bg.IField(name, ("a", "b"), energy=lambda p, q: p**2 * (1 + q**2)),
        lambda name: bg.RS(name, 3),
        lambda name: bg.RS(name, effort=resists, pseudo=True),
    ]


def modulated(rng: random.Random, name: str, heard: Any) -> Any:
    """Make an element that hears a variable of another."""
    return rng.choice(
        [
            lambda: bg.Se(name, heard),
            lambda: bg.Sf(name, heard**2),
            lambda: bg.TF(name, heard),
            lambda: bg.GY(name, 1 + heard**2),
            lambda: bg.R(name, effort=lambda f: heard * f),
            lambda: bg.C(name, effort=lambda q: q * heard),
            lambda: bg.Block(name, rate=lambda y: heard - y),
            lambda: bg.Integrator(name, heard),
            lambda: bg.Lag(name, heard, rng.choice([1, 2])),
        ]
    )()


def ends(rng: random.Random) -> list[Any]:
    """Draw elements, ports of fields and RS, to be bonded."""
    names = [
        f"e{rng.randrange(4)}" if rng.random() < 0.02 else f"e{index}_{rng.randrange(99)}"
        for index in range(rng.randint(1, 9))
    ]
    found: list[Any] = []
    for name in names:
        made = rng.choice(kinds(rng))(name)
        found += made.ports.values() if isinstance(made, Field) else [made]
    sounding = [end for end in found if isinstance(end, Element) and end.symbols]
    for index in range(rng.choice((0, 0, 1, 2)) if sounding else 0):
        heard = rng.choice(list(rng.choice(sounding).symbols.values()))
        found.append(modulated(rng, f"m{index}", heard))
    return found


def parts(rng: random.Random) -> list[Any]:
    """Draw what is handed to `assemble`: bonds, and elements without."""
    found, slip = ends(rng), rng.choice((0.0, 0.0, 0.0, 0.05, 0.3))
    junctions = [end for end in found if isinstance(end, Junction)]
    if not junctions or rng.random() < 0.7:
        junctions.append(rng.choice((bg.Zero, bg.One))("j"))
        found.append(junctions[-1])
    bonds = []
    for end in found:
        if isinstance(end, bg.RS):
            bonds += [rng.choice(junctions) >> end, end >> rng.choice(junctions)]
            continue
        if isinstance(end, SignalBlock) and rng.random() >= slip:
            continue
        count = 2 if isinstance(end, TwoPort | Junction) else 1
        count += rng.choice((-1, 1)) if rng.random() < slip else 0
        for _ in range(count):
            others = found if rng.random() < slip else [j for j in junctions if j is not end]
            if not others:
                continue
            other = rng.choice(others)
            bonds.append(end >> other if rng.random() < 0.5 else other >> end)
    loose = [end for end in found if isinstance(end, Element) and rng.random() < 0.3]
    return bonds + loose or found[-1:]
