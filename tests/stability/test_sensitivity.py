"""Derivatives of eigenvalues against central differences, closed forms, and matrices by hand."""

import math

import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, Se, Zero, assemble, linearize, models
from bondgraph.smooth import Smooth
from bondgraph.stability import assess, sensitivities
from bondgraph.stability.derivatives import Forms
from tests.oracles.sliding import sliding_matrix, slope

FIG9 = {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2}


def of(graph, parameters=None, **options):
    """Sensitivities of a graph with its operating point."""
    system = linearize(graph, parameters, **options)
    held = Smooth(system.at.equations, graph, held=system.at.parameters)
    return sensitivities(system, Forms(held), parameters)


def followed(before, poles):
    """The eigenvalues nearest to known ones."""
    return np.array([poles[np.argmin(np.abs(poles - pole))] for pole in before])


def differences(graph, found, name, value, parameters, inputs=None, share=1e-3):
    """Central differences of sixth order of all eigenvalues by one parameter."""
    step = share * (abs(value) if value else 1.0)

    def at(k):
        if inputs is not None and name in inputs:
            moved = linearize(graph, parameters, inputs={**inputs, name: value + k * step})
        else:
            moved = linearize(graph, {**parameters, name: value + k * step}, inputs=inputs)
        return followed(found.eigenvalues, moved.poles())

    one, two, three = (at(k) - at(-k) for k in (1, 2, 3))
    return (45 * one - 9 * two + three) / (60 * step)


def check(graph, parameters=None, inputs=None):
    parameters = parameters or {}
    found = of(graph, parameters, inputs=inputs)
    inputs = linearize(graph, parameters, inputs=inputs).at.inputs
    assert not found.notes and np.isfinite(found.derivatives).all()
    for name, value in zip(found.names, found.values, strict=True):
        expected = differences(graph, found, name, value, parameters, inputs)
        size = abs(value) if value else 1.0
        # a millionth of each derivative; of those that are nothing, what rounding leaves
        floor = 1e-11 * np.abs(found.eigenvalues).max() / (1e-3 * size)
        assert np.abs(found.of(name) - expected) == pytest.approx(
            0, abs=1e-6 * np.abs(expected).max() + floor
        ), name


@pytest.mark.parametrize("name", models.LIBRARY)
def test_every_library_model_agrees_with_differences(name):
    check(getattr(models, name).graph())


@pytest.mark.parametrize("name", ["bicycle_brake", "frame_brake"])
def test_so_does_the_squealing_brake(name):
    check(getattr(models, name).graph(), {**FIG9, "V0": 0.95})


def test_derived_parameters_given_as_numbers_do_not_follow():
    graph, given = models.bicycle_brake.graph(), {**FIG9, "m_f": 0.1}
    check(graph, given)
    alone, following = of(graph, given).of("k_f"), of(graph, FIG9).of("k_f")
    assert np.abs(alone - following).max() > 1e-3 * np.abs(following).max()


def test_the_slope_of_friction_by_hand():
    """d lambda / d V0 by the slope's own derivative, from the matrix written down by hand."""
    found = of(models.bicycle_brake.graph(), FIG9)
    c, v_s = slope(0.9, 0.2), 0.2
    step = 1e-4 * abs(c)
    high, low = (np.linalg.eigvals(sliding_matrix(c + k * step)) for k in (1, -1))
    for pole, by_speed in zip(found.eigenvalues, found.of("V0"), strict=True):
        if not pole.imag:  # the brake line's own
            assert abs(by_speed) < 1e-6
            continue
        by_slope = (followed([pole], high) - followed([pole], low))[0] / (2 * step)
        assert by_speed == pytest.approx(by_slope * -c / v_s, rel=1e-6)


def test_the_steady_state_moves_along():
    """A spring that stiffens under a load F: lambda = i sqrt(3 q^2), with q^3 = F."""
    load = sympy.Symbol("F", real=True)
    spring = C("spring", effort=lambda q: q**3)
    graph = assemble(
        "hard", Se("push", load) >> One("v") >> (I("m", 1), spring), inputs={load: "N"}
    )
    found = of(graph, inputs={"F": 8.0})
    assert found.names == ("F",) and found.units == ("N",)
    # sqrt(3) F^(1/3)
    assert found.of("F") == pytest.approx([1j / math.sqrt(3) / 4, -1j / math.sqrt(3) / 4])


def test_algebraic_variables_follow():
    a = sympy.Symbol("a", positive=True)
    n1, n2 = Zero("n1"), One("n2")
    graph = assemble(
        "loop",
        Se("E", 3) >> n2 >> (R("r1", effort=lambda f: a * f + f**3), n1),
        n1 >> (C("c1", 0.5), R("r2", effort=lambda f: f + 2 * f**3)),
        parameters={a: 1.3},
    )
    assert linearize(graph).at.algebraic
    check(graph)


def test_two_equal_eigenvalues_have_no_derivatives():
    k = sympy.Symbol("k", positive=True)
    parts = [One(f"v{j}") >> (I(f"m{j}", 1), C(f"s{j}", stiffness=k)) for j in (1, 2)]
    found = of(assemble("twins", *parts, parameters={k: 4.0}))
    assert np.isnan(found.derivatives).all()
    assert "no derivatives of their own" in found.notes[0]
    assert found.ranked(0) == () and found.to_json()[0]["d_growth"] == [None] * 4
    assert found.moving() == ("k",)  # what is not known to do nothing may do something


def test_where_a_change_takes_the_steady_state_away():
    """A free mass rests only while nothing pulls at it."""
    pull, b = sympy.symbols("F b", real=True)
    graph = assemble(
        "free",
        Se("push", pull) >> One("v") >> I("m", 1),
        One("w") >> (I("n", 1), R("r", b)),
        parameters={b: 2.0},
        inputs=[pull],
    )
    found = of(graph)
    assert np.isnan(found.of("F")).all() and np.isfinite(found.of("b")).all()
    assert any("F" in note and "no steady state" in note for note in found.notes)


def test_ranks_and_words_follow_the_paper():
    """Instability is furthered by larger mu_s/mu_k, slower decay, lower speed, less damping, ..."""
    result = assess(models.bicycle_brake.graph(), FIG9, span=None)
    growth = {e.parameter: e.growth(0.1) for e in result.sensitivities.ranked(0, by="growth")}
    for name in ("mu_s", "v_s", "F_k", "zeta_w", "V0", "mu_k", "k_w", "k_f"):
        further = name in ("mu_s", "v_s", "F_k")
        assert (growth[name] > 0) == further, name
    # the frame's damping alone couples the modes and feeds the wheel's a little; both together damp
    assert 0 < growth["zeta_f"] < -0.02 * growth["zeta_w"]
    ranked = result.sensitivities.ranked(0, derived=False, by="growth")
    sizes = [abs(item.growth(1.0)) for item in ranked]
    assert sizes == sorted(sizes, reverse=True)
    assert not any(item.derived for item in ranked)


def test_a_graph_without_states_has_nothing_to_move():
    graph = assemble("still", Se("s", 1) >> One("v") >> R("r", 2))
    found = of(graph)
    assert found.derivatives.shape == (0, 0) and found.to_json() == []
