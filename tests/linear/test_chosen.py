"""Units, and inputs and outputs that were not declared."""

import numpy
import pytest
import sympy

from bondgraph import C, I, One, R, Se, Sf, assemble, linearize, models, steady_state
from bondgraph.errors import ParameterError

from .graphs import algebraic, driven, following


class TestUnits:
    def test_declared_and_inferred(self):
        system = linearize(models.quarter_car.graph())
        assert dict(zip(system.states, system.state_units, strict=True)) == {
            "tyre.q": "m", "unsprung.p": "N*s", "spring.q": "m", "sprung.p": "N*s"
        }  # fmt: skip
        assert system.input_units == ("m/s",)
        assert system.output_units == ("m/s", "m/s^2", "m", "m")

    def test_of_rates_and_ports(self):
        system = following().with_outputs("v.f", "k.q")
        assert system.input_units == ("m/s", "m/s/s")
        assert system.output_units[-2:] == ("m/s", "m")

    def test_not_known(self):
        system = linearize(assemble("g", One("v") >> (I("m", 1), R("b", 2))))
        assert system.state_units == ("",)


class TestOutputs:
    def test_states_and_ports(self):
        system = driven().with_outputs("m.p", "b.e", "x")
        assert system.outputs == ("x", "a", "v", "m.p", "b.e")
        assert system.C[3:].tolist() == [[1, 0], [0.25, 0]] and not system.D[3:].any()
        assert system.with_outputs("m.p") is system
        with pytest.raises(ParameterError, match=r"'m\.q' is not known"):
            driven().with_outputs("m.q")

    def test_direct_parts_and_algebraic_variables(self):
        system = algebraic().with_outputs("hard.f", "hard.e")
        assert system.C[2] == pytest.approx(system.C[1]) and system.D[2] == pytest.approx(
            system.D[1]
        )
        assert system.C[3] == pytest.approx([-2]) and system.D[3] == pytest.approx([1])

    def test_names_that_control_takes(self):
        other = driven().with_outputs("b.e").to_control()
        assert other.output_labels[-1] == "b_e"


class TestInputs:
    def test_a_parameter_like_an_input(self):
        """What linearize finds for a declared input is what it finds for a parameter."""
        F, k = sympy.symbols("F k", positive=True)

        def system(**kind):
            spring = C("spring", effort=lambda q: k * q + q**3)
            graph = assemble("g", Se("push", F) >> One("v") >> (I("m", 2), spring, R("b", 1)),
                             outputs={"x": spring.q, "both": spring.q + F}, **kind)  # fmt: skip
            return graph

        declared = linearize(system(inputs=[F], parameters={k: 3}), inputs={"F": 4})
        found = linearize(system(parameters={k: 3, F: (4, "N")})).with_inputs("F")
        assert found.inputs == ("F",) and found.input_units == ("N",)
        for name in "ABCD":
            assert getattr(found, name) == pytest.approx(getattr(declared, name))
        both = found.with_inputs(k).with_outputs("spring.e")
        assert both.inputs == ("F", "k") and both.D.shape == (3, 2)
        assert both.D[2] == pytest.approx([0, 1])  # at q = 1, e = k q + q^3

    @pytest.mark.parametrize("name", ["mu_s", "omega_t", "p_l"])
    def test_gains_are_slopes_of_the_steady_state(self, name):
        graph = models.bicycle_brake.graph()
        system = linearize(graph).with_inputs(name)
        value = system.at.parameters[name]
        high, low = (
            steady_state(graph, {name: value * (1 + step)}).outputs for step in (1e-5, -1e-5)
        )
        slopes = [(high[out] - low[out]) / (2e-5 * value) for out in system.outputs]
        assert system.dcgain()[:, 0] == pytest.approx(slopes, rel=1e-4, abs=1e-9)

    def test_derived_parameters_follow_unless_given(self):
        m, size, F = sympy.symbols("m size F", positive=True)
        mass = I("mass", m)
        graph = assemble("g", Se("push", F) >> One("v") >> (mass, R("b", size)),
                         parameters={size: 3, m: size**2, F: 6}, outputs={"v": mass.f})  # fmt: skip
        follows = linearize(graph, at={"mass.p": 2}).with_inputs("size")
        # dp/dt = F - size p / size^2 = F - p / size
        assert pytest.approx(numpy.array([[2 / 9]])) == follows.B
        assert pytest.approx(numpy.array([[-2 * 2 / 27]])) == follows.D
        given = linearize(graph, {"m": 5}, at={"mass.p": 2}).with_inputs("size")
        assert pytest.approx(numpy.array([[-2 / 5]])) == given.B and given.D.tolist() == [[0]]

    def test_names_are_checked(self):
        with pytest.raises(ParameterError, match="parameter 'mu' is not known"):
            linearize(models.bicycle_brake.graph()).with_inputs("mu")

    def test_where_rates_are_needed_it_is_refused(self):
        V, m = sympy.symbols("V m", positive=True)
        graph = assemble("g", Sf("s", V) >> One("v") >> (I("mass", m), C("k", 1)),
                         inputs=[V], parameters={m: 2})  # fmt: skip
        with pytest.raises(ParameterError, match="needs the rate of an input"):
            linearize(graph).with_inputs("m")
