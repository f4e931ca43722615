"""A body on a strut on a wheel on a tyre; the damper may be bushed or fade, an inerter be there."""

from __future__ import annotations

from collections.abc import Mapping
from math import exp

from .ode import NOTHING, Inner, Loads, Ode, State


def build(p: Mapping[str, float], inner: Inner = NOTHING) -> Ode:
    ms, mu, ks, cs, kt, ct = (p[name] for name in ("ms", "mu", "ks", "cs", "kt", "ct"))
    c = inner.values
    inertance = c.get("inertance", 0.0)

    def damper(s: State, speed: float) -> tuple[float, list[float]]:
        """Return the damper's force and the rate of what it remembers."""
        if inner.effect == "compliant_coupling":
            bent = (cs * speed - c["stiffness"] * s[4]) / (cs + c["damping"])
            return cs * (speed - bent), [bent]
        if inner.effect == "thermal_fade":
            force = cs * exp(-c["fade"] * s[4]) * speed
            return force, [force * speed - c["cooling"] * s[4]]
        return cs * speed, []

    def rates(s: State, road: float, load: Loads) -> State:
        travel, dent, vw, vb = s[:4]
        force, memory = damper(s, vw - vb)
        strut = ks * travel + force + load.get("suspension", 0.0)
        tyre = kt * dent + ct * (road - vw)
        on_wheel = tyre - strut - load.get("wheel", 0.0)
        on_body = strut - load.get("body", 0.0)
        if inertance:  # takes inertance * (aw - ab) from the wheel and gives it to the body
            both = (on_wheel / mu - on_body / ms) / (1 + inertance * (1 / mu + 1 / ms))
            on_wheel, on_body = on_wheel - inertance * both, on_body + inertance * both
        return [vw - vb, road - vw, on_wheel / mu, on_body / ms, *memory]

    more = inner.effect in ("compliant_coupling", "thermal_fade")
    pace = 2 * (kt / mu) ** 0.5
    if inner.effect == "compliant_coupling":
        pace = max(pace, c["stiffness"] / (cs + c["damping"]))
    return Ode(
        start=[0.0] * (4 + more),
        rates=rates,
        flows={
            "wheel": lambda s: s[2],
            "body": lambda s: s[3],
            "suspension": lambda s: s[2] - s[3],
        },
        outputs=lambda s, road: (s[0], s[3]),
        names=("travel", "body_speed"),
        pace=pace,
    )
