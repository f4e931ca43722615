"""Mode shapes, energies and participation at named junctions and elements."""

import itertools
import math

import numpy
import pytest
import sympy

from bondgraph import TF, C, I, One, R, Se, Zero, assemble, linearize, models
from bondgraph.linear import modal_table
from bondgraph.linear.shapes import ModeShape

from .graphs import SYSTEMS, algebraic, driven, unseen


def chain(count=3, damping=0.0):
    """Equal masses between walls, springs of one between all; drawn with 0-junctions for the springs."""
    masses = [One(f"v{k}") for k in range(count)]
    parts = [
        v >> (I(f"m{k}", 1), *([R(f"b{k}", damping)] * bool(damping))) for k, v in enumerate(masses)
    ]
    parts.append(masses[0] >> C("k_first", 1))
    for k, (a, b) in enumerate(itertools.pairwise(masses)):
        node = Zero(f"n{k}")
        parts += [a >> node >> b, node >> C(f"k{k}", 1)]
    parts.append(masses[-1] >> C("k_last", 1))
    return linearize(assemble("chain", *parts))


def moving(shapes):
    return [shape for shape in shapes if abs(shape.pole) > 1e-6]


class TestShapes:
    def test_a_chain_of_masses_swings_in_sines(self):
        shapes = moving(chain().mode_shapes())
        assert len(shapes) == 6
        for number, shape in zip((3, 2, 1), shapes[:3], strict=True):
            assert abs(shape.pole) == pytest.approx(2 * math.sin(number * math.pi / 8))
            sines = numpy.array([math.sin(number * k * math.pi / 4) for k in (1, 2, 3)])
            found = numpy.array([shape.flows[f"v{k}"] for k in range(3)])
            expected = sines / sines[numpy.argmax(abs(sines) > abs(sines).max() - 1e-9)]
            assert found == pytest.approx(expected, abs=1e-9)

    def test_efforts_have_a_scale_of_their_own(self):
        """The springs between see differences: in the slow mode they are alike and opposite."""
        slow = moving(chain().mode_shapes())[2]
        assert slow.efforts["n0"] == pytest.approx(1) and slow.efforts["n1"] == pytest.approx(-1)
        assert (slow.magnitude("n1"), slow.phase("n1")) == (pytest.approx(1), pytest.approx(180))
        assert slow.flows["v1"] == pytest.approx(1)

    def test_displacement_is_flow_over_pole(self):
        shape = driven().mode_shapes()[0]
        assert shape.flows == {"v": 1}
        assert shape.displacements["v"] == pytest.approx(1 / shape.pole)
        still = unseen().mode_shapes()[0]
        assert still.pole == 0 and math.isnan(abs(still.displacements["v"]))

    def test_a_lever_between(self):
        """What a transformer imposes shows: the far side moves n times as much, the other way round."""
        near, far = One("near"), One("far")
        graph = assemble(
            "lever", near >> (I("m", 1), C("k", 1)), near >> TF("n", 4) >> far, far >> R("b", 0.01)
        )
        shape = linearize(graph).mode_shapes()[0]
        assert abs(shape.flows["near"] / shape.flows["far"]) == pytest.approx(1 / 4)

    def test_of_eigenvectors_by_finite_differences(self):
        """Flows along an eigenvector of the brake, from the model's own ports at nearby states."""
        graph = models.bicycle_brake.graph()
        system = linearize(graph)
        pole, vector = system.poles()[1], system.shapes()[:, 1]
        ports = ("rear.caliper.f", "wheel.hub.f", "wheel.windup.f")
        seen = linearize(graph).with_outputs(*ports)
        flows = seen.C[-3:] @ vector
        shape = system.mode_shapes()[1]
        assert shape.pole == pole
        found = [shape.flows[name.removesuffix(".f")] for name in ports]
        ratio = flows / found
        assert ratio == pytest.approx(numpy.full(3, ratio[1]), rel=1e-6)

    def test_what_is_rounding_does_not_move(self):
        """A stuck brake is free to rest under a twist: nothing moves there, all is stress."""
        graph = models.bicycle_brake.graph()
        stuck = linearize(graph, {"V0": 0}, modes={"friction": "stick"})
        rest = stuck.mode_shapes()[0]
        assert rest.pole == 0 and set(rest.flows.values()) == {0}
        assert rest.efforts["pads"] == 1 and rest.efforts["wheel.torque"] == pytest.approx(0.08)

    def test_algebraic_variables_follow(self):
        (shape,) = algebraic().mode_shapes()
        assert shape.flows == {"i": 1}

    def test_units_and_what_is_largest_of_each(self):
        shape = linearize(models.bicycle_brake.graph()).mode_shapes()[3]
        assert shape.units["rear.caliper"] == "m/s" and shape.units["wheel.hub"] == "rad/s"
        assert shape.units["pads"] == "N"
        turning = [abs(v) for n, v in shape.within_unit().items() if shape.units[n] == "rad/s"]
        assert max(turning) == pytest.approx(1)

    def test_nothing_moves_and_nothing_is_there(self):
        u = sympy.Symbol("u")
        bare = assemble("g", Se("s", u) >> One("v") >> R("r", 2), inputs=[u])
        assert linearize(bare).mode_shapes() == ()
        still = ModeShape(0j, {"v": 0j}, {}, {"v": "m/s"})
        assert still.within_unit() == {"v": 0} and still.phase("v") == 0

    @pytest.mark.parametrize("name", SYSTEMS)
    def test_largest_is_one(self, name):
        for shape in SYSTEMS[name]().mode_shapes():
            for part in (shape.flows, shape.efforts):
                largest = max(map(abs, part.values()), default=0)
                assert largest == 0 or largest == pytest.approx(1)


class TestEnergies:
    @pytest.mark.parametrize("name", SYSTEMS)
    def test_shares_sum_to_one_and_feeds_to_the_growth(self, name):
        for mode in SYSTEMS[name]().modes():
            if mode.energies:
                assert sum(mode.energies.values()) == pytest.approx(1)
                size = abs(mode.eigenvalue)
                assert sum(mode.feeds.values()) == pytest.approx(
                    mode.eigenvalue.real, abs=1e-8 * size
                )
            assert sum(mode.carriers.values()) == pytest.approx(1)

    def test_a_damped_chain_is_drained_by_each_damper_as_it_moves(self):
        slow = chain(damping=0.02).modes()
        mode = next(m for m in slow if m.eigenvalue.imag > 0 and abs(m.eigenvalue) < 1)
        assert mode.feeds["b1"] / mode.feeds["b0"] == pytest.approx(2)
        assert sum(mode.energies[f"m{k}"] for k in range(3)) == pytest.approx(0.5, abs=1e-3)

    def test_the_method_is_the_table(self):
        system = driven()
        assert system.modes() == modal_table(system)


class TestDamping:
    def test_rows(self):
        system = linearize(models.quarter_car.graph())
        rows = system.damping_table()
        natural, zeta, poles = system.damp()
        assert [row.pole for row in rows] == list(poles)
        assert [row.natural_frequency for row in rows] == pytest.approx(natural)
        assert [row.damping_ratio for row in rows] == pytest.approx(zeta)
        assert set(rows[0].elements) == {"sprung", "spring"}
        assert set(rows[-1].elements) == {"unsprung", "tyre"}
        assert rows[0].frequency_hz == pytest.approx(abs(poles[0].imag) / 2 / math.pi)
        assert rows[0].time_constant == pytest.approx(-1 / poles[0].real)

    def test_a_pole_at_zero(self):
        row = unseen().damping_table()[0]
        assert row.damping_ratio is None and row.time_constant == math.inf
        assert row.elements == ("far",)

    def test_participation_of_elements(self):
        system = linearize(models.bicycle_brake.graph())
        shares = system.element_participation()
        assert set(shares) == {
            "wheel.rotor",
            "wheel.spokes",
            "rear.mass",
            "rear.bending",
            "line.fluid",
        }
        assert sum(shares.values()) == pytest.approx(numpy.ones(5))
