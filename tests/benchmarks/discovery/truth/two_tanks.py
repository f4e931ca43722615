"""Two tanks joined by a pipe, whose flow may be partly turbulent."""

from __future__ import annotations

from collections.abc import Mapping
from math import copysign, sqrt

from .ode import NOTHING, Inner, Loads, Ode, State


def build(p: Mapping[str, float], inner: Inner = NOTHING) -> Ode:
    c1, c2, r12, r2 = p["C1"], p["C2"], p["R12"], p["R2"]
    drag = inner.values.get("drag", 0.0)

    def through(pressure: float) -> float:
        """Return the flow of which ``r12 f + drag f |f|`` is the pressure."""
        if not drag:
            return pressure / r12
        root = sqrt(r12**2 + 4 * drag * abs(pressure))
        return copysign(2 * abs(pressure) / (r12 + root), pressure)

    def rates(s: State, inflow: float, load: Loads) -> State:
        p1, p2 = s[0] / c1, s[1] / c2
        flow = through(p1 - p2)
        inside = load.get("between first and second", 0.0)
        return [
            inflow - flow - inside - load.get("first", 0.0),
            flow + inside - p2 / r2 - load.get("second", 0.0),
        ]

    return Ode(
        start=[0.1, 0.05],
        rates=rates,
        flows={
            "first": lambda s: s[0] / c1,
            "second": lambda s: s[1] / c2,
            "between first and second": lambda s: s[0] / c1 - s[1] / c2,
        },
        outputs=lambda s, inflow: (s[0] / c1, s[1] / c2),
        names=("p1", "p2"),
        pace=4 / min(c1 * r12, c2 * r12, c2 * r2),
    )
