"""Periodic orbits and their multipliers, against closed forms and scipy."""

import math

import numpy
import pytest
import sympy

from bondgraph import (
    C,
    CompiledModel,
    Diode,
    I,
    One,
    R,
    Samples,
    Se,
    Zero,
    assemble,
    models,
    periodic_orbit,
    simulate,
)
from bondgraph.errors import SimulationError

from .graphs import (
    SLIP,
    STICK,
    VAN_DER_POL_PERIOD,
    belt,
    driven,
    van_der_pol,
    van_der_pol_multiplier,
)


def test_van_der_pol():
    orbit = periodic_orbit(van_der_pol(), {"c.q": 2.0, "L.p": 0.0}, period=6.5)
    assert orbit.period == pytest.approx(VAN_DER_POL_PERIOD, abs=1e-9)
    assert orbit.verdict == "stable" and orbit.floquet.zeros == 0 and orbit.notes == ()
    assert orbit.floquet.trivial_error < 1e-6
    assert orbit.floquet.others.real == pytest.approx(van_der_pol_multiplier(), rel=1e-5)


def test_an_orbit_that_repels_is_found_too():
    """Time backwards: the multiplier is one over that of the stable orbit."""
    orbit = periodic_orbit(van_der_pol(-1), {"c.q": 2.1, "L.p": 0.2}, period=6.6)
    assert orbit.period == pytest.approx(VAN_DER_POL_PERIOD, abs=1e-8)
    assert orbit.verdict == "unstable" and not orbit.stable
    assert orbit.multipliers[0].real == pytest.approx(1 / van_der_pol_multiplier(), rel=1e-4)


def test_belt():
    run = simulate(belt(), 20, rtol=1e-9)
    orbit = periodic_orbit(None, run)
    assert orbit.period == pytest.approx(SLIP + STICK, abs=1e-9)
    assert orbit.floquet.zeros == 1 and orbit.stable
    assert orbit.notes[0].startswith("1 of 2 multipliers is zero: while contact holds its flow")
    assert [event.to_mode for event in orbit.run.events] == ["stick", "slip+"]


@pytest.mark.parametrize(
    ("changed", "frequency"),
    [({"tau": 0.02}, 143.318344), ({"tau": 0.06, "v_s": 0.2}, 142.614178)],
    ids=["fig8", "fig9"],
)
def test_brake(changed, frequency):
    """From 0.5 s, at which Fig 9's cycle is 0.005 Hz away, shooting lands on the settled one."""
    run = simulate(models.bicycle_brake.graph(), 0.5, {"mu_s": 0.5, **changed}, rtol=1e-9)
    orbit = periodic_orbit(None, run)
    assert orbit.frequency_hz == pytest.approx(frequency, abs=1e-6)
    assert orbit.stable and orbit.floquet.zeros == 1
    # the lever's line hears nothing of the rest: its own decay over a period
    own = math.exp(-orbit.period / changed["tau"])
    assert abs(orbit.multipliers - own).min() < 1e-6


def test_forced_linear_oscillator():
    graph, response = driven()
    omega = 3.0
    orbit = periodic_orbit(
        CompiledModel(graph),
        {"k.q": 0.0, "m.p": 0.0},
        2 * math.pi / omega,
        inputs={"push": lambda t: math.cos(omega * t)},
        forced=True,
        rtol=1e-10,
    )
    x = response(omega)
    assert orbit.start["k.q"] == pytest.approx(x.real, abs=1e-8)
    assert orbit.start["m.p"] == pytest.approx((2j * omega * x).real, abs=1e-8)
    pole = complex(-0.125, math.sqrt(4 - 0.125**2))
    expected = numpy.exp(pole * orbit.period)
    assert abs(orbit.multipliers - expected).min() < 1e-6
    assert orbit.stable and orbit.floquet.trivial is None
    assert math.isnan(orbit.floquet.trivial_error)


def test_rectifier():
    """A diode in series with a coil: while it blocks, the coil's flux is gone for good."""
    voltage = sympy.Symbol("voltage")
    load = Zero("load")
    graph = assemble(
        "rectifier",
        Se("E", voltage) >> One("in") >> (Diode("d"), I("coil", 0.1), R("r", 0.1), load),
        load >> (C("c", 1.0), R("lamp", 2)),
        inputs=[voltage],
    )
    orbit = periodic_orbit(
        graph, {"c.q": 0.5}, 2 * math.pi, inputs={"voltage": math.cos}, forced=True, rtol=1e-9
    )
    run = simulate(graph, 40 * math.pi, inputs={"voltage": math.cos}, rtol=1e-9)
    assert run.final["c.q"] == pytest.approx(orbit.start["c.q"], abs=1e-7)
    assert orbit.stable and orbit.floquet.zeros == 1 and "while d holds" in orbit.notes[0]
    assert [event.to_mode for event in orbit.run.events] == ["blocking", "conducting"]


def test_through_algebraic_variables():
    """E = f + f**3 + q/c: the multiplier is exp of the integral of -1/(c (1 + 3 f**2))."""
    voltage = sympy.Symbol("voltage")
    parts = (R("odd", effort=lambda f: f + f**3), C("c", 1))
    graph = assemble("odd", Se("E", voltage) >> One("in") >> parts, inputs=[voltage])
    grid = numpy.linspace(0, 2 * math.pi, 65)
    push = Samples(grid, numpy.cos(grid))
    orbit = periodic_orbit(
        graph, {"c.q": 0.37}, 2 * math.pi, inputs={"voltage": push}, forced=True, rtol=1e-8
    )
    run = simulate(
        graph, 2 * math.pi, initial=orbit.start, inputs={"voltage": push}, t_eval=grid, rtol=1e-8
    )
    assert run["c.q"][-1] == pytest.approx(run["c.q"][0], abs=1e-7)
    decay = numpy.trapezoid(-1 / (1 + 3 * run["odd.f"] ** 2), grid)
    assert orbit.multipliers[0].real == pytest.approx(math.exp(decay), rel=5e-3)


def test_another_phase_of_the_force():
    graph, response = driven()
    omega, start = 3.0, 0.4
    push = {"push": lambda t: math.cos(omega * t)}
    run = simulate(graph, 12, inputs=push, rtol=1e-8)
    orbit = periodic_orbit(None, run, 2 * math.pi / omega, forced=True, start=start, rtol=1e-10)
    x = response(omega) * numpy.exp(1j * omega * start)
    assert orbit.time == start and orbit.start["k.q"] == pytest.approx(x.real, abs=1e-8)


def test_parameters_and_symbols():
    graph = models.mass_on_belt.graph()
    run = simulate(graph, 20, {"c": 0.0}, rtol=1e-8)
    found = periodic_orbit(None, run)
    again = periodic_orbit(graph, found.start, found.period, {"c": 0.0})
    assert again.period == pytest.approx(found.period, rel=1e-8)


def test_refusals():
    graph = van_der_pol()
    with pytest.raises(SimulationError, match="ran into a steady state"):
        periodic_orbit(graph, {"c.q": 0.0, "L.p": 0.0}, period=6.3)
    with pytest.raises(SimulationError, match="give a guess of it, period"):
        periodic_orbit(graph, {"c.q": 2.0})
    with pytest.raises(SimulationError, match="give the graph too"):
        periodic_orbit(None, {"c.q": 2.0}, 6.0)
    with pytest.raises(SimulationError, match="the period of its input"):
        periodic_orbit(graph, {"c.q": 2.0}, forced=True)
    with pytest.raises(SimulationError, match="period is -1"):
        periodic_orbit(graph, {"c.q": 2.0}, -1.0)


def test_no_orbit_to_be_found():
    graph, _ = driven()
    with pytest.raises(SimulationError, match=r"no periodic orbit found|ran into a steady state"):
        periodic_orbit(graph, {"k.q": 1.0}, period=3.0, inputs={"push": 0.0})
