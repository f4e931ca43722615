"""Linearisation against closed forms and against numbers from independent solvers.

The brake's eigenvalues and the stuck mode were computed with scipy from Eq. 1 of Procedia
Engineering 72 (2014) 471-476, without this package.
"""

import math
from typing import ClassVar

import numpy
import pytest
import sympy

from bondgraph import (
    GY,
    TF,
    TIME,
    C,
    Friction,
    I,
    One,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    derive,
    linearize,
    models,
    steady_state,
)
from bondgraph.errors import BondGraphError, ParameterError, SimulationError, SteadyStateError

u, v_in = sympy.symbols("u v_in", real=True)
FIG9 = {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2}


def close(found, expected, rel=1e-6):
    return numpy.asarray(found) == pytest.approx(numpy.asarray(expected), rel=rel, abs=1e-12)


def pairs(*expected):
    """Poles with their conjugates, least stable first."""
    both = [
        value for pole in expected for value in ([pole, pole.conjugate()] if pole.imag else [pole])
    ]
    return numpy.array(both)


def oscillator(force=1, **laws):
    v = One("v")
    mass, spring = I("m", 2), C("k", stiffness=8)
    graph = assemble("osc", Se("F", force) >> v >> (mass, spring, R("b", 0.5)), **laws)
    return graph, mass, spring


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


class TestMassOnBelt:
    """Popp and Stelter's oscillator with the friction curve mu_d + (mu_s - mu_d) exp(-(v/v_s)^2)."""

    def graph(self, belt_speed=0.15):
        def pull(speed):
            return 10 * (
                sympy.Rational(1, 4) + sympy.Rational(3, 20) * sympy.exp(-((10 * speed) ** 2))
            )

        belt, body = Zero("belt"), One("body")
        return assemble(
            "belt",
            Sf("drive", belt_speed)
            >> belt
            >> body
            >> (I("m", 1), C("k", stiffness=100), R("c", 0.2)),
            belt >> Friction("contact", kinetic=pull),
        )

    def test_sliding(self):
        system = linearize(self.graph())
        assert system.at.modes == {"contact": "slip+"}
        assert close(system.poles(), pairs(2.271483 + 9.738602j))
        assert system.at.states["k.q"] == pytest.approx(
            (2.5 + 1.5 * math.exp(-2.25)) / 100, rel=1e-12
        )

    def test_against_the_closed_form(self):
        slope = -10 * 0.15 * 2 * 0.15 / 0.01 * math.exp(-2.25)
        expected = numpy.roots([1, 0.2 + slope, 100])
        assert close(sorted(linearize(self.graph()).poles().real), sorted(expected.real), 1e-12)

    def test_backwards(self):
        forth, back = linearize(self.graph()), linearize(self.graph(-0.15))
        assert back.at.modes == {"contact": "slip-"}
        assert close(back.poles(), forth.poles(), 1e-12)


def test_quarter_car():
    system = linearize(models.quarter_car.graph())
    assert close(system.poles(), pairs(-1.643512 + 7.646347j, -15.356488 + 68.328053j))
    assert system.at.outputs["v_body"] == pytest.approx(0, abs=1e-12)
    assert system.at.outputs["suspension"] == pytest.approx(300 * 9.81 / 20e3)
    assert system.at.outputs["tyre"] == pytest.approx(340 * 9.81 / 180e3)


class TestBrake:
    SLIDING: ClassVar = {
        0.9: (-12.497621, 48.396984 + 1264.600102j, -32.399833 + 1871.435608j),
        1.0: (-7.580190, 3.938867 + 1259.894363j, -56.042124 + 1879.237633j),
        1.2: (-2.788596, -38.371027 + 1256.492865j, -80.089955 + 1882.590648j),
    }

    @pytest.mark.parametrize("speed", SLIDING)
    def test_eigenvalues_of_sliding(self, speed):
        _, *modes = self.SLIDING[speed]
        system = linearize(models.bicycle_brake.graph(), FIG9 | {"V0": speed})
        line = -1 / 0.06
        assert close(
            system.poles(), sorted([*pairs(*modes), line], key=lambda z: (-z.real, -z.imag))
        )
        assert system.stable == (speed > 1.1)

    @pytest.mark.parametrize("speed", SLIDING)
    def test_the_matrix_is_that_of_the_paper_s_equation(self, speed):
        c, *_ = self.SLIDING[speed]
        system = linearize(models.bicycle_brake.graph(), FIG9 | {"V0": speed})
        p = system.at.parameters
        J, m, r = p["J_r"], p["m_f"], p["r_r"]
        expected = numpy.array(
            [
                [-(p["b_t"] + c * r**2) / J, c * r / J, p["k_t"] / J, 0],
                [c * r / m, -(p["b_f"] + c) / m, 0, -p["k_f"] / m],
                [-1, 0, 0, 0],
                [0, 1, 0, 0],
            ]
        )
        names = ["wheel.rotor.p", "rear.mass.p", "wheel.spokes.q", "rear.bending.q"]
        order = [system.states.index(name) for name in names]
        scale = numpy.array([J, m, 1, 1])
        found = system.A[numpy.ix_(order, order)] * scale / scale[:, None]
        assert close(found, expected)

    def test_operating_point_is_found_by_solving(self):
        point = steady_state(models.bicycle_brake.graph(), FIG9)
        p = point.parameters
        force = 2250 * (0.4 + 0.1 * math.exp(-0.9 / 0.2))
        assert point.outputs["slip"] == pytest.approx(0.9, rel=1e-12)
        assert point.outputs["omega_r"] == pytest.approx(11.25, rel=1e-12)
        assert point.outputs["F_f"] == pytest.approx(force, rel=1e-12)
        assert point.outputs["x_c"] == pytest.approx(force / p["k_f"], rel=1e-12)
        assert point.outputs["theta_w"] == pytest.approx(force * p["r_r"] / p["k_t"], rel=1e-12)

    def test_without_friction_s_slope(self):
        system = linearize(models.bicycle_brake.graph(), {"mu_s": 0.4})
        poles = [pole for pole in system.poles() if abs(pole.imag) > 1]
        assert close(poles, pairs(-62.831853 + 1255.065282j, -94.247780 + 1882.597923j))
        hertz = sorted({round(abs(pole.imag) / 2 / math.pi, 6) for pole in poles})
        assert hertz == pytest.approx([199.749844, 299.624765], abs=1e-6)

    def test_stuck(self):
        graph = models.bicycle_brake.graph()
        system = linearize(graph, {"V0": 0}, modes={"friction": "stick"})
        natural, zeta, poles = system.damp()
        swinging = numpy.abs(poles.imag) > 1
        assert swinging.sum() == 2
        assert natural[swinging][0] / 2 / math.pi == pytest.approx(267.720392, rel=1e-8)
        assert zeta[swinging][0] == pytest.approx(0.0491835, abs=5e-8)

    def test_the_wheel_is_what_the_frame_only_model_lacks(self):
        assert linearize(models.frame_brake.graph(), FIG9).stable
        assert not linearize(models.bicycle_brake.graph(), FIG9).stable

    @pytest.mark.parametrize(("v_s", "speed"), [(0.05, 0.322324), (0.1, 0.575332), (0.2, 1.012035)])
    def test_hopf_speed(self, v_s, speed):
        graph = models.bicycle_brake.graph()
        below, above = (
            linearize(graph, {"mu_s": 0.5, "v_s": v_s, "V0": speed + step})
            for step in (-1e-6, 1e-6)
        )
        assert not below.stable and above.stable
        assert abs(below.poles()[0].imag) / 2 / math.pi == pytest.approx(200.460451, rel=1e-6)

    def test_frame_only_hopf(self):
        """c = -b_f = -18.568 at the boundary of the model with a rigid wheel."""
        graph = models.frame_brake.graph()
        system = linearize(graph, {"mu_s": 0.5})
        c_hopf = -system.at.parameters["b_f"]
        speed = 0.05 * math.log(2250 * 0.1 / (0.05 * -c_hopf))
        assert not linearize(graph, {"mu_s": 0.5, "V0": speed - 1e-6}).stable
        assert linearize(graph, {"mu_s": 0.5, "V0": speed + 1e-6}).stable


def test_singular_matrices_are_no_trouble():
    """Two equal poles in one chain: a defective matrix still has poles and shares."""
    first, second = C("first", 1), C("second", 1)
    graph = assemble(
        "g",
        Sf("s", 1) >> Zero("a") >> (first, R("ra", 1)),
        Sf("t", first.e) >> Zero("b") >> (second, R("rb", 1)),
    )
    system = linearize(graph)
    assert close(system.poles(), [-1, -1], 1e-6)
    assert numpy.isfinite(system.participation()).all()


def test_an_infinite_slope_is_refused():
    v = One("v")
    graph = assemble(
        "g", v >> (I("m", 1), R("b", effort=lambda f: sympy.sign(f) * sympy.sqrt(sympy.Abs(f))))
    )
    with pytest.raises(SteadyStateError, match="not finite"):
        linearize(graph, at={"m.p": 0})


def test_gyrator_poles():
    """Two inertias through a gyrator swing like a spring and a mass."""
    a, z = One("a"), One("z")
    graph = assemble("g", a >> I("i", 2), a >> GY("gy", 3) >> z >> I("j", 5))
    assert derive(graph).causal.derivative == ()
    assert close(linearize(graph).poles(), pairs(complex(0, 3 / math.sqrt(10))))
