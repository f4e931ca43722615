"""The matrices of a linear system, its poles, and who takes part in them."""

import math

import numpy
import pytest
import sympy

from bondgraph import (
    C,
    I,
    One,
    R,
    Se,
    Sf,
    assemble,
    linearize,
    models,
)

from .graphs import close, oscillator, pairs

u, v_in = sympy.symbols("u v_in", real=True)
FIG9 = {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2}


class TestMatrices:
    def system(self):
        v = One("v")
        mass, spring = I("m", 2), C("k", stiffness=8)
        graph = assemble(
            "osc",
            Se("F", u) >> v >> (mass, spring, R("b", 0.5)),
            inputs={u: "N"},
            outputs={"x": spring.q, "a": mass.e / 2, "through": 3 * u},
        )
        return linearize(graph)

    def test_a_b_c_d(self):
        system = self.system()
        assert system.states == ("m.p", "k.q")
        assert (system.inputs, system.outputs) == (("u",), ("x", "a", "through"))
        assert system.A.tolist() == [[-0.25, -8], [0.5, 0]]
        assert system.B.tolist() == [[1], [0]]
        assert system.C.tolist() == [[0, 1], [-0.125, -4], [0, 0]]
        assert system.D.tolist() == [[0], [0.5], [3]]

    def test_shows_itself_in_a_line(self):
        system = self.system()
        assert repr(system) == "LinearSystem('osc', 2 states, 1 inputs, 3 outputs)"
        assert repr(system.at) == "SteadyState('osc', states={'m.p': 0.0, 'k.q': 0.0})"
        assert (
            repr(system.at.equations)
            == "Equations('osc', 2 states, 0 algebraic variables, 1 inputs)"
        )

    def test_poles_and_damping(self):
        system = self.system()
        pole = complex(-0.125, math.sqrt(4 - 0.125**2))
        assert close(system.poles(), pairs(pole), 1e-14)
        natural, zeta, poles = system.damp()
        assert close(natural, [2, 2], 1e-14)
        assert close(zeta, [0.0625, 0.0625], 1e-14)
        assert list(poles) == list(system.poles())
        assert system.stable

    def test_poles_come_least_stable_first(self):
        parts = [One(f"v{k}") >> (I(f"m{k}", 1), R(f"b{k}", k)) for k in (3, 1, 2)]
        assert close(linearize(assemble("g", *parts)).poles(), [-1, -2, -3])

    def test_a_pole_at_zero_has_no_damping_ratio(self):
        system = linearize(assemble("g", Se("F", 0) >> One("v") >> I("m", 1)))
        natural, zeta, _ = system.damp()
        assert natural.tolist() == [0]
        assert math.isnan(zeta[0])
        assert not system.stable

    def test_a_graph_without_states(self):
        system = linearize(
            assemble("g", Se("s", u) >> One("v") >> R("r", 2), inputs=[u], outputs={"y": 3 * u})
        )
        assert system.A.shape == (0, 0)
        assert system.D.tolist() == [[3]]
        assert system.poles().size == 0
        assert system.participation().shape == (0, 0)
        assert system.stable

    def test_rates_of_inputs_are_inputs(self):
        system = linearize(
            assemble("g", Sf("s", v_in) >> One("v") >> (I("m", 2), C("k", 1)), inputs=[v_in],
                     outputs={"f": 2 * v_in})
        )  # fmt: skip
        assert system.inputs[0] == "v_in"
        assert system.A.tolist() == [[0]]

    def test_to_control_is_the_same_system(self):
        system = self.system()
        other = system.to_control()
        for name in "ABCD":
            assert numpy.array_equal(getattr(other, name), getattr(system, name))
        assert close(sorted(other.poles(), key=lambda z: -z.imag), system.poles(), 1e-12)
        assert other.output_labels == ["x", "a", "through"]
        response = other(2j)[1, 0]
        expected = (
            system.C @ numpy.linalg.solve(2j * numpy.eye(2) - system.A, system.B) + system.D
        )[1, 0]
        assert response == pytest.approx(expected, rel=1e-12)

    def test_to_control_takes_qualified_names(self):
        assert linearize(models.bicycle_brake.graph()).to_control().nstates == 5


class TestParticipation:
    def test_columns_sum_to_one(self):
        for name in models.LIBRARY:
            shares = linearize(getattr(models, name).graph()).participation()
            assert close(shares.sum(axis=0), numpy.ones(len(shares)), 1e-12)
            assert shares.min() >= 0

    def test_uncoupled_parts_take_part_in_their_own_modes_only(self):
        parts = [One(f"v{k}") >> (I(f"m{k}", 1), R(f"b{k}", k)) for k in (1, 2)]
        assert linearize(assemble("g", *parts)).participation().tolist() == [[1, 0], [0, 1]]

    def test_energy_swings_evenly_between_spring_and_mass(self):
        graph, *_ = oscillator()
        assert close(linearize(graph).participation(), numpy.full((2, 2), 0.5), 1e-12)

    def test_units_do_not_matter(self):
        """A wheel in rad and N m beside a frame in m and N: shares are those of scaled states."""
        plain = linearize(models.bicycle_brake.graph(), FIG9)
        shares = plain.participation()
        scale = numpy.diag([1e6, 1e-6, 1e3, 1e-3, 1e9])
        scaled = scale @ plain.A @ numpy.linalg.inv(scale)
        poles, right = numpy.linalg.eig(scaled)
        left = numpy.linalg.inv(right)
        for column, pole in enumerate(plain.poles()):
            near = numpy.abs(poles - pole).argmin()
            expected = numpy.abs(right[:, near] * left[near])
            assert shares[:, column] == pytest.approx(expected / expected.sum(), abs=1e-6)
