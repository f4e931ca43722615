"""Responses against closed forms, their grids, and what has no answer."""

import numpy
import pytest
import sympy

from bondgraph import C, I, One, R, Se, assemble, linearize, models
from bondgraph.errors import BondGraphError, ParameterError

from .graphs import driven, floating, following, unseen


class TestStep:
    def test_closed_form(self):
        """x of 2 x'' + 0.5 x' + 8 x = 1, with its overshoot."""
        found = driven().step_response()
        t, decay, turn = found.time, 0.125, numpy.sqrt(4 - 0.125**2)
        expected = (
            1 - numpy.exp(-decay * t) * (numpy.cos(turn * t) + decay / turn * numpy.sin(turn * t))
        ) / 8
        assert found["x", "F"] == pytest.approx(expected, abs=1e-13)
        assert found["a", "F"][0] == 0.5 and found["x", "F"][0] == 0
        assert (found.kind, found.unit("x", "F"), found.input_units) == ("step", "m", ("N",))
        assert not found.direct.any()

    def test_given_times(self):
        times = [0.5, 0.7, 3.0]
        found = driven().step_response(times)
        fine = driven().step_response(numpy.linspace(0, 3, 301))
        assert found["x", "F"] == pytest.approx(fine["x", "F"][[50, 70, 300]], rel=1e-12)
        assert found.time.tolist() == times

    @pytest.mark.parametrize("times", [[1, 0], [-1, 0], [0, 0], [], [0, numpy.nan], [[0, 1]]])
    def test_times_that_are_none(self, times):
        with pytest.raises(BondGraphError, match="increasing and not negative"):
            driven().step_response(times)

    def test_where_the_rate_of_the_input_is_needed(self):
        """A step of the speed: force 3 t, and the mass takes a blow of 2 N s; the tank leaks 2/2 e^-t/2."""
        found = following().step_response([0.0, 0.5, 4.0])
        assert found["force", "V"] == pytest.approx([0, 1.5, 12])
        assert found["p", "V"] == pytest.approx(numpy.exp(-found.time / 2))
        assert found.direct.tolist() == [[2], [0]]
        assert found.inputs == ("V",)

    def test_overflow_is_said(self):
        law = R("r", effort=lambda f: -3 * f)
        F = sympy.Symbol("F")
        mass = I("m", 1)
        graph = assemble("up", Se("push", F) >> One("v") >> (mass, law), inputs={F: "N"},
                         outputs={"v": mass.f})  # fmt: skip
        found = linearize(graph).step_response()
        assert found["v", "F"][-1] == pytest.approx((1000 - 1) / 3)
        with pytest.raises(BondGraphError, match=r"overflows between t = 0 s and 1000 s"):
            linearize(graph).step_response([0, 1000])


class TestImpulse:
    def test_closed_form(self):
        found = driven().impulse_response()
        t, turn = found.time, numpy.sqrt(4 - 0.125**2)
        expected = numpy.exp(-0.125 * t) * numpy.sin(turn * t) / turn / 2
        assert found["x", "F"] == pytest.approx(expected, abs=1e-13)
        assert found.direct.tolist() == [[0], [0.5], [0]]

    def test_is_the_slope_of_the_step(self):
        times = numpy.linspace(0, 2, 2001)
        step, impulse = driven().step_response(times), driven().impulse_response(times)
        slope = numpy.gradient(step["x", "F"], times)
        assert impulse["x", "F"][1:-1] == pytest.approx(slope[1:-1], abs=1e-6)

    def test_worse_than_an_impulse_is_refused(self):
        with pytest.raises(BondGraphError, match="worse than an impulse"):
            following().impulse_response()


class TestFrequency:
    def test_closed_form(self):
        found = driven().frequency_response([0.0, 1.0, 2.0])
        s = 1j * found.omega
        assert found["x", "F"] == pytest.approx(1 / (2 * s**2 + 0.5 * s + 8))
        assert found.unit("x", "F") == "m/N" and found.unit("a", "F") == "(m/s^2)/N"
        assert found.phase("x", "F") == pytest.approx(
            [0, -numpy.degrees(numpy.arctan2(0.5, 6)), -90]
        )
        assert found.frequency_hz == pytest.approx(found.omega / 2 / numpy.pi)

    def test_rate_of_the_input_is_s_times_the_input(self):
        found = following().frequency_response([0.5, 2.0])
        s = 1j * found.omega
        assert found["force", "V"] == pytest.approx(2 * s + 3 / s)
        assert found["p", "V"] == pytest.approx(2 * s / (1 + 2 * s))

    def test_at_a_pole_it_is_infinite(self):
        found = floating().frequency_response([0.0, 1.0])
        assert numpy.isinf(found["x", "F"][0]) and numpy.isfinite(found["x", "F"][1])
        assert numpy.isnan(found.phase("x", "F")[0])
        assert found["v", "F"][0] == pytest.approx(0.25)  # does not see that pole

    def test_phases_do_not_jump(self):
        found = linearize(models.quarter_car.graph()).frequency_response()
        phase = found.phase("v_body", "v_road")
        assert abs(numpy.diff(phase)).max() < 60
        assert phase[-1] == pytest.approx(-270, abs=5)

    def test_a_light_resonance_is_met(self):
        F = sympy.Symbol("F")
        spring = C("k", stiffness=100)
        graph = assemble("bell", Se("push", F) >> One("v") >> (I("m", 1), spring, R("b", 1e-4)),
                         inputs={F: "N"}, outputs={"x": spring.q})  # fmt: skip
        found = linearize(graph).frequency_response()
        assert found.magnitude("x", "F").max() == pytest.approx(1 / (1e-4 * 10), rel=1e-3)

    @pytest.mark.parametrize("omega", [[-1.0], [], [numpy.inf]])
    def test_frequencies_that_are_none(self, omega):
        with pytest.raises(BondGraphError, match="frequencies must be"):
            driven().frequency_response(omega)


class TestGrids:
    def test_decay_is_seen_and_periods_too(self):
        found = driven().step_response()
        assert found.time[-1] == pytest.approx(numpy.log(1000) / 0.125)
        assert numpy.diff(found.time)[0] < 2 * numpy.pi / 2 / 20

    def test_free_states_do_not_stretch_it(self):
        assert unseen().step_response().time[-1] == pytest.approx(numpy.log(1000) / 1.5)

    def test_frequencies_keep_off_undamped_poles(self):
        F, spring = sympy.Symbol("F"), C("k", stiffness=3)
        graph = assemble("free", Se("push", F) >> One("v") >> (I("m", 0.7), spring),
                         inputs={F: "N"}, outputs={"x": spring.q})  # fmt: skip
        found = linearize(graph).frequency_response()
        expected = 1 / (3 - 0.7 * found.omega**2)
        assert found["x", "F"].real == pytest.approx(expected, rel=1e-6)
        assert abs(expected).max() > 100 / 3

    def test_no_states_at_all(self):
        u = sympy.Symbol("u")
        load = R("r", 2)
        graph = assemble("g", Se("s", u) >> One("v") >> load, inputs=[u], outputs={"i": load.f})
        system = linearize(graph)
        assert (system.step_response()["i", "u"] == 0.5).all()
        assert (system.frequency_response()["i", "u"] == 0.5).all()
        assert system.zeros().size == 0 and system.dcgain().tolist() == [[0.5]]
        assert str(system.transfer_function("i", "u")) == "(0.5) / (1)"
        assert system.impulse_response().direct.tolist() == [[0.5]]


class TestNames:
    @pytest.mark.parametrize(
        "ask",
        [
            lambda s: s.step_response(),
            lambda s: s.impulse_response(),
            lambda s: s.frequency_response(),
            lambda s: s.zeros(),
            lambda s: s.dcgain(),
            lambda s: s.transfer_function("x", "F"),
        ],
    )
    def test_without_inputs_or_outputs_it_is_said_what_to_do(self, ask):
        with pytest.raises(BondGraphError, match=r"no inputs.*declare.*with_inputs"):
            ask(linearize(models.mass_on_belt.graph()))
        F = sympy.Symbol("F")
        bare = assemble("bare", Se("push", F) >> One("v") >> I("m", 1), inputs=[F])
        with pytest.raises(BondGraphError, match=r"no outputs.*with_outputs\('m.p'\)"):
            ask(linearize(bare))

    def test_names_are_checked(self):
        system = driven()
        with pytest.raises(ParameterError, match="output comes first"):
            system.transfer_function("F", "x")
        with pytest.raises(ParameterError, match="output 'y' is not known"):
            system.zeros("y", "F")
        with pytest.raises(ParameterError, match="both, or none"):
            system.zeros("x")
        with pytest.raises(ParameterError, match="input 'G' is not known"):
            system.step_response()["x", "G"]
