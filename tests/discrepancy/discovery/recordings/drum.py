"""A drum brake that is applied again and again and fades as it warms.

The truth knows a temperature that falls by Newton's law and a friction that falls in a straight
line with it; the table's effect falls exponentially with the heat made.

References
----------
Limpert, Brake Design and Safety, 3rd ed., SAE 2011, ch. 4.
"""

from __future__ import annotations

import numpy
import sympy

from bondgraph import BondGraph, Friction, I, One, R, Se, assemble
from bondgraph.discrepancy.measurement import Measurement

from .value import Expected, one_of

Array = numpy.ndarray
INTERVAL, SUBSTEPS = 0.05, 5
INERTIA, DRAG, GAIN = 8.2, 0.31, 0.072  # kg m^2, N m s/rad, N m/N
HEAT, COOLING, FADE = 1700.0, 9.0, 2.4e-3  # J/K, W/K, 1/K
FAST, SLOW, DRIVE, FORCE = 95.0, 15.0, 120.0, 3500.0  # rad/s, rad/s, N m, N

EXPECTED = Expected(
    ("named",),
    (one_of(("thermal_fade", "dissipator lining")),),
    {"thermal_fade.fade": FADE / HEAT, "thermal_fade.cooling": COOLING / HEAT},
    {"J": INERTIA, "b": DRAG, "gain": GAIN},
    "drive and force are known in N m and N, so inertia and gain are told",
)


def graph() -> BondGraph:
    """Inertia, bearing and a lining whose torque is proportional to the force on it."""
    inertia, drag, gain = sympy.symbols("J b gain", positive=True)
    drive = sympy.Symbol("drive", real=True)
    force = sympy.Symbol("force", nonnegative=True)
    drum = One("drum")
    return assemble(
        "drum_brake",
        Se("engine", drive) >> drum >> (I("flywheel", inertia), R("bearing", drag)),
        drum >> Friction("lining", kinetic=lambda speed: gain * force),
        parameters={
            inertia: (8.0, "kg*m^2"),
            drag: (0.3, "N*m*s/rad"),
            gain: (0.07, "m"),
        },
        inputs={drive: "N*m", force: "N"},
        outputs={"speed": (drum.f, "rad/s")},
    )


def simulate(
    seed: int, samples: int = 4000, noise: float = 0.3, temperature: bool = False
) -> tuple[list[Measurement], list[Measurement]]:
    """Stop after stop, 200 s; held out are others, further apart."""
    return (
        [_recording(seed, samples, noise, temperature, (0.5, 3.0))],
        [_recording(seed + 1000, samples, noise, temperature, (1.0, 6.0))],
    )


def run(
    samples: int, rng: numpy.random.Generator, pauses: tuple[float, float]
) -> tuple[Array, Array, Array, Array]:
    """Drive, force, speed and temperature above the air's; commands hold between samples.

    A driver speeds up to a random speed, rolls, and brakes with a random force to a slow roll.
    """
    step = INTERVAL / SUBSTEPS
    w, warm, phase, wait = 40.0, 0.0, "drive", 0.0
    top, press = FAST, FORCE
    rows = []
    for _ in range(samples):
        if phase == "drive" and w >= top:
            phase, wait = "roll", rng.uniform(*pauses)
        elif phase == "roll":
            wait -= INTERVAL
            phase = "brake" if wait <= 0 else phase
        elif phase == "brake" and w <= SLOW:
            phase, top, press = "drive", FAST * rng.uniform(0.6, 1.0), FORCE * rng.uniform(0.5, 1)
        drive = DRIVE if phase == "drive" else 0.0
        force = press if phase == "brake" else 0.0
        rows.append((drive, force, w, warm))
        for _ in range(SUBSTEPS):
            w, warm = _stepped(w, warm, drive, force, step)
    drives, forces, speeds, temperatures = numpy.array(rows).T
    return drives, forces, speeds, temperatures


def _stepped(w: float, warm: float, drive: float, force: float, step: float) -> tuple[float, float]:
    """Heun's step; the drum never stops, so the lining's torque keeps its sign."""

    def rates(w: float, warm: float) -> tuple[float, float]:
        rub = GAIN * force * (1 - FADE * warm)
        return (drive - DRAG * w - rub) / INERTIA, (rub * w - COOLING * warm) / HEAT

    a, b = rates(w, warm)
    c, d = rates(w + step * a, warm + step * b)
    return w + step * (a + c) / 2, warm + step * (b + d) / 2


def _recording(
    seed: int, samples: int, noise: float, temperature: bool, pauses: tuple[float, float]
) -> Measurement:
    rng = numpy.random.default_rng(seed)
    drive, force, speed, warm = run(samples, rng, pauses)
    columns = {"drive": drive, "force": force, "speed": speed + noise * rng.normal(size=samples)}
    if temperature:
        columns["temperature"] = warm + 293.15
    return Measurement(
        numpy.arange(samples) * INTERVAL,
        columns,
        {"drive": "N*m", "force": "N", "speed": "rad/s", "temperature": "K"},
        {"drive": "zero", "force": "zero"},
        {"flywheel.p": INERTIA * 40.0},
        f"drum {seed}",
    )
