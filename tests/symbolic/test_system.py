"""Jacobians, characteristic polynomials and poles against closed forms and numbers."""

from __future__ import annotations

import random

import numpy as np
import pytest
import sympy

from bondgraph import (
    TIME,
    C,
    I,
    One,
    R,
    Se,
    assemble,
    derive,
    linearize,
    models,
    symbolic_system,
)
from bondgraph.errors import ParameterError
from bondgraph.models import LIBRARY
from bondgraph.modes import contacts
from bondgraph.symbolic import SymbolicError

from . import graphs
from .graphs import positive, u

s = sympy.Symbol("s")


def same(found, expected):
    return sympy.simplify(found - expected) == 0


class TestOscillator:
    def test_all_of_it(self):
        m, b, k = positive("m b k")
        system = symbolic_system(graphs.oscillator())
        p, q = system.states
        assert system.rates == {p: u - b * p / m - k * q, q: p / m}
        assert sympy.Matrix([[-b / m, -k], [1 / m, 0]]) == system.A
        assert sympy.Matrix([1, 0]) == system.B
        assert sympy.Matrix([[0, 1]]) == system.C
        assert sympy.Matrix([[0]]) == system.D
        assert {symbol.name for symbol in system.parameters} == {"m", "b", "k"}
        assert system.characteristic_polynomial(s).coefficients == (1, b / m, k / m)

    def test_poles_in_closed_form(self):
        m, b, k = positive("m b k")
        poles = symbolic_system(graphs.oscillator()).poles()
        assert set(poles.values()) == {1} and len(poles) == 2
        for pole in poles:
            assert same(m * pole**2 + b * pole + k, 0)

    def test_critical_damping_is_a_double_pole(self):
        m, b, k = positive("m b k")
        table = {m: (1, "kg"), b: (1, "N*s/m"), k: (1, "N/m")}
        named = assemble("named", graphs.oscillator(), parameters=table)
        system = symbolic_system(named, parameters={"m": 2, "b": 8, "k": (0.008, "N/mm")})
        assert system.poles() == {-2: 2} and system.parameters == ()

    def test_equations_serve_as_well(self):
        graph = graphs.oscillator()
        assert symbolic_system(derive(graph)).A == symbolic_system(graph).A


class TestOperatingPoint:
    def test_pendulum_at_any_angle(self):
        system = symbolic_system(graphs.pendulum())
        p, angle = system.states
        J, weight, b = positive("J weight b")
        # J th'' + b th' + W cos(th) th = 0 for an angle from the horizontal of the lever sin(q)
        assert sympy.Matrix([[-b / J, -weight * sympy.cos(angle)], [1 / J, 0]]) == system.A
        assert angle in system.A.free_symbols and p not in system.A.free_symbols

    @pytest.mark.parametrize("angle, status", [(0, "ALWAYS"), (sympy.pi, "UNSTABLE")])
    def test_pendulum_down_and_up(self, angle, status):
        system = symbolic_system(graphs.pendulum(), {"angle.q": angle, "inertia.p": 0})
        assert list(system.drift.values()) == [u, 0]
        assert system.routh_hurwitz().status.name == status

    def test_pendulum_held_by_a_torque(self):
        held, weight = sympy.Symbol("theta", real=True), positive("weight")
        at = {"angle.q": held, "inertia.p": 0, "u": weight * sympy.sin(held)}
        system = symbolic_system(graphs.pendulum(), at)
        assert set(system.drift.values()) == {0}
        assert system.routh_hurwitz().conditions == (sympy.cos(held),)

    def test_van_der_pol(self):
        mu, x = positive("mu"), sympy.Symbol("x0", real=True)
        graph = graphs.van_der_pol()
        origin = symbolic_system(graph, {"mass.p": 0, "spring.q": 0})
        assert origin.characteristic_polynomial(s).expression == s**2 - mu * s + 1
        assert origin.routh_hurwitz().status.name == "UNSTABLE"
        beside = symbolic_system(graph, {"mass.p": 0, "spring.q": x}).routh_hurwitz()
        assert beside.holds({"x0": 1.5, "mu": 1}) and not beside.holds({"x0": 0.5, "mu": 1})

    def test_where_there_is_no_derivative(self):
        x = C("x", effort=sympy.sqrt)
        graph = assemble("root", One("v") >> (x, I("m", 1)))
        with pytest.raises(SymbolicError, match=r"derivative of the rate of m\.p along x\.q"):
            symbolic_system(graph, {"x.q": 0})

    def test_unknown_names(self):
        with pytest.raises(ParameterError, match=r"angle\.q"):
            symbolic_system(graphs.pendulum(), {"angle.p": 0})
        with pytest.raises(ParameterError, match="parameter 'mass'"):
            symbolic_system(graphs.oscillator(), parameters={"mass": 1})
        with pytest.raises(ParameterError, match="output 'y'"):
            symbolic_system(graphs.oscillator(), outputs=["y"])
        with pytest.raises(ParameterError, match="input 'w'"):
            symbolic_system(graphs.oscillator(), inputs=["w"])


class TestAlgebraicVariables:
    def test_implicit_function_theorem(self):
        # q' = f, f^3 + f = u - q/c: df/dq = -1 / (c (3 f^2 + 1))
        system = symbolic_system(graphs.implicit())
        (f,), c = system.algebraic, positive("c")
        slope = -1 / (c * (3 * f**2 + 1))
        assert same(system.A[0], slope) and same(system.C[0], slope)
        assert same(system.B[0], -c * slope) and same(system.D[0], -c * slope)
        assert system.poles().keys() == {slope} or same(next(iter(system.poles())), slope)
        assert system.routh_hurwitz().status.name == "ALWAYS"

    def test_against_differences(self):
        system = symbolic_system(graphs.implicit())
        c = positive("c")

        def flow(q, force):
            roots = np.roots([1, 0, 1, -(force - q / 2.0)])
            return float(roots[abs(roots.imag) < 1e-9].real[0])

        point = {c: 2.0, system.algebraic[0]: flow(0.3, 1.0)}
        step = 1e-5
        assert float(system.A[0].subs(point)) == pytest.approx(
            (flow(0.3 + step, 1) - flow(0.3 - step, 1)) / (2 * step), rel=1e-6
        )
        assert float(system.D[0].subs(point)) == pytest.approx(
            (flow(0.3, 1 + step) - flow(0.3, 1 - step)) / (2 * step), rel=1e-6
        )

    def test_singular(self):
        law = R("flat", effort=lambda f: f**3 + f**5)
        graph = assemble("flat", Se("E", u) >> One("v") >> (law, C("c", 1)), inputs=[u])
        assert not symbolic_system(graph, {"v.f": 1}).A[0].free_symbols
        with pytest.raises(SymbolicError, match=r"do not determine v\.f") as error:
            symbolic_system(graph, {"v.f": 0})
        assert error.value.elements == ("v",)


class TestBlocks:
    def test_free_mass_has_two_integrators(self):
        m, F = positive("m"), sympy.Symbol("F", real=True)
        x = C("x", stiffness=0)
        graph = assemble("free", Se("push", F) >> One("v") >> (I("mass", m), x), inputs=[F])
        system = symbolic_system(graph)
        assert system.poles() == {0: 2}
        assert system.characteristic_polynomial(s).expression == s**2
        assert system.routh_hurwitz().integrators == 2

    def test_no_states(self):
        graph = assemble("static", Se("E", u) >> One("v") >> R("r", positive("r")), inputs=[u])
        system = symbolic_system(graph)
        assert system.characteristic_polynomial(s).coefficients == (1,)
        assert system.poles() == {} and system.routh_hurwitz().status.name == "ALWAYS"

    def test_time(self):
        graph = assemble("shaken", Se("E", 0) >> One("v") >> (I("m", 1), R("r", TIME**2 + 1)))
        system = symbolic_system(graph)
        assert TIME in system.A.free_symbols
        with pytest.raises(SymbolicError, match="depend on time"):
            system.characteristic_polynomial()

    def test_a_parameter_called_s(self):
        graph = assemble(
            "lag", Se("E", u) >> One("v") >> (C("c", 1), R("r", positive("s"))), inputs=[u]
        )
        assert symbolic_system(graph).characteristic_polynomial().variable.name == "lambda"


@pytest.fixture(scope="module", params=sorted(LIBRARY))
def library(request):
    graph = getattr(models, request.param).graph()
    return graph, dict.fromkeys(contacts(graph), "slip+")


class TestLibrary:
    def test_against_numbers(self, library):
        graph, modes = library
        draw = random.Random(5)
        system = symbolic_system(graph, modes=modes)
        at = {state.name: draw.uniform(1e-4, 1e-3) for state in system.states}
        numeric = linearize(graph, at=at, modes=modes)
        values = {symbol: numeric.at.parameters[symbol.name] for symbol in system.parameters}
        values |= {state: at[state.name] for state in system.states}
        values |= dict.fromkeys(system.inputs, 0)
        for name in "ABCD":
            found = np.array(getattr(system, name).evalf(30, subs=values), dtype=float)
            expected = getattr(numeric, name)
            assert np.allclose(found.reshape(expected.shape), expected, rtol=1e-9, atol=1e-12)
        numbers = [
            item.evalf(30, subs=values) for item in system.characteristic_polynomial().coefficients
        ]
        assert np.allclose(np.array(numbers, dtype=float), np.poly(numeric.A), rtol=1e-6)

    def test_contacts_need_a_mode(self, library):
        graph, modes = library
        if modes:
            with pytest.raises(ParameterError, match="stick and slip") as error:
                symbolic_system(graph)
            assert error.value.elements == tuple(modes)
