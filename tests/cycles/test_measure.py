"""Cycles read off runs, against closed forms and the brake's independent numbers."""

import math

import numpy
import pytest

from bondgraph import C, I, One, assemble, limit_cycle, models, simulate
from bondgraph.errors import ParameterError, SimulationError

from .graphs import SLIP, STICK, VAN_DER_POL_PERIOD, belt, belt_swing, driven, van_der_pol


@pytest.fixture(scope="module")
def squeal():
    """Fig 8 of the brake's paper; numbers from a solver of its own, see docs/brake.md."""
    return simulate(models.bicycle_brake.graph(), 0.5, {"mu_s": 0.5, "tau": 0.02}, rtol=1e-9)


def test_brake_limit_cycle(squeal):
    cycle = limit_cycle(squeal)
    assert cycle.frequency_hz == pytest.approx(143.318344, abs=1e-6)
    assert cycle.settled and cycle.scatter < 1e-10
    assert cycle.held["friction"] == pytest.approx(0.65, abs=0.005)
    assert cycle.events_per_period == 2
    swing = cycle.amplitude("x_c")
    assert swing.least == pytest.approx(1.63360e-3, abs=5e-9)
    assert swing.most == pytest.approx(3.66899e-3, abs=5e-9)
    assert swing.least < swing.mean < swing.most
    assert swing.peak_to_peak == swing.most - swing.least


def test_slip_sensitive_brake_settles_late():
    run = simulate(
        models.bicycle_brake.graph(), 1.0, {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2}, rtol=1e-9
    )
    assert limit_cycle(run).frequency_hz == pytest.approx(142.614178, abs=1e-5)
    early = limit_cycle(run, periods=120, tolerance=1e-6)
    assert not early.settled and early.drift > 0


def test_belt_closed_form():
    cycle = limit_cycle(simulate(belt(), 20, rtol=1e-9))
    assert cycle.period == pytest.approx(SLIP + STICK, abs=1e-8)
    assert cycle.held["contact"] * cycle.period == pytest.approx(STICK, abs=1e-8)
    swing = cycle.amplitude("k.q")
    assert (swing.least, swing.most) == pytest.approx(belt_swing(), abs=1e-7)


def test_any_mode_may_begin_a_period():
    run = simulate(belt(), 20, rtol=1e-9)
    cycle = limit_cycle(run, "contact", "slip+")
    assert cycle.period == pytest.approx(SLIP + STICK, abs=1e-8)
    assert cycle.times[-1] - limit_cycle(run).times[-1] == pytest.approx(STICK, abs=1e-8)


def test_without_events_a_section_is_taken():
    run = simulate(van_der_pol(), 60, initial={"c.q": 2}, rtol=1e-10)
    for signal, value in ((None, None), ("c.q", 0.5), ("r.e", 0.0)):
        cycle = limit_cycle(run, signal=signal, value=value)
        assert cycle.period == pytest.approx(VAN_DER_POL_PERIOD, abs=1e-8)
        assert cycle.settled and not cycle.held


def test_a_cycle_that_passes_its_mark_twice_is_one_cycle():
    graph, response = driven()

    def push(t):
        return math.cos(3 * t) + 12 * math.cos(6 * t)

    x = response(3) * 1 + 0j, response(6) * 12
    speeds = 3j * x[0], 6j * x[1]
    start = {"k.q": sum(x).real, "m.p": 2 * sum(speeds).real}
    run = simulate(graph, 40, initial=start, inputs={"push": push}, rtol=1e-10)
    cycle = limit_cycle(run, signal="k.q", value=0.0)
    assert cycle.marks_per_period == 2
    assert cycle.period == pytest.approx(2 * math.pi / 3, rel=1e-7)


def test_extremes_between_rows_are_those_of_a_parabola():
    graph = assemble("swing", One("v") >> (I("m", 1), C("k", 1, initial=1)))
    grid = numpy.linspace(0, 40, 110)
    run = simulate(graph, 40, t_eval=grid, rtol=1e-10)
    swing = limit_cycle(run, signal="k.q", periods=1).amplitude("k.q")
    late = run["k.q"][grid > 40 - 2 * math.pi]
    assert 1 - late.max() > 4e-3  # no row comes near the top
    assert (swing.least, swing.most) == pytest.approx((-1, 1), abs=1e-3)


def test_too_short_a_run_is_refused(squeal):
    short = simulate(models.bicycle_brake.graph(), 0.02, {"mu_s": 0.5, "tau": 0.02})
    with pytest.raises(SimulationError, match=r"enters .stick. 3 times up to .*three periods"):
        limit_cycle(short)
    with pytest.raises(SimulationError, match="never enters mode 'slip-'"):
        limit_cycle(squeal, "friction", "slip-")
    with pytest.raises(ParameterError, match="'fraction' is not known; did you mean friction"):
        limit_cycle(squeal, "fraction")
    with pytest.raises(SimulationError, match="periods is 0"):
        limit_cycle(squeal, periods=0)
