"""A bicycle's rear brake whose wheel winds up, beside a model whose wheel is rigid.

An automaton of two modes, slip and stick, with events located by scipy. The columns are the
caliper's motion and, if asked for, the slip of the pads, as a sensor on the rotor gives it.

References
----------
Bike braking vibration modelling and measurement, Procedia Engineering 72 (2014) 471-476.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import copysign, exp, expm1, pi

import numpy
from scipy.integrate import solve_ivp

from bondgraph import BondGraph
from bondgraph.discrepancy.measurement import Measurement
from bondgraph.models import frame_brake

from .value import Expected, one_of

Array = numpy.ndarray
RADIUS, FRAME, WHEEL = 0.08, 350e3, 90e3  # m, N/m, N/m at the rotor's rim
FRAME_MASS = FRAME / (2 * pi * 300) ** 2
RIM_MASS = WHEEL / (2 * pi * 200) ** 2
LOSSES = (0.1 * (FRAME * FRAME_MASS) ** 0.5, 0.1 * (WHEEL * RIM_MASS) ** 0.5)  # N s/m
SPEED, NORMAL, KINETIC = 0.9, 2250.0, 0.4  # m/s, N
RATE = 20e3  # Hz


@dataclass(frozen=True)
class Settings:
    """What differs between the paper's figures: static friction, application time, sensitivity."""

    mu_s: float
    tau: float
    v_s: float = 0.05


FIGURES: Mapping[str, Settings] = {
    "Fig. 6": Settings(0.42, 0.03),
    "Fig. 8": Settings(0.5, 0.02),
    "Fig. 9": Settings(0.5, 0.06, 0.2),
}
SITES = ("bond road>hub", "bond hub>rotor_radius", "pads")
EXPECTED = Expected(
    ("named", "ambiguous"),
    (
        one_of(*(("compliant_coupling", site) for site in SITES)),
        one_of(("added_inertia", "hub")),
    ),
    {
        "compliant_coupling.stiffness": WHEEL * RADIUS**2,
        "compliant_coupling.damping": LOSSES[1] * RADIUS**2,
        "added_inertia.inertance": RIM_MASS * RADIUS**2,
    },
    words="alone, a coupling is the same at any of the sites; only at the bond from the road does "
    "the hub get a speed of its own, and an inertia there then moves. Before that it is in "
    "derivative causality and does nothing. It starts with the momentum of the rigid wheel, "
    "inertance times V0/r_r, whatever the inertance",
)
EXPECTED_UNSEEN = Expected(
    ("none", "ambiguous"), words="Fig. 6's caliper without the rotor hardly tells of the wheel"
)


def graph(figure: str = "Fig. 8") -> BondGraph:
    """The frame-only brake of the library with a figure's settings."""
    model = frame_brake.graph()
    settings = vars(FIGURES[figure])
    table = {
        symbol: replace(row, value=settings[symbol.name]) if symbol.name in settings else row
        for symbol, row in model.parameters.items()
    }
    return replace(model, parameters=table)


def simulate(
    seed: int,
    figure: str = "Fig. 8",
    columns: tuple[str, ...] = ("x_c", "slip"),
    span: float = 0.12,
    noise: float = 0.005,
) -> tuple[list[Measurement], list[Measurement]]:
    """Brake applications; held out is one that begins with a bent frame."""
    return (
        [_recording(seed, figure, columns, span, noise, 0.0)],
        [_recording(seed + 1000, figure, columns, span, noise, 0.8e-3)],
    )


def run(
    settings: Settings, times: Array, bent: float = 0.0
) -> tuple[dict[str, Array], list[float]]:
    """Signals at times, and when it began to stick."""
    y = numpy.array([SPEED, 0.0, 0.0, bent])  # rim speed, caliper speed, wind-up, deflection
    t, sliding, sticks = 0.0, 1.0, []
    parts = numpy.full((4, len(times)), numpy.nan)
    while t < times[-1]:
        piece = _piece(settings, t, y, sliding, float(times[-1]))
        here = (times >= t) & (times <= piece.t[-1])
        parts[:, here] = piece.sol(times[here])
        if piece.status != 1:
            break
        t, y = float(piece.t[-1]), piece.y[:, -1].copy()
        if sliding:
            y[:2] = (RIM_MASS * y[0] + FRAME_MASS * y[1]) / (RIM_MASS + FRAME_MASS)
            inside = abs(holding(y)) < settings.mu_s * normal(settings, t)
            sliding = 0.0 if inside else -sliding
            sticks += [t] * inside
        else:
            sliding = copysign(1.0, holding(y))
    signals = {"V_c": parts[1], "x_c": parts[3], "slip": parts[0] - parts[1]}
    return signals, sticks


def normal(settings: Settings, t: float) -> float:
    return -NORMAL * expm1(-t / settings.tau)


def holding(y: Array) -> float:
    """Friction that keeps rim and caliper at one speed."""
    wheel = (WHEEL * y[2] + LOSSES[1] * (SPEED - y[0])) / RIM_MASS
    frame = (FRAME * y[3] + LOSSES[0] * y[1]) / FRAME_MASS
    return float((wheel + frame) / (1 / RIM_MASS + 1 / FRAME_MASS))


def _piece(settings: Settings, t: float, y: Array, sliding: float, end: float):
    """Run one mode to its end: slip reaches zero, or what holds exceeds the static friction."""

    def rates(t: float, y: Array) -> list[float]:
        if sliding:
            fall = (settings.mu_s - KINETIC) * exp(-abs(y[0] - y[1]) / settings.v_s)
            friction = sliding * normal(settings, t) * (KINETIC + fall)
        else:
            friction = holding(y)
        rim = WHEEL * y[2] + LOSSES[1] * (SPEED - y[0]) - friction
        frame = friction - FRAME * y[3] - LOSSES[0] * y[1]
        return [rim / RIM_MASS, frame / FRAME_MASS, SPEED - y[0], y[1]]

    def over(t: float, y: Array) -> float:
        if sliding:
            return float(sliding * (y[0] - y[1]))
        return settings.mu_s * normal(settings, t) - abs(holding(y))

    over.terminal, over.direction = True, -1
    options = {"rtol": 1e-9, "atol": 1e-12, "max_step": 2e-4, "dense_output": True}
    return solve_ivp(rates, (t, end), y, "DOP853", events=over, **options)


def _recording(
    seed: int, figure: str, columns: tuple[str, ...], span: float, noise: float, bent: float
) -> Measurement:
    rng = numpy.random.default_rng(seed)
    times = numpy.arange(round(span * RATE)) / RATE
    signals, _ = run(FIGURES[figure], times, bent)
    return Measurement(
        times,
        {n: signals[n] + noise * signals[n].std() * rng.normal(size=len(times)) for n in columns},
        {"x_c": "m", "V_c": "m/s", "slip": "m/s"},
        initial={"rear.mass.p": 0.0, "rear.bending.q": bent, "line.fluid.q": 0.0},
        name=f"{figure} {seed}",
    )
