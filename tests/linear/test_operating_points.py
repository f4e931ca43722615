"""Steady states and given points, with contacts in the mode that holds there."""

import math

import numpy
import pytest
import sympy

from bondgraph import (
    TF,
    TIME,
    C,
    Friction,
    I,
    One,
    R,
    Se,
    assemble,
    linearize,
    models,
    steady_state,
)
from bondgraph.errors import BondGraphError, ParameterError, SimulationError, SteadyStateError

from .graphs import close, oscillator

u, v_in = sympy.symbols("u v_in", real=True)
FIG9 = {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2}


class TestSteadyState:
    def test_linear(self):
        graph, *_ = oscillator(force=4)
        point = steady_state(graph)
        assert point.states == pytest.approx({"m.p": 0, "k.q": 0.5}, abs=1e-15)
        assert point.isolated

    def test_inputs_and_outputs(self):
        v = One("v")
        spring = C("k", stiffness=8)
        graph = assemble(
            "g",
            Se("F", u) >> v >> (I("m", 2), spring, R("b", 1)),
            inputs=[u],
            outputs={"x": spring.q},
        )
        point = steady_state(graph, inputs={"u": 16})
        assert point.outputs["x"] == pytest.approx(2)
        assert point.inputs == {"u": 16}
        assert steady_state(graph, inputs={u: 8}).outputs["x"] == pytest.approx(1)
        with pytest.raises(ParameterError, match="input 'w' is not known"):
            steady_state(graph, inputs={"w": 1})
        with pytest.raises(SimulationError, match="finite"):
            steady_state(graph, inputs={"u": math.nan})

    def test_nonlinear(self):
        """A hardening spring under its load, and a pendulum that hangs wherever it starts."""
        v = One("v")
        law = C("k", effort=lambda q: q + q**3)
        graph = assemble("g", Se("F", 10) >> v >> (I("m", 1), law, R("b", 1)))
        assert steady_state(graph).states["k.q"] == pytest.approx(2, rel=1e-12)

    @pytest.mark.parametrize(("start", "rest"), [(0.3, 0.0), (3.0, math.pi), (6.5, 2 * math.pi)])
    def test_the_guess_chooses_among_many(self, start, rest):
        arm, angle = One("arm"), C("angle", stiffness=0)
        graph = assemble(
            "pendulum",
            arm >> (I("bob", 1), angle, R("air", 0.1)),
            arm >> TF("lever", sympy.sin(angle.q)) >> Se("weight", 9.81),
        )
        point = steady_state(graph, guess={"angle.q": start})
        assert point.states["angle.q"] == pytest.approx(rest, abs=1e-9)
        poles = linearize(graph, at=point).poles()
        assert (poles[0].real > 0) == (rest == math.pi)
        natural = numpy.sqrt(9.81)
        assert abs(poles[0]) == pytest.approx(natural, rel=2e-2)

    def test_free_states_are_not_isolated(self):
        """The position of a mass that coasts to rest is whatever it was."""
        graph = assemble("g", One("v") >> (I("m", 1), R("b", 1), C("x", stiffness=0, initial=3)))
        point = steady_state(graph)
        assert not point.isolated
        assert point.states == {"m.p": 0, "x.q": 3}

    def test_none(self):
        with pytest.raises(SteadyStateError, match="no steady state"):
            steady_state(assemble("g", Se("F", 1) >> One("v") >> I("m", 1)))

    def test_sources_in_time(self):
        graph = assemble("g", Se("F", sympy.sin(TIME)) >> One("v") >> (I("m", 1), R("b", 1)))
        with pytest.raises(SteadyStateError, match="depends on time"):
            steady_state(graph)

    def test_missing_values(self):
        graph = assemble("g", Se("F", u) >> One("v") >> (I("m", 1), R("b", 1)))
        with pytest.raises(ParameterError, match="needs a value for u"):
            steady_state(graph)

    def test_wrong_names_in_the_guess(self):
        graph, *_ = oscillator()
        with pytest.raises(ParameterError, match="is not known"):
            steady_state(graph, guess={"k.p": 1})

    def test_at_a_given_point(self):
        v = One("v")
        graph = assemble("g", v >> (I("m", 1), R("b", effort=lambda f: f**3)))
        assert close(linearize(graph, at={"m.p": 2}).A, [[-12]])
        assert close(linearize(graph, at={"m.p": 0}).A, [[0]])
        with pytest.raises(ParameterError, match=r"state 'm\.q' is not known"):
            linearize(graph, at={"m.q": 2})

    def test_at_a_steady_state_nothing_else_is_changed(self):
        b = sympy.Symbol("b", positive=True)
        parts = (I("m", 2), R("b", b), Friction("floor", kinetic=lambda s: 3, breakaway=3))
        push = Se("F", u) >> One("v") >> parts
        graph = assemble("g", push, parameters={b: (1, "N*s/m")}, inputs=[u])
        point = steady_state(graph, {"b": 4}, {"u": 11}, {"floor": "slip+"})
        same = linearize(graph, {b: (0.004, "kN*s/m")}, point, {u: 11}, {"floor": "slip+"})
        assert close(same.A, [[-2]])
        for given in (
            {"parameters": {"b": 5}},
            {"inputs": {"u": 12}},
            {"modes": {"floor": "slip-"}},
        ):
            with pytest.raises(ParameterError, match="was found with"):
                linearize(graph, at=point, **given)
        with pytest.raises(ParameterError, match="'w' is not known"):
            linearize(graph, at=point, inputs={"w": 1})

    def test_parameters_with_units(self):
        b = sympy.Symbol("b", positive=True)
        graph = assemble("g", One("v") >> (I("m", 2), R("b", b)), parameters={b: (1, "N*s/m")})
        assert close(linearize(graph, {"b": (1, "kN*s/m")}).A, [[-500]])


class TestContacts:
    """Steady states of systems with dry friction, in the mode that holds there."""

    def block(self, pull, spring=True):
        v = One("v")
        parts = [I("m", 2), Friction("floor", kinetic=lambda s: 3 + s, breakaway=5)]
        parts += [C("k", stiffness=10)] if spring else []
        return assemble("block", Se("pull", pull) >> v >> parts)

    def test_a_block_that_slides_steadily(self):
        point = steady_state(self.block(7, spring=False))
        assert point.modes == {"floor": "slip+"}
        assert point.states["m.p"] == pytest.approx(8)
        other = steady_state(self.block(-7, spring=False))
        assert other.modes == {"floor": "slip-"}
        assert other.states["m.p"] == pytest.approx(-8)

    def test_a_block_that_the_floor_holds(self):
        point = steady_state(self.block(4, spring=False))
        assert point.modes == {"floor": "stick"}
        assert point.states == {}

    def test_a_held_block_on_a_spring_stays_where_it_is(self):
        point = steady_state(self.block(4), guess={"k.q": 0.2})
        assert point.modes == {"floor": "stick"}
        assert point.states == {"k.q": 0.2}
        assert not point.isolated

    def test_the_mode_may_be_fixed(self):
        graph = models.bicycle_brake.graph()
        point = steady_state(graph, {"V0": 0}, modes={"friction": "stick"})
        assert point.modes == {"friction": "stick"}
        assert len(point.states) == 4

    def test_a_wheel_that_winds_up_against_stuck_pads_has_no_steady_state(self):
        with pytest.raises(SteadyStateError, match="no steady state"):
            steady_state(models.bicycle_brake.graph(), modes={"friction": "stick"})

    def test_a_part_that_drifts_along_has_no_steady_state(self):
        v = One("v")
        parts = (I("m", 1), R("b", 2), C("position", stiffness=0))
        with pytest.raises(SteadyStateError, match="no steady state"):
            steady_state(assemble("drift", Se("F", 1) >> v >> parts))
        assert not steady_state(assemble("rest", Se("F", 0) >> v >> parts)).isolated

    def test_modes_are_checked(self):
        with pytest.raises(BondGraphError, match="no mode"):
            steady_state(self.block(4), modes={"floor": "glue"})
        with pytest.raises(BondGraphError, match="no element with modes"):
            steady_state(self.block(4), modes={"m": "stick"})
