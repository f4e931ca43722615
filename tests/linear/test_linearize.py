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
    C,
    Friction,
    I,
    One,
    R,
    Sf,
    Zero,
    assemble,
    derive,
    linearize,
    models,
    steady_state,
)
from bondgraph.errors import SteadyStateError

from .graphs import close, pairs

u, v_in = sympy.symbols("u v_in", real=True)
FIG9 = {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2}


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
