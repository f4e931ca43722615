"""A quarter car in which nothing is missing; its parameters are a little off.

The truth is the exact solution of linear equations for a road speed that goes in straight lines.
"""

from __future__ import annotations

import numpy
from scipy.signal import StateSpace, lsim

from bondgraph import BondGraph
from bondgraph.discrepancy.measurement import Measurement
from bondgraph.models import quarter_car

from .excitation import multisine, noisy
from .value import Expected

Array = numpy.ndarray
INTERVAL = 0.005
BODY, WHEEL, SPRING, TYRE, DAMPER = 291.0, 41.2, 20.6e3, 174.6e3, 1236.0  # 3 % from the sheet's

EXPECTED = Expected(
    ("none",),
    truth={"m_s": BODY, "m_u": WHEEL, "k_s": SPRING, "k_t": TYRE, "b_s": DAMPER},
    words="masses, springs and damper share one scale that no signal of motion tells",
)


def graph() -> BondGraph:
    """The quarter car of the library."""
    return quarter_car.graph()


def simulate(
    seed: int, samples: int = 3000, noise: float = 0.02
) -> tuple[list[Measurement], list[Measurement]]:
    """Two rough roads of 15 s and one held out."""
    return (
        [_recording(seed + i, samples, noise) for i in range(2)],
        [_recording(seed + 1000, samples, noise)],
    )


def run(road: Array) -> tuple[Array, Array, Array]:
    """Body speed and both compressions beyond the resting ones."""
    a = [
        [-DAMPER / BODY, DAMPER / BODY, SPRING / BODY, 0],
        [DAMPER / WHEEL, -DAMPER / WHEEL, -SPRING / WHEEL, TYRE / WHEEL],
        [-1, 1, 0, 0],
        [0, -1, 0, 0],
    ]
    b, c, d = [[0], [0], [0], [1]], numpy.eye(4)[[0, 2, 3]], numpy.zeros((3, 1))
    _, signals, _ = lsim(StateSpace(a, b, c, d), road, numpy.arange(len(road)) * INTERVAL)
    body, suspension, tyre = signals.T
    return body, suspension, tyre


def _recording(seed: int, samples: int, noise: float) -> Measurement:
    rng = numpy.random.default_rng(seed)
    road = 0.25 * multisine(samples, INTERVAL, 0.3, 20.0, seed)
    body, suspension, _ = run(road)
    return Measurement(
        numpy.arange(samples) * INTERVAL,
        {
            "v_road": road,
            "v_body": noisy(body, noise, rng),
            "suspension": noisy(suspension, noise, rng) + BODY * 9.81 / SPRING,
        },
        {"v_road": "m/s", "v_body": "m/s", "suspension": "m"},
        {"v_road": "linear"},
        name=f"road {seed}",
    )
