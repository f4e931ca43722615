"""Two tanks, one pouring into the other, of which only the lower one's level is seen.

The truth drains as Torricelli says, its upper tank has a brim and the level sensor a top.

References
----------
Schoukens, Noel, IFAC-PapersOnLine 50 (2017) 446-451 (cascaded tanks that overflow); the numbers
here are our own.
"""

from __future__ import annotations

import numpy
import sympy

from bondgraph import BondGraph, C, One, R, Sf, Zero, assemble
from bondgraph.discrepancy.measurement import Measurement

from .value import Expected, one_of

Array = numpy.ndarray
INTERVAL, SUBSTEPS = 4.0, 40
WEIGHT = 1000 * 9.81  # Pa/m
AREA = (2.0e-3, 2.5e-3)  # m^2
HOLE = (1.15e-5, 1.05e-5)  # m^2, effective
PUMP = 4.0e-6  # m^3/(s V)
BRIM, WEIR = 0.30, 2.0e-3  # m, m^2/s: what runs over the upper tank's brim, per metre above it
TOP = 0.22  # m, where the lower sensor ends

_DRAINS = (
    one_of(("quadratic_drag", "upper_hole")),
    one_of(("quadratic_drag", "lower_hole"), ("orifice_flow", "lower")),
)
_BRIM = one_of(("overflow", "upper"))
_TOP = one_of(("saturation", "output level"))


def expected(brim: bool = True, top: bool = True) -> Expected:
    """What is missing, with the truth's brim and the sensor's top or without."""
    return Expected(
        ("named", "ambiguous", "unnamed"),
        (*_DRAINS, *((_BRIM,) if brim else ()), *((_TOP,) if top else ())),
        {
            **{f"quadratic_drag.drag.{i}": 1000 / (2 * hole**2) for i, hole in enumerate(HOLE)},
            **({"overflow.conductance": WEIR / WEIGHT, "overflow.threshold": WEIGHT * BRIM}),
            "saturation.limit": TOP,
        },
        {"gain": PUMP, **{f"C{i + 1}": area / WEIGHT for i, area in enumerate(AREA)}},
        "every drain is an orifice; linear resistances vanish. Two or more of these are right",
    )


EXPECTED = expected()


def graph() -> BondGraph:
    """Linear tanks: what runs out of the upper one through its hole pours into the lower one."""
    c1, c2, r1, r2, gain = sympy.symbols("C1 C2 R1 R2 gain", positive=True)
    volts = sympy.Symbol("volts", real=True)
    upper, lower = Zero("upper"), Zero("lower")
    upper_hole, lower_hole = One("upper_hole"), One("lower_hole")
    return assemble(
        "cascaded_tanks",
        Sf("pump", gain * volts) >> upper >> (C("upper_tank", c1), upper_hole),
        upper_hole >> R("upper_drain", r1),
        Sf("pour", upper_hole.f) >> lower >> (C("lower_tank", c2), lower_hole),
        lower_hole >> R("lower_drain", r2),
        parameters={
            c1: (AREA[0] / WEIGHT * 1.03, "m^3/Pa"),
            c2: (AREA[1] / WEIGHT * 0.98, "m^3/Pa"),
            r1: (9e7, "Pa*s/m^3"),
            r2: (9e7, "Pa*s/m^3"),
            gain: (PUMP, "m^3/(s*V)"),
        },
        inputs={volts: "V"},
        outputs={"level": (lower.e / WEIGHT, "m")},
    )


def simulate(
    seed: int, samples: int = 1024, brim: bool = True, top: bool = True, noise: float = 4e-4
) -> tuple[list[Measurement], list[Measurement]]:
    """Random steps of the pump; held out are others, from another unknown level."""
    return (
        [_recording(seed, samples, brim, top, noise)],
        [_recording(seed + 1000, samples, brim, top, noise)],
    )


def pumped(samples: int, rng: numpy.random.Generator) -> Array:
    """Volts that step every 40 to 160 s, long stays low and bursts high."""
    volts: list[float] = []
    while len(volts) < samples:
        volts += [rng.triangular(1.0, 4.0, 9.0)] * int(rng.integers(10, 40))
    return numpy.array(volts[:samples])


def run(volts: Array, start: tuple[float, float], brim: bool) -> tuple[Array, Array]:
    """Both levels at the samples; the pump's voltage holds between them."""
    step = INTERVAL / SUBSTEPS
    upper, lower = start
    rows = []

    def rates(u: float, a: float, b: float) -> tuple[float, float]:
        out = HOLE[0] * (2 * 9.81 * max(a, 0.0)) ** 0.5
        over = WEIR * max(a - BRIM, 0.0) if brim else 0.0
        drain = HOLE[1] * (2 * 9.81 * max(b, 0.0)) ** 0.5
        return (PUMP * u - out - over) / AREA[0], (out - drain) / AREA[1]

    for u in volts.tolist():
        rows.append((upper, lower))
        for _ in range(SUBSTEPS):
            da, db = rates(u, upper, lower)
            ea, eb = rates(u, upper + step / 2 * da, lower + step / 2 * db)
            upper, lower = upper + step * ea, lower + step * eb
    first, second = numpy.array(rows).T
    return first, second


def _recording(seed: int, samples: int, brim: bool, top: bool, noise: float) -> Measurement:
    rng = numpy.random.default_rng(seed)
    start = (float(rng.uniform(0.05, 0.2)), float(rng.uniform(0.05, 0.15)))
    volts = pumped(samples, rng)
    level = run(volts, start, brim)[1] + noise * rng.normal(size=samples)
    return Measurement(
        numpy.arange(samples) * INTERVAL,
        {"volts": volts, "level": numpy.minimum(level, TOP) if top else level},
        {"volts": "V", "level": "m"},
        {"volts": "zero"},
        name=f"tanks {seed}",
    )
