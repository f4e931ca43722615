"""Rests, pushes and starts, each against mechanics or averaging by hand."""

import math

import numpy
import pytest

from bondgraph import C, EndStop, I, One, R, Se, assemble, steady_state
from bondgraph.attractors.bench import Bench
from bondgraph.attractors.going_round import onward
from bondgraph.attractors.pushes import averaged_growth, pushes
from bondgraph.attractors.rest import rest_of, sizes_of
from bondgraph.attractors.settle import clock_for
from bondgraph.attractors.starts import held, off_rest, starts_of, still
from bondgraph.models import bicycle_brake, mass_on_belt

from . import brakes


def oscillator(law):
    return assemble("oscillator", One("l") >> (I("L", 1), C("c", 1), R("r", effort=law)))


def prepared(graph, parameters=None):
    bench = Bench(graph)
    values = bench.values(parameters)
    rest = rest_of(bench, values)
    own = bench.start(values)
    sizes = sizes_of(bench, values, numpy.array([own, rest.vector]))
    return bench, values, rest, pushes(rest, own, sizes)


class TestRest:
    @pytest.mark.parametrize("given", [{"mu_s": 0.42}, {"mu_s": 0.5, "v_s": 0.2, "tau": 0.06}])
    def test_is_the_steady_state(self, given):
        graph = bicycle_brake.graph()
        _, _, rest, _ = prepared(graph, given)
        point = steady_state(graph, given)
        assert rest.modes == point.modes
        assert rest.outputs == pytest.approx(point.outputs, rel=1e-9, abs=1e-12)
        assert rest.states == pytest.approx(point.states, rel=1e-9, abs=1e-15)

    def test_eigenvectors_are_each_others_inverse(self):
        _, _, rest, _ = prepared(bicycle_brake.graph())
        assert rest.left.T @ rest.shapes == pytest.approx(numpy.eye(5), abs=1e-9)

    def test_a_drifting_state_has_no_eigenvalue(self):
        parts = (I("m", 2), C("place", stiffness=0), R("b", 4))
        bench, _, rest, _ = prepared(assemble("cart", Se("F", 6) >> One("v") >> parts))
        assert bench.free == {"place.q"} and rest.poles.tolist() == [-2.0]
        assert rest.states["m.p"] == pytest.approx(3.0) and rest.stable and rest.isolated

    def test_rounding_has_no_size(self):
        bench, values, rest, _ = prepared(bicycle_brake.graph())
        sizes = dict(zip(bench.names, sizes_of(bench, values, rest.vector[None, :]), strict=True))
        assert abs(rest.states["rear.mass.p"]) < 1e-20 < 1e-8 < sizes["rear.mass.p"] < 1e-4


class TestPushes:
    @pytest.mark.parametrize("size", [0.1, 1.0, 2.0, 3.0])
    def test_averaged_growth_of_van_der_pol(self, size):
        mu = 0.2
        _, _, rest, _ = prepared(oscillator(lambda f: mu * (f**3 / 3 - f)))
        # about the linear part; L.p = size cos(phase) where the vector's entry for it is one
        index = int(numpy.argmax(rest.poles.imag))
        place = rest.chart.states.index("L.p")
        vector = rest.shapes[:, index] / rest.shapes[place, index]
        growth, _ = averaged_growth(rest, index, vector, size)
        assert growth == pytest.approx(mu / 2 * (1 - size**2 / 4), abs=2e-2 * mu * max(size, 1))

    def test_crossings_of_a_subcritical_oscillator(self):
        _, _, _, (push,) = prepared(oscillator(lambda f: f * (0.1 - f**2 + 0.3 * f**4)))
        largest = abs(push.vector).max()
        squares = sorted(numpy.roots([3 / 16, -3 / 4, 0.1]))
        found = [size * largest for size, _ in push.crossings]
        assert found == pytest.approx(numpy.sqrt(squares), rel=0.1)
        assert [falls for _, falls in push.crossings] == [False, True]

    def test_a_push_brings_the_pads_to_stick(self):
        bench, _, rest, along = prepared(bicycle_brake.graph())
        for push in along:
            x = dict(zip(bench.names, rest.at(push.change(push.touch)), strict=True))
            p = brakes.brake()
            rotor = 0.08 * x["wheel.rotor.p"] / (p["m_w"] * 0.08**2)
            assert push.contact == "friction"
            assert rotor - x["rear.mass.p"] / p["m_f"] == pytest.approx(0.0, abs=1e-6)

    def test_a_push_at_a_stop_begins_before_it(self):
        spring, v = C("spring", stiffness=100), One("v")
        stop = EndStop("stop", gap=0.3 - spring.q, restitution=0.5)
        graph = assemble("stopped", v >> (I("m", 1), spring, R("b", 0.1)), v >> stop)
        bench, _, rest, (push,) = prepared(graph)
        x = dict(zip(bench.names, rest.at(push.change(push.touch)), strict=True))
        # full speed towards the stop, half way through the swing that touches it
        assert push.contact == "stop" and x["spring.q"] == pytest.approx(0.0, abs=2e-3)
        assert x["m.p"] == pytest.approx(3.0, rel=1e-2)


class TestStarts:
    def test_a_blow_keeps_momentum(self):
        bench, values, rest, _ = prepared(bicycle_brake.graph())
        x = dict(zip(bench.names, held(bench, values, rest), strict=True))
        p = brakes.brake()
        shared = p["m_w"] * 0.9 / (p["m_w"] + p["m_f"])
        assert x["rear.mass.p"] == pytest.approx(p["m_f"] * shared, rel=1e-9)
        assert x["wheel.rotor.p"] == pytest.approx(p["m_w"] * 0.08 * shared, rel=1e-9)
        assert x["rear.bending.q"] == pytest.approx(rest.states["rear.bending.q"])

    def test_still_keeps_deflections(self):
        bench, _, rest, _ = prepared(bicycle_brake.graph())
        x = dict(zip(bench.names, still(bench, rest), strict=True))
        assert x["wheel.rotor.p"] == 0.0
        assert x["wheel.spokes.q"] == rest.states["wheel.spokes.q"]

    def test_nothing_to_seize_or_stop(self):
        bench, values, rest, _ = prepared(oscillator(lambda f: f / 10))
        assert held(bench, values, rest) is None and still(bench, rest) is None

    def test_an_unstable_rest_is_left(self):
        _, _, rest, along = prepared(oscillator(lambda f: f**3 - f))
        moved = off_rest(rest.vector, rest, along)
        assert numpy.abs(moved).max() > 0
        other = numpy.array([1.0, 0.0])
        assert off_rest(other, rest, along) is other

    def test_a_stable_one_is_not(self):
        _, _, rest, along = prepared(oscillator(lambda f: f / 10))
        assert off_rest(rest.vector, rest, along) is not None
        assert (off_rest(rest.vector, rest, along) == rest.vector).all()

    def test_own_comes_first(self):
        bench, values, rest, along = prepared(mass_on_belt.graph())
        names = list(starts_of(bench, values, rest, along, {"mine": {"v": 0.2}}))
        assert names[:2] == ["own", "mine"] and "held" in names


def test_lengths_come_from_the_eigenvalues():
    clock = clock_for(numpy.array([-1 + 10j, -1 - 10j]), None, until=math.inf)
    assert clock.first == pytest.approx(12 * 2 * math.pi / 10)
    assert clock.horizon == pytest.approx(600 * 2 * math.pi / 10)
    assert clock_for(numpy.array([-1.0 + 0j]), 5.0, until=math.inf).horizon == 5.0
    assert clock_for(numpy.zeros(0), None, until=math.inf).first > 0


def test_angles_go_on_and_vibrations_do_not():
    class Run:
        t = numpy.linspace(0, 10, 500)
        x = numpy.array([2 * t + numpy.sin(5 * t), numpy.sin(5 * t), numpy.zeros(500)])

    assert onward(Run, numpy.ones(3)).tolist() == [True, False, False]
