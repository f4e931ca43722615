"""The real pendulum: free swings with a bearing that nobody knows.

See `tests/discrepancy/data/README.md` for where it is from, its licence and its paper.
"""

from __future__ import annotations

from math import pi
from pathlib import Path

import sympy

from bondgraph import BondGraph, Integrator, One, R, Se, assemble
from bondgraph import I as Inertia
from bondgraph.discrepancy.measurement import Measurement, read_all

from .value import Expected, one_of

DATA = Path(__file__).parents[2] / "data" / "pendulum_single_uw.csv"
SPLITS = {
    "early and late": (("id0", "id1", "id2", "id3"), ("vad0", "vad1")),
    "in between": (("id0", "id2", "vad0"), ("id1", "id3", "vad1")),
}

EXPECTED = Expected(
    ("named", "ambiguous", "unnamed"),
    (
        one_of(("coulomb_friction", "swing"), ("stribeck_friction", "swing")),
        one_of(("quadratic_drag", "swing")),
    ),
    words="both together, with the viscous bearing gone; beside it neither one alone is worth "
    "naming (`reference.swings`), so a search that adds one at a time ends at none or unnamed. "
    "The angle's zero is 0.8 mrad off, which a sensor_bias may say",
)


def graph(bearing: bool = True) -> BondGraph:
    """A pendulum of unit inertia, angle from hanging; torques are per inertia.

    Free swings tell no inertia, so it is a number and not a parameter.
    """
    pull, drag = sympy.symbols("pull drag", positive=True)
    swing = One("swing")
    angle = Integrator("angle", swing.f)
    rubbing = (R("bearing", drag),) if bearing else ()
    return assemble(
        "pendulum",
        Se("weight", -pull * sympy.sin(angle.y)) >> swing >> (Inertia("bob", 1), *rubbing),
        angle,
        parameters={
            pull: (64.0, "N*m"),
            **({drag: (0.05, "N*m*s/rad")} if bearing else {}),
        },
        outputs={"theta": (angle.y, "rad"), "omega": (swing.f, "rad/s")},
    )


def recordings(
    split: str = "early and late", columns: tuple[str, ...] = ("theta",)
) -> tuple[list[Measurement], list[Measurement]]:
    """Swings to learn from and swings held out; angles from hanging, starts unknown."""
    runs = read_all(
        DATA,
        segment="seg",
        time="t_s",
        rename={"theta": "theta_rad", "omega": "omega_rad_s"},
        units={"theta": "rad", "omega": "rad/s"},
    )
    by_name = {run.name.split(":")[1]: _hanging(run, columns) for run in runs}
    train, held_out = SPLITS[split]
    return [by_name[name] for name in train], [by_name[name] for name in held_out]


def _hanging(run: Measurement, columns: tuple[str, ...]) -> Measurement:
    angles = {"theta": run.columns["theta"] - pi, "omega": run.columns["omega"]}
    return run.changed(columns={name: angles[name] for name in columns})
