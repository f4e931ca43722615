"""Real balls dropped from a bridge.

See `tests/discrepancy/data/README.md` for where they are from, their licence and their paper.
"""

from __future__ import annotations

from pathlib import Path

import sympy

from bondgraph import BondGraph, I, Integrator, One, Se, assemble
from bondgraph.discrepancy.measurement import Measurement, read_all

from .value import Expected, one_of

DATA = Path(__file__).parents[2] / "data" / "ball_drops.csv"
HEAVY = ("Baseball", "Bowling_Ball", "Golf_Ball")
LIGHT = ("Orange_Whiffle_Ball", "Whiffle_Ball_1", "Whiffle_Ball_2", "Yellow_Whiffle_Ball")
MIDDLE = ("Blue_Basketball", "Green_Basketball", "Tennis_Ball", "Volleyball")
HELD = 0.35  # s, by which every ball has left the hand

_DRAG = one_of(("viscous_damping", "fall"), ("quadratic_drag", "fall"))
EXPECTED = Expected(
    ("named", "ambiguous"),
    (_DRAG,),
    words="air: drag in proportion to speed fits better than to its square (`reference.falls`)",
)
EXPECTED_MIDDLE = Expected(
    ("named", "ambiguous", "unnamed"),
    (_DRAG | one_of(("effort_bias", "fall")),),
    words="a constant force, that is a wrong scale of heights, does as well as drag",
)
EXPECTED_HEAVY = Expected(("none", "ambiguous"))


def expected(ball: str) -> Expected:
    """What an honest answer says of a ball."""
    return {**dict.fromkeys(HEAVY, EXPECTED_HEAVY), **dict.fromkeys(LIGHT, EXPECTED)}.get(
        ball, EXPECTED_MIDDLE
    )


def graph() -> BondGraph:
    """A ball of unit mass under gravity, no air; forces are per mass."""
    g = sympy.Symbol("g", positive=True)
    fall = One("fall")
    height = Integrator("height", fall.f)
    return assemble(
        "ball",
        Se("weight", -g) >> fall >> I("ball", 1),
        height,
        parameters={g: (9.8, "N")},
        outputs={"height": (height.y, "m")},
    )


def recordings(
    ball: str, held_out: int = 2, start: float = HELD
) -> tuple[list[Measurement], list[Measurement]]:
    """One drop of a ball to learn from and one held out, from ``start`` on; starts unknown.

    The first rows show a ball that is still in the hand.
    """
    drops = read_all(
        DATA,
        segment=("ball", "drop"),
        time="t_s",
        rename={"height": "height_m"},
        units={"height": "m"},
    )
    own = [drop for drop in drops if f":{ball}" in drop.name]
    late = [drop.between(start, float(drop.t[-1])) for drop in own]
    return (
        [drop for i, drop in enumerate(late, 1) if i != held_out],
        [drop for i, drop in enumerate(late, 1) if i == held_out],
    )
