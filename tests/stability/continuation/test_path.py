"""Paths of steady states: known branches, the sliding brake by hand."""

import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, Se, Sf, Zero, assemble, models, steady_state
from bondgraph.stability.continuation import follow_path
from bondgraph.stability.family import Family
from tests.oracles.sliding import critical_speed

p = sympy.Symbol("p", real=True)


def path_of(graph, name, low, high, parameters=None, **options):
    point = steady_state(graph, parameters, **options.pop("at", {}))
    return follow_path(Family(graph, point, [name], parameters), low, high, **options)


def snapping(k=1.0):
    """A spring that snaps through under a load p: p = q^3 - k q, damped."""
    spring = C("spring", effort=lambda q: q**3 - k * q)
    return assemble(
        "snap", Se("load", p) >> One("v") >> (I("m", 1), spring, R("d", 0.5)), parameters={p: -2.0}
    )


def test_a_snapping_spring_has_two_folds_on_one_path():
    path = path_of(snapping(), "p", -2, 2, at={"guess": {"spring.q": -1.6}})
    at = 2 / 3**1.5
    assert [edge.value for edge in path.edges] == pytest.approx([at, -at], rel=1e-10)
    assert all(edge.kind == "fold" and edge.unstable_above is None for edge in path.edges)
    q = path.states[:, 1]
    assert q**3 - q == pytest.approx(path.values, abs=1e-9)
    # the middle part, where the spring pulls away, is unstable
    unstable = path.eigenvalues[:, 0].real > 0
    assert (unstable == (3 * q**2 < 1)).all()
    before, behind = path.first
    assert before is None and behind is path.edges[0]
    assert path.ends == ("limit", "limit") and path.here == 0


def test_the_operating_point_may_lie_outside_the_range():
    path = path_of(snapping(), "p", 0.1, 2, at={"guess": {"spring.q": -1.6}})
    # -.385 is on the way back through the fold at .385, but outside what was asked for
    assert [round(edge.value, 6) for edge in path.edges] == [0.3849]
    assert path.values.min() == -2


def test_only_the_first_edge_each_way():
    graph = models.bicycle_brake.graph()
    whole = path_of(graph, "V0", 0.2, 3.0)
    short = path_of(graph, "V0", 0.2, 3.0, only_first=True)
    assert [edge.boundary for edge in whole.edges] == [False, False, True]
    assert short.first[0].value == pytest.approx(critical_speed(0.05), rel=1e-9)
    assert short.first[1] is None and len(short.values) < len(whole.values)
    assert short.ends == ("enough", "limit")


def test_one_way():
    path = path_of(models.bicycle_brake.graph(), "V0", 0.2, 3.0, senses=[1])
    assert path.ends == ("not asked", "limit") and path.here == 0 and path.edges == ()


def test_a_contact_that_leaves_its_mode_ends_it():
    path = path_of(models.bicycle_brake.graph(), "V0", -0.5, 1.0)
    assert "leaves mode 'slip+'" in path.ends[0] and path.ends[1] == "limit"
    assert 0 < path.values[0] < 1e-4


@pytest.mark.parametrize("seed", range(12))
def test_other_brakes_by_hand(seed):
    """Parameters of the brake drawn at random: the crossing of the matrix written down by hand."""
    rng = np.random.default_rng(seed)
    own = {
        "k_f": rng.uniform(150e3, 700e3),
        "k_w": rng.uniform(40e3, 200e3),
        "f_f": rng.uniform(180, 450),
        "f_w": rng.uniform(120, 300),
        "r": rng.uniform(0.06, 0.1),
        "zeta": rng.uniform(0.015, 0.09),
        "zeta_w": rng.uniform(0.015, 0.09),
    }
    mu_k, drop, force = rng.uniform(0.25, 0.5), rng.uniform(0.05, 0.3), rng.uniform(400, 1500)
    v_s = rng.uniform(0.05, 0.2)
    given = {
        **{name: own[name] for name in ("k_f", "k_w", "f_f", "f_w", "zeta_w")},
        "r_r": own["r"],
        "zeta_f": own["zeta"],
        "mu_k": mu_k,
        "mu_s": mu_k + drop,
        "F_k": force,
        "v_s": v_s,
    }
    expected = critical_speed(v_s, force / mu_k * drop, **own)
    path = path_of(
        models.bicycle_brake.graph(), "V0", 0.05, 3.0, {**given, "V0": 2.5}, only_first=True
    )
    assert path.first[0] is not None
    assert path.first[0].value == pytest.approx(expected, rel=1e-8)


def test_a_position_that_is_free_does_not_hinder():
    """Nothing holds the counter's displacement: the branch is a surface, its edges are the same."""
    damper = R("d", effort=lambda f: -p * f + f**3)
    parts = (I("m", 1), C("k", 1), damper, C("counter", effort=lambda q: 0 * q))
    graph = assemble("drifting", One("v") >> parts, parameters={p: -0.1})
    path = path_of(graph, "p", -0.2, 0.3)
    (edge,) = path.edges
    assert edge.kind == "hopf" and edge.value == pytest.approx(0, abs=1e-12)
    assert edge.frequency_hz == pytest.approx(1 / (2 * np.pi))


def test_a_window_of_instability_within_a_step():
    low, high = 0.4991, 0.5006
    damper = R("d", effort=lambda f: (p - low) * (p - high) * f)
    graph = assemble("window", One("v") >> (I("m", 1), C("k", 9), damper), parameters={p: 0.0})
    path = path_of(graph, "p", 0.0, 1.0)
    assert [edge.value for edge in path.edges] == pytest.approx([low, high], rel=1e-8)
    assert [edge.unstable_above for edge in path.edges] == [True, False]


def test_a_model_without_states_has_a_path_without_edges():
    graph = assemble("still", Sf("s", p) >> Zero("n") >> R("r", 2), parameters={p: 1.0})
    path = path_of(graph, "p", 0.5, 2.0)
    assert path.edges == () and path.ends == ("limit", "limit")
