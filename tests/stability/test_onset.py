"""First Lyapunov coefficients against the planar formula and against motions."""

import math
import random

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from bondgraph import C, I, One, R, Zero, assemble, models
from bondgraph.stability import assess

mu, a = sympy.symbols("mu a", real=True)


def planar(law, **parameters):
    """q' = p, p' = -q + h(q, p): the resistance is -h, and hears the spring."""
    spring = C("k", 1)
    damper = R("d", effort=lambda f: -law(spring.q, f))
    table = {symbol: value for symbol, value in [(mu, -0.1)]}
    table |= {sympy.Symbol(name, real=True): value for name, value in parameters.items()}
    return assemble("planar", One("v") >> (I("m", 1), spring, damper), parameters=table)


def coefficient(law):
    """Radial coefficient for x = p, y = q and omega one; Guckenheimer and Holmes (3.4.11).

    Guckenheimer, Holmes, Nonlinear Oscillations, Dynamical Systems, and Bifurcations of Vector
    Fields, Springer 1983. Only the first equation has terms that are not linear.
    """
    q, p = sympy.symbols("q p")
    f = law(q, p).subs(mu, 0)

    def d(*by):
        return sympy.diff(f, *by).subs({q: 0, p: 0})

    cubic = d(p, p, p) + d(p, q, q)
    return float(cubic / 16 + d(p, q) * (d(p, p) + d(q, q)) / 16)


def edge_of(graph, **options):
    (edge,) = assess(graph, vary=[("mu", -0.2, 0.3, 20)], span=None, **options).edges
    return edge


@pytest.mark.parametrize("seed", range(8))
def test_against_the_planar_formula(seed):
    rng = random.Random(seed)
    c = [rng.uniform(-2, 2) for _ in range(7)]

    def law(q, p):
        squares = c[0] * q**2 + c[1] * q * p + c[2] * p**2
        return mu * p + squares + c[3] * q**3 + c[4] * q**2 * p + c[5] * q * p**2 + c[6] * p**3

    edge = edge_of(planar(law))
    assert edge.value == pytest.approx(0, abs=1e-14)
    # q of length one makes z the radius over the root of two
    assert edge.onset.cubic.real == pytest.approx(2 * coefficient(law), rel=1e-9)
    assert edge.first_lyapunov == pytest.approx(2 * coefficient(law), rel=1e-9)
    assert edge.onset.kind == ("soft" if coefficient(law) < 0 else "hard")
    assert edge.onset.side == ("above" if coefficient(law) < 0 else "below")


def test_the_amplitude_behind_a_soft_edge_is_that_of_the_motion():
    def law(q, p):
        return mu * p + 0.7 * q * p - 0.4 * p**3 - 0.3 * q**2 * p

    spring = C("k", 1)
    damper = R("d", effort=lambda f: -law(spring.q, f))
    graph = assemble(
        "soft",
        One("v") >> (I("m", 1), spring, damper),
        parameters={mu: -0.1},
        outputs={"bend": spring.q},
    )
    onset = edge_of(graph).onset

    def rates(_, y):
        return [
            -y[1] + 1e-3 * y[0] + 0.7 * y[1] * y[0] - 0.4 * y[0] ** 3 - 0.3 * y[1] ** 2 * y[0],
            y[0],
        ]

    first = onset.amplitude("bend", 1e-3)
    run = solve_ivp(rates, (0, 3000), [first, 0], rtol=1e-9, atol=1e-12, max_step=0.05)
    late = run.y[1][run.t > 2900]
    assert (late.max() - late.min()) / 2 == pytest.approx(first, rel=0.01)


def test_a_linear_model_is_degenerate():
    edge = edge_of(planar(lambda q, p: mu * p))
    assert edge.onset.kind == "degenerate" and edge.first_lyapunov == 0
    assert edge.onset.side is None and math.isnan(edge.onset.amplitude("x", 0.1))


@pytest.mark.parametrize("name", ["bicycle_brake", "frame_brake"])
def test_squeal_starts_hard(name):
    """Exponentially falling friction: third derivative negative against the damping's sign."""
    (edge,) = assess(getattr(models, name).graph(), vary=["V0=0.25:1.5:50"], span=None).edges
    assert edge.onset.kind == "hard" and edge.onset.side == "above"


def test_the_belt_by_hand():
    """m x'' + c x' + k x = F(v_b - x'): only the third derivative of F counts, and its square."""
    (edge,) = assess(models.mass_on_belt.graph(), vary=["v_b=0.1:1:50"], span=None).edges
    values = edge.point.parameters
    drop = values["N"] * (values["mu_s"] - values["mu_k"])
    decay = drop * math.exp(-edge.value / values["v_s"])
    # p' = -k q - c p/m + F(v_b - p/m); with v the speed F = F0 + decay (e^(v/v_s) ...)
    third = decay / values["v_s"] ** 3 / values["m"] ** 3
    omega = math.sqrt(values["k"] / values["m"])
    # (p, q) with q scaled to make the linear part a turn: G-H radius r in p gives p''' / 16 r^3
    length = math.sqrt(1 + (1 / (values["m"] * omega)) ** 2)  # of (1, i / (m omega))
    # p = 2 Re z q_p with |q_p| = 1 / length: r = 2 |z| / length
    expected = third / 16 * (2 / length) ** 2
    assert edge.onset.cubic.real == pytest.approx(expected, rel=1e-8)


def test_algebraic_variables_follow():
    """The same oscillator with its resistance split by a loop that is not solved by hand."""

    def law(f):
        return -mu * f + a * f**3

    plain = assemble(
        "plain",
        One("v") >> (I("m", 1), C("k", 1), R("d", effort=law)),
        parameters={mu: -0.1, a: 2.0},
    )
    node = Zero("node")
    split = assemble(
        "split",
        One("v") >> (I("m", 1), C("k", 1), node),
        node >> (R("x", effort=lambda f: -2 * mu * f + a * (2 * f) ** 3),),
        node >> R("y", effort=lambda f: -2 * mu * f + a * (2 * f) ** 3),
        parameters={mu: -0.1, a: 2.0},
    )
    one, other = edge_of(plain), edge_of(split)
    assert other.point.algebraic
    assert other.first_lyapunov == pytest.approx(one.first_lyapunov, rel=1e-9)


def test_a_second_zero_eigenvalue_is_no_obstacle_where_it_does_not_matter():
    """A position that nothing pulls back: its eigenvalue is zero, and the onset is the same."""
    spring = C("k", 1)
    damper = R("d", effort=lambda f: -mu * f + 2 * f**3)
    graph = assemble(
        "drifting",
        One("v") >> (I("m", 1), spring, damper, C("counter", effort=lambda q: 0 * q)),
        parameters={mu: -0.1},
    )
    edge = next(e for e in assess(graph, vary=[("mu", -0.2, 0.3, 20)], span=None).loci[0].crossings)
    assert edge.kind == "hopf" and edge.onset is not None
    assert np.sign(edge.first_lyapunov) == -1
