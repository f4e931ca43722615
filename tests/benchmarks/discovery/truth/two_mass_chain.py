"""Two masses on springs, the first one pushed; the second may sit on a soft mount."""

from __future__ import annotations

from collections.abc import Mapping

from .ode import NOTHING, Inner, Loads, Ode, State


def build(p: Mapping[str, float], inner: Inner = NOTHING) -> Ode:
    m1, m2, k1, k2, b1, b2 = (p[name] for name in ("m1", "m2", "k1", "k2", "b1", "b2"))
    c = inner.values

    def plain(s: State, push: float, load: Loads) -> State:
        x, d, v1, v2 = s
        link = k2 * d + b2 * (v1 - v2)
        taken1, taken2 = load.get("first", 0.0), load.get("second", 0.0)
        inside = load.get("way", 0.0)
        return [
            v1,
            v1 - v2,
            (push - k1 * x - b1 * v1 - link - taken1 - inside) / m1,
            (link - taken2 + inside) / m2,
        ]

    def before_mount(s: State) -> float:
        """Return the speed between link and mount, which weighs nothing: forces are equal."""
        _, d, v1, vm, z = s
        return (k2 * d + b2 * v1 - c["stiffness"] * z + c["damping"] * vm) / (b2 + c["damping"])

    def mounted(s: State, push: float, load: Loads) -> State:
        x, d, v1, vm, _ = s
        v2 = before_mount(s)
        link = k2 * d + b2 * (v1 - v2)
        return [v1, v1 - v2, (push - k1 * x - b1 * v1 - link) / m1, link / m2, v2 - vm]

    soft = inner.effect == "compliant_coupling"
    second = before_mount if soft else lambda s: s[3]
    pace = 2 * (k2 / m1 + k2 / m2) ** 0.5
    return Ode(
        start=[0.0] * (5 if soft else 4),
        rates=mounted if soft else plain,
        flows={
            "first": lambda s: s[2],
            "second": lambda s: s[3],
            "way": lambda s: s[2] - s[3],
        },
        outputs=lambda s, push: (s[2], second(s)),
        names=("v1", "v2"),
        pace=max(pace, (k2 + c["stiffness"]) / (b2 + c["damping"])) if soft else pace,
    )
