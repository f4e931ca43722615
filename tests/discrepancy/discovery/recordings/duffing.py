"""An oscillator with a spring that hardens: the kind that electronic benchmarks emulate.

References
----------
Wigren, Schoukens, European Control Conference 2013, 2933-2938 (Silverbox, an electronic Duffing
oscillator); the numbers here are our own.
"""

from __future__ import annotations

import numpy
import sympy

from bondgraph import BondGraph, C, I, One, R, Se, assemble
from bondgraph.discrepancy.measurement import Measurement

from .excitation import multisine, noisy
from .value import Expected, one_of

Array = numpy.ndarray
RATE = 610.0  # Hz
BAND = 200.0  # Hz
MASS, DAMPING, STIFFNESS, CUBIC = 1.02, 46.0, 1.9e5, 5.0e6  # kg, N s/m, N/m, N/m^3
FINE = 8  # fine input steps a sample; one Runge-Kutta step takes two

EXPECTED = Expected(
    ("named",),
    (one_of(("cubic_stiffness", "velocity")),),
    {"cubic_stiffness.cubic": CUBIC},
    {"m": MASS, "b": DAMPING, "k": STIFFNESS},
    "the input is band-limited between samples; held to steps it looks like delay or mass",
)


def graph() -> BondGraph:
    """A linear oscillator, its parameters some percent off."""
    m, b, k = sympy.symbols("m b k", positive=True)
    force = sympy.Symbol("force", real=True)
    velocity = One("velocity")
    spring = C("spring", stiffness=k)
    return assemble(
        "oscillator",
        Se("shaker", force) >> velocity >> (I("mass", m), spring, R("damper", b)),
        parameters={m: (1.0, "kg"), b: (50, "N*s/m"), k: (1.85e5, "N/m")},
        inputs={force: "N"},
        outputs={"y": (spring.q, "m")},
    )


def simulate(
    seed: int, samples: int = 128_000, noise: float = 0.005
) -> tuple[list[Measurement], list[Measurement]]:
    """Random input that grows to 3000 N RMS, and a multisine of 1000 N, an eighth as long."""
    growing = fading(samples * FINE, FINE) * multisine(samples, 1 / RATE, 1.0, BAND, seed, FINE)
    rows = samples // 8
    even = multisine(rows, 1 / RATE, 1.0, BAND, seed + 1000, FINE)
    ends = fading(rows * FINE, FINE, growth=False)
    return (
        [_recording(f"growing {seed}", 3000 * growing, seed, noise)],
        [_recording(f"multisine {seed}", 1000 * ends * even, seed + 1000, noise)],
    )


def fading(rows: int, fine: int, growth: bool = True) -> Array:
    """Growth from nothing, or none, with both ends faded out over 100 samples."""
    ramp = numpy.clip(numpy.arange(rows) / (100 * fine), 0, 1)
    ends = numpy.sin(numpy.pi / 2 * numpy.minimum(ramp, ramp[::-1])) ** 2
    return numpy.asarray(ends * (numpy.linspace(0, 1, rows) if growth else 1))


def run(force: Array) -> Array:
    """Displacement at the samples for a force ``FINE`` times as dense; classical Runge-Kutta."""
    step = 2 / (RATE * FINE)
    values = [*force.tolist(), 0.0, 0.0]
    y = v = 0.0
    out = numpy.empty(len(force) // FINE)

    def a(f: float, y: float, v: float) -> float:
        return (f - DAMPING * v - (STIFFNESS + CUBIC * y * y) * y) / MASS

    for row in range(0, len(force), 2):
        if row % FINE == 0:
            out[row // FINE] = y
        f0, f1, f2 = values[row : row + 3]
        a1 = a(f0, y, v)
        v2 = v + step / 2 * a1
        a2 = a(f1, y + step / 2 * v, v2)
        v3 = v + step / 2 * a2
        a3 = a(f1, y + step / 2 * v2, v3)
        v4 = v + step * a3
        a4 = a(f2, y + step * v3, v4)
        y += step / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v += step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return out


def _recording(name: str, force: Array, seed: int, noise: float) -> Measurement:
    y = noisy(run(force), noise, numpy.random.default_rng(seed))
    return Measurement(
        numpy.arange(len(y)) / RATE,
        {"force": force[::FINE], "y": y},
        {"force": "N", "y": "m"},
        {"force": "band"},
        {"mass.p": 0.0, "spring.q": 0.0},
        name,
    )
