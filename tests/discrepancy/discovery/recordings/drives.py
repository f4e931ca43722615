"""Two drives joined by an elastic belt that has slack, stiffens, or rubs in itself.

References
----------
Wigren, Schoukens, Coupled electric drives data set and reference models, Uppsala University
Technical Report 2017-024 (500 samples, belt, pseudo-random input); the numbers here are our own.
"""

from __future__ import annotations

import numpy
import sympy

from bondgraph import BondGraph, C, I, One, R, Se, Zero, assemble
from bondgraph.discrepancy.measurement import Measurement

from .excitation import noisy, steps
from .value import Expected, one_of

Array = numpy.ndarray
INTERVAL, SUBSTEPS = 0.02, 50
INERTIA = (0.0105, 0.0195)  # kg m^2
DRAG = (0.011, 0.021)  # N m s/rad
BELT, LOSS = 1.0, 0.008  # N m/rad, N m s/rad
GAIN = 0.5  # N m/V
STIFFER, SLACK = 4.0, 0.35  # N m/rad beyond, rad
CELLS = ((1.2, 0.08), (0.8, 0.2), (0.5, 0.4))  # N m/rad and rad of each spring with a slider
KINDS = ("stiffening", "backlash", "hysteresis")

_SITES = ("stretch", "between motor and load")
_NAMES = {
    "stiffening": ("dead_zone", "cubic_stiffness"),
    "backlash": ("dead_zone", "cubic_stiffness"),
    "hysteresis": ("hysteresis",),
}


def expected(kind: str = "stiffening") -> Expected:
    """What is missing of one of `KINDS`."""
    names = _NAMES[kind]
    values = {"dead_zone.stiffness": STIFFER, "dead_zone.width": SLACK}
    return Expected(
        ("named", "ambiguous"),
        (one_of(*((name, site) for name in names for site in _SITES)),),
        {} if kind == "hysteresis" else values,
        {"J1": INERTIA[0], "J2": INERTIA[1], "b1": DRAG[0], "b2": DRAG[1], "k": BELT, "c": LOSS},
        "backlash: the belt's own stiffness goes to zero; stiffening: exact in the table; "
        "hysteresis: three springs with sliders, not Bouc-Wen",
    )


EXPECTED = expected()


def graph(outputs: tuple[str, ...] = ("w1", "w2")) -> BondGraph:
    """Two wheels and a linear belt."""
    j1, j2, b1, b2, k, c, gain = sympy.symbols("J1 J2 b1 b2 k c gain", positive=True)
    volts = sympy.Symbol("volts", real=True)
    motor, belt, stretch, load = One("motor"), Zero("belt"), One("stretch"), One("load")
    speeds = {"w1": (motor.f, "rad/s"), "w2": (load.f, "rad/s")}
    return assemble(
        "coupled_drives",
        Se("drive", gain * volts) >> motor >> (I("rotor", j1), R("bearing1", b1), belt),
        belt >> stretch >> (C("elastic", stiffness=k), R("loss", c)),
        belt >> load >> (I("pulley", j2), R("bearing2", b2)),
        parameters={
            j1: (0.01, "kg*m^2"),
            j2: (0.02, "kg*m^2"),
            b1: (0.01, "N*m*s/rad"),
            b2: (0.02, "N*m*s/rad"),
            k: (1.1, "N*m/rad"),
            c: (0.01, "N*m*s/rad"),
            gain: (GAIN, "N*m/V"),
        },
        inputs={volts: "V"},
        outputs={name: speeds[name] for name in outputs},
    )


def simulate(
    seed: int,
    kind: str = "stiffening",
    samples: int = 500,
    noise: float = 0.01,
    outputs: tuple[str, ...] = ("w1", "w2"),
) -> tuple[list[Measurement], list[Measurement]]:
    """A binary sequence of either sign, 10 s; held out is another, at 0.8 of its height."""
    return (
        [_recording(seed, kind, samples, noise, outputs, 1.6)],
        [_recording(seed + 1000, kind, samples, noise, outputs, 1.28)],
    )


def torque(kind: str, stretch: float, cells: list[float]) -> float:
    """Elastic torque of the belt; ``cells`` are what its springs with sliders hold."""
    beyond = max(stretch - SLACK, 0.0) + min(stretch + SLACK, 0.0)
    if kind == "stiffening":
        return BELT * stretch + STIFFER * beyond
    if kind == "backlash":
        return STIFFER * beyond
    return BELT * stretch + sum(
        stiffness * held for (stiffness, _), held in zip(CELLS, cells, strict=True)
    )


def run(volts: Array, kind: str) -> tuple[Array, Array]:
    """Speeds at the samples, by the leapfrog with damping halfway; volts hold between."""
    step = INTERVAL / SUBSTEPS
    w1 = w2 = stretch = 0.0
    cells = [0.0] * len(CELLS)
    rows = []
    for u in volts.tolist():
        rows.append((w1, w2))
        for _ in range(SUBSTEPS):
            middle = stretch + step / 2 * (w1 - w2)
            moved = [
                max(-limit, min(limit, held + step * (w1 - w2)))
                for (_, limit), held in zip(CELLS, cells, strict=True)
            ]
            halfway = [(a + b) / 2 for a, b in zip(cells, moved, strict=True)]
            pull = torque(kind, middle, halfway) + LOSS * (w1 - w2)
            w1 += step * (GAIN * u - DRAG[0] * w1 - pull) / INERTIA[0]
            w2 += step * (pull - DRAG[1] * w2) / INERTIA[1]
            stretch = middle + step / 2 * (w1 - w2)
            cells = moved
    first, second = numpy.array(rows).T
    return first, second


def _recording(
    seed: int, kind: str, samples: int, noise: float, outputs: tuple[str, ...], height: float
) -> Measurement:
    rng = numpy.random.default_rng(seed)
    volts = height * steps(samples, 12, seed) + 0.3 * height
    speeds = dict(zip(("w1", "w2"), run(volts, kind), strict=True))
    return Measurement(
        numpy.arange(samples) * INTERVAL,
        {"volts": volts, **{name: noisy(speeds[name], noise, rng) for name in outputs}},
        {"volts": "V", "w1": "rad/s", "w2": "rad/s"},
        {"volts": "zero"},
        {"rotor.p": 0.0, "pulley.p": 0.0, "elastic.q": 0.0},
        f"drives {kind} {seed}",
    )
