"""A positioning stage whose carriage rubs, more one way than the other.

The truth runs in closed loop: a controller moves it back and forth and its command is recorded.
What is brought is the open loop from command to position, which integrates every error twice.

References
----------
Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083-1138 (friction in servos).
"""

from __future__ import annotations

from math import exp

import numpy
import sympy

from bondgraph import BondGraph, I, Integrator, One, R, Se, assemble
from bondgraph.discrepancy.measurement import Measurement

from .excitation import quantised
from .value import Expected, one_of

Array = numpy.ndarray
INTERVAL = 1e-3
MASS, VISCOUS, GAIN = 2.06, 7.6, 12.0  # kg, N s/m, N/V
FORWARD, BACKWARD = 5.5, 4.5  # N, dry friction at speed
EXCESS, STRIBECK_SPEED = 0.6, 0.01  # N, m/s
RESOLUTION = 5e-6  # m, of the encoder
SUBSTEPS = 8

EXPECTED = Expected(
    ("named",),
    (
        one_of(("coulomb_friction", "carriage"), ("stribeck_friction", "carriage")),
        one_of(("effort_bias", "carriage")),
    ),
    {"coulomb_friction.level": 5.0, "effort_bias.effort": -0.5},
    {"m": MASS, "b": VISCOUS, "gain": GAIN},
    "only ratios to the gain are seen: mass, drag and friction scale with it",
)


def graph(sensor: str = "x") -> BondGraph:
    """Mass and viscous drag behind a motor of known gain; ``sensor`` is ``x`` or ``v``."""
    m, b, gain = sympy.symbols("m b gain", positive=True)
    command = sympy.Symbol("command", real=True)
    carriage = One("carriage")
    position = Integrator("position", carriage.f)
    outputs = {"x": (position.y, "m"), "v": (carriage.f, "m/s")}
    return assemble(
        "stage",
        Se("motor", gain * command) >> carriage >> (I("mass", m), R("guide", b)),
        position,
        parameters={m: (2.0, "kg"), b: (8.0, "N*s/m"), gain: (GAIN, "N/V")},
        inputs={command: "V"},
        outputs={sensor: outputs[sensor]},
    )


def simulate(
    seed: int, sensor: str = "x", samples: int = 25_000
) -> tuple[list[Measurement], list[Measurement]]:
    """Moves back and forth; held out are other moves, two fifths as many."""
    return (
        [_recording(seed, sensor, samples)],
        [_recording(seed + 1000, sensor, max(2 * samples // 5, 2))],
    )


def moves(samples: int, rng: numpy.random.Generator) -> tuple[Array, Array]:
    """Trapezoidal moves of 1 to 12 cm with rests between, and their speeds."""
    speeds: list[float] = []
    where = 0.0
    while len(speeds) < samples:
        target = rng.uniform(-0.08, 0.08)
        way, top, rise = target - where, rng.uniform(0.05, 0.25), 2.0
        top = min(top, (abs(way) * rise) ** 0.5)
        ramp = max(int(top / rise / INTERVAL), 1)
        flat = max(int((abs(way) / top - top / rise) / INTERVAL), 0)
        up = numpy.linspace(0, 1, ramp, endpoint=False)
        profile = numpy.concatenate([up, numpy.ones(flat), 1 - up]) * top * numpy.sign(way)
        where += float(profile.sum()) * INTERVAL
        speeds += [*profile, *numpy.zeros(int(rng.uniform(0.1, 0.4) / INTERVAL))]
    speed = numpy.array(speeds[:samples])
    return numpy.cumsum(speed) * INTERVAL, speed


def run(targets: Array, speeds: Array) -> tuple[Array, Array, Array]:
    """Command, position and speed at the samples; the command holds between them.

    Time stepping in which friction is a set: the impulse that would stop the mass is taken where
    it is within the friction, and friction's full impulse where it is not.
    """
    x = v = total = 0.0
    step = INTERVAL / SUBSTEPS
    rows = []
    for target, speed in zip(targets.tolist(), speeds.tolist(), strict=True):
        total += (target - x) * INTERVAL
        volts = 250 * (target - x) + 6 * (speed - v) + 900 * total
        volts = min(max(volts, -10.0), 10.0)
        rows.append((volts, x, v))
        for _ in range(SUBSTEPS):
            v_new = stepped(v, GAIN * volts, step)
            x += step * (v + v_new) / 2
            v = v_new
    command, position, velocity = numpy.array(rows).T
    return command, position, velocity


def stepped(v: float, force: float, step: float) -> float:
    """Speed one step on, by the midpoint rule with the friction implicit."""
    dry = EXCESS * exp(-((v / STRIBECK_SPEED) ** 2))
    free = (v * (MASS / step - VISCOUS / 2) + force) / (MASS / step + VISCOUS / 2)
    weight = 1 / (MASS / step + VISCOUS / 2)
    if free > weight * (FORWARD + dry):
        return free - weight * (FORWARD + dry)
    if free < -weight * (BACKWARD + dry):
        return free + weight * (BACKWARD + dry)
    return 0.0


def _recording(seed: int, sensor: str, samples: int) -> Measurement:
    rng = numpy.random.default_rng(seed)
    command, x, v = run(*moves(samples, rng))
    signal = quantised(x, RESOLUTION) if sensor == "x" else v + 2e-3 * rng.normal(size=samples)
    return Measurement(
        numpy.arange(samples) * INTERVAL,
        {"command": command, sensor: signal},
        {"command": "V", "x": "m", "v": "m/s"},
        {"command": "zero"},
        {"mass.p": 0.0, "position.y": 0.0},
        f"stage {seed}",
    )
