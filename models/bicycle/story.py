"""The brake's own part of a report: friction, pad application, and runs that stick or slide.

The sets are those of the paper's Figs 4 to 9; whatever a caption says of a run
comes from that run's own events.

References
----------
Bike braking vibration modelling and measurement, Procedia Engineering 72
(2014) 471-476.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy

from bondgraph.graph import BondGraph
from bondgraph.plot import Signal, application, friction_curve, phase_plane, signal, time_response
from bondgraph.report import Figure, Panel, Section, Text
from bondgraph.simulation import CompiledModel, Trajectory, simulate
from bondgraph.steady import steady_state

UNTIL = 0.5
SAMPLES = 10_001
RTOL = 1e-9
# A cycle's frequency is the mean over this many intervals between sticks, if there are as many.
CYCLES = 4

RUNS: Mapping[str, Mapping[str, float]] = {
    "Fig. 6": {"mu_s": 0.42, "tau": 0.03, "v_s": 0.05},
    "Fig. 7": {"mu_s": 0.42, "tau": 0.02, "v_s": 0.05},
    "Fig. 8": {"mu_s": 0.5, "tau": 0.02, "v_s": 0.05},
    "Fig. 9": {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2},
}
SENSITIVITIES = (0.05, 0.1, 0.2)
TIME_CONSTANTS = (0.02, 0.03, 0.06)


@dataclass(frozen=True)
class Behaviour:
    """What a run did, read from its events.

    Attributes
    ----------
    sticks : (k,) array
        Times at which the pads begin to stick, s.
    lasting : bool
        Whether it still sticks in the last fifth of the run.
    frequency : float or None
        Of a lasting cycle, from the times of sticks, Hz.
    stuck : float or None
        Share of the time that it is stuck in that cycle.
    """

    sticks: numpy.ndarray
    lasting: bool
    frequency: float | None
    stuck: float | None


def behaviour(run: Trajectory, element: str = "friction") -> Behaviour:
    """Read the behaviour of a run from its events.

    Parameters
    ----------
    run : Trajectory
    element : str
        The contact.

    Returns
    -------
    Behaviour

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> behaviour(simulate(bicycle_brake.graph(), 0.1, {"mu_s": 0.42})).lasting
    False
    """
    sticks = run.sticks(element)
    lasting = bool(len(sticks) > 2 and sticks[-1] > run.t[0] + 0.8 * (run.t_end - run.t[0]))
    if not lasting:
        return Behaviour(sticks, False, None, None)
    last = sticks[-CYCLES - 1 :]
    slips = [
        event.t
        for event in run.events
        if event.element == element and event.from_mode == "stick" and event.t > last[0]
    ]
    span = last[-1] - last[0]
    held = sum(after - before for before, after in zip(last[:-1], slips, strict=False))
    return Behaviour(sticks, True, (len(last) - 1) / span, held / span)


def figures(graph: BondGraph, parameters: Mapping[Any, Any] | None = None) -> list[Section]:
    """Build the brake's own sections of a report.

    Parameters
    ----------
    graph : BondGraph
        A brake with outputs V_c, x_c, slip, F_f and N, and perhaps omega_r and
        theta_w.
    parameters : mapping, optional
        Those of the report; the paper's sets change three of them.

    Returns
    -------
    list of Section
    """
    given = {getattr(key, "name", key): value for key, value in (parameters or {}).items()}
    model = CompiledModel(graph)
    own = _run(model, given, "This brake.", "run", "With the parameters of this report.")
    return [
        Section("Braking", (Text(_INTRODUCTION), own)),
        Section(
            "The paper's figures",
            (
                _laws(graph, model, given),
                *(
                    _run(model, {**given, **values}, f"{name}.", _slug(name), _in_words(values))
                    for name, values in RUNS.items()
                ),
            ),
        ),
    ]


_INTRODUCTION = (
    "The bicycle rolls freely, then the lever is pulled at t = 0. Deflections are normalised: "
    "multiplied by the natural angular frequency of their own part, so that a free vibration is "
    "a circle. Full dots: the pads stick to the rotor; hollow dots: they let go. Of "
    "a motion that goes on sticking the phase plane shows the last cycles in full, the way to them "
    "pale."
)


def _slug(name: str) -> str:
    return name.lower().replace(". ", "")


def _in_words(values: Mapping[str, float]) -> str:
    units = {"tau": " s", "v_s": " m/s"}
    said = [f"{name} = {value:g}{units.get(name, '')}" for name, value in values.items()]
    return f"{', '.join(said)}."


def _laws(graph: BondGraph, model: CompiledModel, given: Mapping[str, Any]) -> Figure:
    """Draw the friction curve and the build-up of the pad force: Figs 4 and 5."""
    curve = build_up = None
    for index, value in enumerate(SENSITIVITIES):
        point = steady_state(graph, {**given, "v_s": value}, modes={"friction": "slip+"})
        label = f"v_s = {value:g} m/s"
        curve = friction_curve(
            graph, "friction", point, span=0.6, ax=curve, label=label, index=index
        )
    times = numpy.linspace(0, 6 * max(TIME_CONSTANTS), 601)
    for index, value in enumerate(TIME_CONSTANTS):
        run = simulate(model, (0, times[-1]), {**given, "tau": value}, t_eval=times)
        build_up = application(run, "N", ax=build_up, label=f"tau = {value:g} s", index=index)
    assert curve is not None and build_up is not None
    return Figure(
        "Figs 4 and 5.",
        (
            Panel("fig4", curve, "Friction force over slip speed for three slip sensitivities"),
            Panel("fig5", build_up, "Normal force of the pads over time for three time constants"),
        ),
        f"Friction of the pads over slip at full lever, N = {point.outputs['N']:.6g} N: while stuck "
        "it takes any value on the vertical part, and where it falls with speed it feeds motion. "
        "Normal force of both pads after the lever is pulled; dots: 63 % of the last value.",
    )


def _run(
    model: CompiledModel, values: Mapping[str, Any], title: str, name: str, words: str
) -> Figure:
    """Simulate one set and draw its phase plane and its first part in time."""
    times = numpy.linspace(0, UNTIL, SAMPLES)
    run = simulate(model, (0, UNTIL), values, t_eval=times, rtol=RTOL)
    parts = _parts(run)
    found = behaviour(run)
    plane = phase_plane(run, parts, since=found.sticks[-3] if found.lasting else None)
    start = time_response(run, [speed for _, speed in parts])
    start.set_xlim(0, 1e3 * _window(found))
    plane.set_xlabel("normalised deflection [m/s]")
    plane.set_ylabel("velocity [m/s]")
    start.set_ylabel("velocity [m/s]")
    return Figure(
        title,
        (
            Panel(f"{name}-phase", plane, f"Phase plane: velocity over deflection. {words}"),
            Panel(f"{name}-time", start, f"Velocities over time. {words}"),
        ),
        f"{words} {_told(run, found)}",
        run,
    )


def _parts(run: Trajectory) -> list[tuple[Signal, Signal]]:
    """Return normalised deflection and velocity of the caliper, and of the rotor if it turns."""
    p = run.parameters
    caliper = (
        signal(run, "x_c").scaled(2 * pi * p["f_f"], "m/s"),
        signal(run, "V_c").named("caliper"),
    )
    if "omega_r" not in run.names:
        return [caliper]
    rotor = (
        signal(run, "theta_w").scaled(p["r_r"] * 2 * pi * p["f_w"], "m/s"),
        signal(run, "omega_r").scaled(p["r_r"], "m/s").named("rotor"),
    )
    return [caliper, rotor]


def _window(found: Behaviour) -> float:
    """Choose how much of a run to show over time: its first cycles, or the way to them."""
    if not found.lasting:
        return 0.12
    return float(found.sticks[min(7, len(found.sticks) - 1)]) + 0.005


def _told(run: Trajectory, found: Behaviour) -> str:
    """Say what a run did, in its own numbers."""
    sentences = [_sticking(run, found)]
    if found.lasting:
        settled = run.t > found.sticks[-min(CYCLES, len(found.sticks)) :][0]
        x = 1e3 * run["x_c"][settled]
        sentences.append(f"Then the caliper deflects between {x.min():.4g} and {x.max():.4g} mm.")
    residual = run.energy.relative_residual
    audit = "" if residual is None else f", relative energy residual {abs(residual):.1e}"
    sentences.append(f"Run: {run.outcome.value} at {run.t_end:g} s{audit}.")
    return " ".join(sentences)


def _sticking(run: Trajectory, found: Behaviour) -> str:
    count = len(found.sticks)
    if not count:
        return f"The pads never stick: the least slip is {run['slip'].min():.4g} m/s."
    first, last = 1e3 * found.sticks[0], 1e3 * found.sticks[-1]
    if count == 1:
        return f"1 stick, after {first:.6g} ms; then the pads slide on."
    times = f"{count} sticks, the first after {first:.6g} ms"
    if found.frequency is None or found.stuck is None:
        return f"{times}, the last after {last:.6g} ms; then the pads slide on."
    return (
        f"{times}; the pads go on sticking at {found.frequency:.6g} Hz, stuck for "
        f"{found.stuck:.0%} of the time (from the last {min(CYCLES, count - 1)} intervals "
        "between sticks)."
    )
