"""A pump moves a ram against a spring through a line, which may have inertia or turbulence."""

from __future__ import annotations

from collections.abc import Mapping
from math import copysign, sqrt

from .ode import NOTHING, Inner, Loads, Ode, State


def build(p: Mapping[str, float], inner: Inner = NOTHING) -> Ode:
    area, oil, mass, valve, seal, spring = (p[name] for name in ("A", "Coil", "M", "Rv", "B", "K"))
    inertance = inner.values.get("inertance", 0.0)
    drag = inner.values.get("drag", 0.0)

    def through(pressure: float) -> float:
        if not drag:
            return pressure / valve
        root = sqrt(valve**2 + 4 * drag * abs(pressure))
        return copysign(2 * abs(pressure) / (valve + root), pressure)

    def rates(s: State, supply: float, load: Loads) -> State:
        stored, x, v = s[:3]
        pressure = stored / oil
        flow = s[3] if inertance else through(supply - pressure)
        force = area * pressure - seal * v - spring * x - load.get("rod", 0.0)
        out = [flow - area * v - load.get("chamber", 0.0), v, force / mass]
        return [*out, (supply - pressure - valve * flow) / inertance] if inertance else out

    pace = max(1 / (valve * oil), 1.5 * area / (oil * mass) ** 0.5)
    if inertance:
        pace = max(pace, valve / inertance, 1.5 / (inertance * oil) ** 0.5)
    return Ode(
        start=[0.0] * (4 if inertance else 3),
        rates=rates,
        flows={"chamber": lambda s: s[0] / oil, "rod": lambda s: s[2]},
        outputs=lambda s, supply: (s[0] / oil, s[2]),
        names=("pressure", "speed"),
        pace=pace,
    )
