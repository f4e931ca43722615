"""A motor that turns a wheel through a shaft; the iron of its coil may saturate."""

from __future__ import annotations

from collections.abc import Mapping

from .ode import NOTHING, Inner, Loads, Ode, State


def build(p: Mapping[str, float], inner: Inner = NOTHING) -> Ode:
    resistance, inductance, constant = p["Ra"], p["La"], p["kt"]
    rotor, wheel, stiffness, loss, drag = p["Jm"], p["Jl"], p["ks"], p["bs"], p["bl"]
    cubic = inner.values.get("cubic", 0.0)

    def current(linked: float) -> float:
        return linked / inductance + cubic * linked**3

    def rates(s: State, voltage: float, load: Loads) -> State:
        linked, w1, w2, twist = s
        i = current(linked)
        inside = load.get("twist", 0.0)
        torque = stiffness * twist + loss * (w1 - w2) + inside
        return [
            voltage - resistance * i - constant * w1 - load.get("armature", 0.0),
            (constant * i - torque - load.get("motor", 0.0)) / rotor,
            (torque - drag * w2 - load.get("wheel", 0.0)) / wheel,
            w1 - w2,
        ]

    return Ode(
        start=[0.0] * 4,
        rates=rates,
        flows={
            "armature": lambda s: current(s[0]),
            "motor": lambda s: s[1],
            "wheel": lambda s: s[2],
            "twist": lambda s: s[1] - s[2],
        },
        outputs=lambda s, voltage: (current(s[0]), s[2]),
        names=("current", "speed"),
        pace=1.5 * max(resistance / inductance, (stiffness / rotor + stiffness / wheel) ** 0.5),
    )
