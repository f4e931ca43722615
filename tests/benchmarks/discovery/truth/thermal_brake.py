"""A flywheel that a pad brakes; what it loses heats the disc. The pad may fade."""

from __future__ import annotations

from collections.abc import Mapping
from math import exp

from .ode import NOTHING, Inner, Loads, Ode, State


def build(p: Mapping[str, float], inner: Inner = NOTHING) -> Ode:
    inertia, rub, capacity, cooling = p["J"], p["br"], p["Cd"], p["Rc"]
    c = inner.values
    fades = inner.effect == "thermal_fade"

    def rates(s: State, torque: float, load: Loads) -> State:
        w, heat = s[:2]
        braking = rub * w * (exp(-c["fade"] * s[2]) if fades else 1.0)
        out = [
            (torque - braking - load.get("wheel", 0.0)) / inertia,
            braking * w - heat / capacity / cooling - load.get("disc", 0.0),
        ]
        return [*out, braking * w - c["cooling"] * s[2]] if fades else out

    return Ode(
        start=[0.0] * (3 if fades else 2),
        rates=rates,
        flows={"wheel": lambda s: s[0], "disc": lambda s: s[1] / capacity},
        outputs=lambda s, torque: (s[0], s[1] / capacity),
        names=("speed", "temperature"),
        pace=3 * rub / inertia,
    )
