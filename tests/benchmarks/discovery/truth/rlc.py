"""A coil and a capacitor with a load; the coil's iron may saturate, or the coil be unknown."""

from __future__ import annotations

from collections.abc import Mapping

from .ode import NOTHING, Inner, Loads, Ode, State


def build(p: Mapping[str, float], inner: Inner = NOTHING) -> Ode:
    resistance, capacity, load_resistance = p["Re"], p["Ce"], p.get("Rload", 50.0)
    inductance = inner.values.get("inertance", p.get("Le", 0.0))
    cubic = inner.values.get("cubic", 0.0)

    def current(linked: float) -> float:
        return linked / inductance + cubic * linked**3

    def coiled(s: State, voltage: float, load: Loads) -> State:
        linked, charge = s
        i, u = current(linked), charge / capacity
        return [
            voltage - resistance * i - u - load.get("loop", 0.0),
            i - u / load_resistance - load.get("node", 0.0),
        ]

    def plain(s: State, voltage: float, load: Loads) -> State:
        u = s[0] / capacity
        return [(voltage - u) / resistance - u / load_resistance - load.get("node", 0.0)]

    if not inductance:
        return Ode(
            start=[0.0],
            rates=plain,
            flows={"node": lambda s: s[0] / capacity},
            outputs=lambda s, voltage: ((voltage - s[0] / capacity) / resistance, s[0] / capacity),
            names=("current", "u"),
            pace=2 / (resistance * capacity),
        )
    return Ode(
        start=[0.0, 0.0],
        rates=coiled,
        flows={"loop": lambda s: current(s[0]), "node": lambda s: s[1] / capacity},
        outputs=lambda s, voltage: (current(s[0]), s[1] / capacity),
        names=("current", "u"),
        pace=3 / (inductance * capacity) ** 0.5,
    )
