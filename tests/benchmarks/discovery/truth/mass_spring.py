"""A mass on a spring and a damper, pushed; the damper may sit in a bushing, or fade."""

from __future__ import annotations

from collections.abc import Mapping
from math import exp

from .ode import NOTHING, Inner, Loads, Ode, State


def build(p: Mapping[str, float], inner: Inner = NOTHING) -> Ode:
    m, k, b = p["m"], p["k"], p["b"]
    c = inner.values

    def plain(s: State, push: float, load: Loads) -> State:
        x, v = s
        return [v, (push - k * x - b * v - load.get("carriage", 0.0)) / m]

    def bushed(s: State, push: float, load: Loads) -> State:
        """Let z be how far the bushing before the damper is bent."""
        x, v, z = s
        bent = (b * v - c["stiffness"] * z) / (b + c["damping"])
        force = k * x + b * (v - bent)
        return [v, (push - force - load.get("carriage", 0.0)) / m, bent]

    def fading(s: State, push: float, load: Loads) -> State:
        x, v, heat = s
        force = b * exp(-c["fade"] * heat) * v
        made = force * v - c["cooling"] * heat
        return [v, (push - k * x - force - load.get("carriage", 0.0)) / m, made]

    rates = {"": plain, "compliant_coupling": bushed, "thermal_fade": fading}[inner.effect]
    pace = 2 * (k / m) ** 0.5
    if inner.effect == "compliant_coupling":
        pace = max(pace, c["stiffness"] / (b + c["damping"]))
    return Ode(
        start=[0.01, 0.0] + [0.0] * bool(inner.effect),
        rates=rates,
        flows={"carriage": lambda s: s[1]},
        outputs=lambda s, push: (s[0], s[1]),
        names=("x", "v"),
        pace=pace,
        ways={"carriage": 0.01},
    )
