"""Steady states and linearisation with algebraic variables, against equations by hand.

The linearised systems are checked as pencils: eigenvalues of J v = s E v, with the algebraic rows
of E zero, from scipy.
"""

import math

import numpy as np
import pytest
import scipy.linalg
import sympy
from scipy.optimize import brentq

from bondgraph import (
    C,
    Friction,
    I,
    One,
    R,
    Se,
    Zero,
    assemble,
    derive,
    linearize,
    simulate,
    steady_state,
)
from bondgraph.errors import ParameterError, SteadyStateError
from bondgraph.stability import assess

U = sympy.Symbol("U", real=True)


def cubic(f):
    return f + f**3


def pi_filter():
    """Source, cubic resistor, c1, inductor with loss, c2 with a cubic load."""
    a, n1, series, n2 = One("a"), Zero("n1"), One("series"), Zero("n2")
    return assemble(
        "pi",
        Se("E", U) >> a >> (R("r1", effort=cubic), n1),
        n1 >> (C("c1", 0.5), series),
        series >> (I("coil", 0.2), R("loss", 0.1), n2),
        n2 >> (C("c2", 0.25), R("load", effort=lambda f: 2 * f + f**3)),
        inputs=[U],
        outputs={"drop": a.f, "current": series.f},
    )


def pi_current(volts):
    """The one current through everything at rest."""
    return brentq(lambda f: cubic(f) + 0.1 * f + 2 * f + f**3 - volts, -9, 9, xtol=1e-15)


@pytest.mark.parametrize("volts", [2.0, -0.3, 40.0])
def test_the_steady_state_of_a_pi_filter(volts):
    point = steady_state(pi_filter(), inputs={"U": volts})
    f = pi_current(volts)
    assert point.states["coil.p"] == pytest.approx(0.2 * f, rel=1e-9)
    assert point.states["c1.q"] == pytest.approx(0.5 * (volts - cubic(f)), rel=1e-9)
    assert point.states["c2.q"] == pytest.approx(0.25 * (2 * f + f**3), rel=1e-9)
    assert set(point.algebraic) == {s.name for s in derive(pi_filter()).algebraic}
    assert list(point.algebraic.values()) == pytest.approx([f, f], rel=1e-9)
    assert point.outputs == pytest.approx({"drop": f, "current": f}, rel=1e-9)


def pencil(volts):
    """J and E of (q1, p, q2, f1, f2), input column, about the rest state."""
    f = pi_current(volts)
    jacobian = np.array(
        [
            [0, -1 / 0.2, 0, 1, 0],
            [1 / 0.5, -0.1 / 0.2, -1 / 0.25, 0, 0],
            [0, 1 / 0.2, 0, 0, -1],
            [-1 / 0.5, 0, 0, -(1 + 3 * f**2), 0],
            [0, 0, 1 / 0.25, 0, -(2 + 3 * f**2)],
        ]
    )
    return jacobian, np.diag([1.0, 1, 1, 0, 0]), np.array([0, 0, 0, 1.0, 0])


def test_eigenvalues_are_those_of_the_pencil():
    system = linearize(pi_filter(), inputs={"U": 2.0})
    assert system.states == ("c1.q", "coil.p", "c2.q")
    jacobian, mass, _ = pencil(2.0)
    values = scipy.linalg.eig(jacobian, mass, right=False)
    finite = values[np.isfinite(values) & (np.abs(values) < 1e9)]
    assert len(finite) == 3
    by_imaginary_part = [
        sorted(found, key=lambda value: value.imag) for found in (system.poles(), finite)
    ]
    assert by_imaginary_part[0] == pytest.approx(by_imaginary_part[1], rel=1e-9)


def test_the_transfer_function_is_that_of_the_pencil():
    system = linearize(pi_filter(), inputs={"U": 2.0})
    jacobian, mass, column = pencil(2.0)
    for s in (0.0, 3j, 1 + 20j):
        by_hand = np.linalg.solve(s * mass - jacobian, column)
        inner = np.linalg.solve(s * np.eye(3) - system.A, system.B)
        found = (system.C @ inner + system.D).ravel()
        assert found == pytest.approx([by_hand[3], by_hand[1] / 0.2], rel=1e-9)


def test_small_motions_of_a_simulation_follow_the_linearisation():
    point = steady_state(pi_filter(), inputs={"U": 2.0})
    system = linearize(pi_filter(), at=point)
    start = {name: value * (1 + 1e-6) for name, value in point.states.items()}
    run = simulate(pi_filter(), 1.0, {}, start, {"U": 2.0}, t_eval=[0, 0.5, 1], rtol=1e-12)
    rest = np.array(list(point.states.values()))
    for column, t in enumerate(run.t):
        expected = scipy.linalg.expm(system.A * t) @ (1e-6 * rest)
        assert np.abs(run.x[:, column] - rest - expected).max() < 1e-10


def test_a_given_point_is_made_consistent():
    system = linearize(pi_filter(), at={"c1.q": 0.5, "coil.p": 0.1}, inputs={"U": 3.0})
    f = brentq(lambda f: cubic(f) - (3 - 1), 0, 9, xtol=1e-15)
    assert system.at.algebraic["a.f"] == pytest.approx(f, rel=1e-12)
    assert system.A[0, 0] == pytest.approx(-1 / 0.5 / (1 + 3 * f**2), rel=1e-12)


def falling(f):
    return sympy.tanh(10 * f) * (1 + 2 * sympy.exp(-(f**2))) + f / 5


def falling_number(f):
    return math.tanh(10 * f) * (1 + 2 * math.exp(-(f**2))) + f / 5


@pytest.mark.parametrize(
    ("guess", "bracket"), [(0.01, (0, 0.15)), (1.2, (0.3, 1.9)), (5, (2.2, 9))]
)
def test_the_guess_chooses_among_several_solutions(guess, bracket):
    """A law that falls in between: three flows at one effort, one of them unstable."""
    graph = assemble("g", Se("E", 2.4) >> One("v") >> (C("c", 1), R("r", effort=falling)))
    f = brentq(lambda f: falling_number(f) - 1.9, *bracket, xtol=1e-14)
    slope = (falling_number(f + 1e-6) - falling_number(f - 1e-6)) / 2e-6
    system = linearize(graph, at={"c.q": 0.5, "r.f": guess})
    assert system.at.algebraic == pytest.approx({"v.f": f}, rel=1e-9)
    assert system.A[0, 0] == pytest.approx(-1 / slope, rel=1e-6)


@pytest.mark.parametrize("at", [None, {"c.q": 1.0}])
def test_an_undetermined_variable_is_named(at):
    """e = f^3 + f^5 at rest: any charge near by moves the flow with infinite slope."""
    graph = assemble(
        "g", Se("E", 1) >> One("v") >> (C("c", 1), R("r", effort=lambda f: f**3 + f**5))
    )
    with pytest.raises(SteadyStateError, match=r"v\.f.*singular") as caught:
        linearize(graph, at=at)
    assert caught.value.elements == ("v.f",)


def test_no_solution_at_a_given_point_is_named():
    graph = assemble("g", Se("E", -1) >> One("v") >> (C("c", 1), R("r", effort=sympy.exp)))
    with pytest.raises(SteadyStateError, match=r"v\.f.*guess"):
        linearize(graph, at={"c.q": 0})


def test_a_guess_of_what_is_not_solved_for_is_refused():
    with pytest.raises(ParameterError, match=r"'r1\.q' is not known"):
        steady_state(pi_filter(), guess={"r1.q": 1})
    far = steady_state(pi_filter(), inputs={"U": 2.0}, guess={"r1.f": 3, "c1.q": 4})
    assert far.algebraic["a.f"] == pytest.approx(pi_current(2.0), rel=1e-9)


def test_the_search_relaxes_where_newton_is_lost():
    """Far up a tanh spring Newton overshoots; the dashpot is a cubic one in effort form."""
    u = Zero("u")
    graph = assemble(
        "g",
        u
        >> (
            C("c", effort=lambda q: q + 50 * sympy.tanh(20 * (q - 1)), initial=30),
            R("r", effort=cubic),
        ),
    )
    point = steady_state(graph)
    root = brentq(lambda q: q + 50 * math.tanh(20 * (q - 1)), 0.5, 1.0, xtol=1e-15)
    assert point.states["c.q"] == pytest.approx(root, rel=1e-9)


def test_contacts_with_a_mode_and_an_algebraic_variable():
    """A mass is drawn over a rough floor, held by a spring and a damper whose law is e^3 + e = v."""
    v = One("v")
    graph = assemble(
        "belt",
        Se("pull", 5) >> v >> (I("m", 1), C("k", 1), R("damper", flow=lambda e: e**3 + e)),
        v >> Friction("floor", kinetic=lambda speed: 1 + speed, breakaway=2),
    )
    system = linearize(graph, modes={"floor": "slip+"})
    # at rest the damper passes no effort, and its slope de/dv is 1
    assert system.at.states["k.q"] == pytest.approx(4, rel=1e-9)
    assert pytest.approx(np.array([[-2, -1], [1, 0]]), rel=1e-9, abs=1e-12) == system.A


class TestStability:
    """Mass, spring and two resistors, one falling, one cubic in flow form: a Hopf in closed form."""

    def graph(self):
        b = sympy.Symbol("b", real=True)
        v = One("v")
        return assemble(
            "oscillator",
            v >> (I("m", 1), C("k", stiffness=4), R("push", effort=lambda f: -b * f + f**3)),
            v >> R("damper", flow=lambda e: 2 * e + e**3),
            parameters={b: 0.1},
        )

    def test_the_edge(self):
        """The damper takes v/2, so growth begins at b = 1/2 with 2 rad/s."""
        result = assess(self.graph(), vary=["b=0.1:1:10"])
        assert result.stable
        (edge,) = result.edges
        assert edge.kind == "hopf"
        assert edge.value == pytest.approx(0.5, rel=1e-9)
        assert edge.frequency_hz == pytest.approx(1 / math.pi, rel=1e-9)
        (locus,) = result.loci
        assert locus.states.shape == locus.eigenvalues.shape == (10, 2)
        assert locus.eigenvalues[:, 0].real == pytest.approx((locus.values - 0.5) / 2, abs=1e-9)

    def test_feeds(self):
        """Growth is minus the slope over twice the mass, one part for each resistor."""
        mode = assess(self.graph()).rows[0]
        assert mode.feeds == pytest.approx({"push": 0.05, "damper": -0.25}, rel=1e-9)

    def test_a_fold_of_the_branch(self):
        """q/c = e(f) on a leaking branch: the feed i that the falling load takes has a maximum."""
        i = sympy.Symbol("i", real=True)
        u, v = Zero("u"), One("v")
        graph = assemble(
            "fold",
            u >> (C("c", 1), R("leak", flow=lambda e: e**2 + 1 - i), v),
            v >> R("r", effort=lambda f: f + f**3),
            parameters={i: 3.0},
        )

        # at rest f = -(e^2 + 1 - i) with e = f + f^3; the branch ends where the slope vanishes
        def left(f):
            return f + (f + f**3) ** 2 + 1

        slope = brentq(lambda f: 1 + 2 * (f + f**3) * (1 + 3 * f**2), -1, 0, xtol=1e-15)
        result = assess(graph, vary=[f"i={left(slope) - 0.3}:3:60"])
        (edge,) = result.edges
        assert edge.kind == "fold"
        assert edge.value == pytest.approx(left(slope), rel=1e-9)
        assert set(edge.point.algebraic) == {s.name for s in derive(graph).algebraic}
        assert result.loci[0].gaps
