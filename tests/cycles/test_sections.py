"""Poincaré sections against motions in closed form."""

import math

import numpy
import pytest

from bondgraph import C, I, One, R, assemble, poincare_section, simulate
from bondgraph.errors import ParameterError, SimulationError

from .graphs import SLIP, STICK, belt


def oscillator(damping=0.0):
    parts = (I("m", 1), C("k", 1, initial=1), R("r", damping))
    return assemble("oscillator", One("v") >> parts)


def test_times_and_states_from_few_rows():
    run = simulate(oscillator(), 20, t_eval=numpy.linspace(0, 20, 41), rtol=1e-10)
    found = poincare_section(run, "k.q", 0.5)
    turns = numpy.arange(1, len(found) + 1)
    assert found.times == pytest.approx(2 * math.pi * turns - math.pi / 3, abs=1e-8)
    assert found.states[:, found.names.index("k.q")] == pytest.approx(0.5, abs=1e-8)
    assert found.states[:, found.names.index("m.p")] == pytest.approx(math.sqrt(0.75), abs=1e-8)


@pytest.mark.parametrize(("direction", "count"), [(1, 3), (-1, 3), (0, 6)])
def test_direction(direction, count):
    run = simulate(oscillator(), 19, rtol=1e-8)
    found = poincare_section(run, "k.q", 0.1, direction)
    assert len(found) == count
    slopes = numpy.sign(found.states[:, found.names.index("m.p")])
    assert set(slopes) == ({1, -1} if direction == 0 else {direction})


def test_return_map_contracts_as_the_damping_says():
    run = simulate(oscillator(0.2), 60, rtol=1e-10)
    found = poincare_section(run, "k.q", start=5.0)
    before, after = found.return_map("m.p")
    turn = 2 * math.pi / math.sqrt(1 - 0.01)
    assert found.times[0] > 5 and found.periods == pytest.approx(turn, rel=1e-8)
    assert after / before == pytest.approx(math.exp(-0.1 * turn), rel=1e-7)
    assert found.return_map("m.p", 2)[1] == pytest.approx([*before[2:], after[-1]])


def test_crossings_beside_events():
    """The rows around a crossing lie on both sides of an event: the motion has a corner there."""
    run = simulate(belt(), 20, t_eval=numpy.linspace(0, 20, 201), rtol=1e-10)
    found = poincare_section(run, "k.q", 0.1195, start=2)
    assert found.periods == pytest.approx(SLIP + STICK, abs=1e-7)
    assert found.states[:, found.names.index("k.q")] == pytest.approx(0.1195, abs=1e-8)
    stuck = poincare_section(run, "k.q", 0.08, start=2)  # rises at the belt's speed
    assert stuck.states[:, stuck.names.index("m.p")] == pytest.approx(0.5, abs=1e-9)


def test_a_level_never_passed_is_an_empty_section():
    found = poincare_section(simulate(oscillator(), 10), "k.q", 5.0)
    assert len(found) == 0 and found.states.shape == (0, 2)
    with pytest.raises(SimulationError, match="needs more than 0"):
        found.return_map("m.p")


def test_what_cannot_be_meant_is_refused():
    run = simulate(oscillator(), 10)
    with pytest.raises(SimulationError, match="direction is 2"):
        poincare_section(run, "k.q", 0.0, 2)
    with pytest.raises(ParameterError, match=r"'k\.p' is not known"):
        poincare_section(run, "k.p")
    with pytest.raises(SimulationError, match=r"'k\.f' is no state"):
        poincare_section(run, "k.q").return_map("k.f")
