"""Edges in two parameters: normal forms with known curves, the sliding brake by hand."""

import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, Sf, Zero, assemble, models
from bondgraph.errors import BondGraphError, ParameterError
from bondgraph.stability import Vary, assess, follow_edge
from bondgraph.stability.continuation import boundaries
from tests.oracles.sliding import critical_slope, critical_speed, sliding_matrix

b1, b2, mu, a, h, r = sympy.symbols("b1 b2 mu a h r", real=True)


def bogdanov_takens():
    """q' = p, p' = b1 + b2 q + q^2 - q p; Kuznetsov (2004), section 8.4, with s = -1."""
    spring = C("k", effort=lambda q: -(b1 + b2 * q + q**2))
    damper = R("d", effort=lambda f: spring.q * f)
    return assemble("bt", One("v") >> (I("m", 1), spring, damper), parameters={b1: 0.1, b2: -1.0})


def test_hopf_and_fold_meet_where_they_should():
    graph, ranges = bogdanov_takens(), (Vary("b1", -0.5, 0.5), Vary("b2", -2, 0.5))
    result = assess(graph, vary=ranges[:1], guess={"k.q": 0.1}, span=None)
    hopf, fold = result.loci[0].crossings
    assert (hopf.kind, fold.kind) == ("hopf", "fold")
    curve = follow_edge(graph, hopf, *ranges)
    assert np.abs(curve.values[:, 0]).max() < 1e-12  # b1 = 0
    omega = np.sqrt(np.maximum(-curve.values[:, 1], 0))
    assert curve.frequency_hz == pytest.approx(omega / 2 / np.pi, abs=1e-7)
    assert curve.ends == ("limit", "bogdanov-takens")
    assert [item.kind for item in curve.special] == ["bogdanov-takens"]
    assert curve.special[0].values == pytest.approx((0, 0), abs=1e-8)
    assert (curve.first_lyapunov[:-1] < 0).all()  # the cycle that s = -1 has is stable
    curve = follow_edge(graph, fold, *ranges)
    assert curve.values[:, 0] == pytest.approx(curve.values[:, 1] ** 2 / 4, abs=1e-12)
    assert curve.ends == ("limit", "limit")
    (special,) = curve.special
    assert special.kind == "bogdanov-takens" and special.values == pytest.approx((0, 0), abs=1e-9)
    assert np.isnan(curve.first_lyapunov).all()
    # of the two parts one has the other eigenvalue in the right half plane
    assert (curve.edge_of_stability == (curve.values[:, 1] < 0)).mean() > 0.95


def test_where_the_onset_turns_hard():
    damper = R("d", effort=lambda f: -mu * f + a * f**3 + f**5)
    graph = assemble(
        "bautin", One("v") >> (I("m", 1), C("k", 1), damper), parameters={mu: -0.1, a: 2.0}
    )
    (edge,) = assess(graph, vary=["mu=-0.2:0.3:20"], span=None).edges
    curve = follow_edge(graph, edge, Vary("mu", -0.2, 0.3), Vary("a", -3, 3))
    assert np.abs(curve.values[:, 0]).max() < 1e-12
    assert curve.first_lyapunov == pytest.approx(-0.75 * curve.values[:, 1], rel=1e-9)
    (special,) = curve.special
    assert special.kind == "bautin" and special.values == pytest.approx((0, 0), abs=1e-8)


def test_a_cusp():
    """x' = h + r x - x^3: folds at 27 h^2 = 4 r^3."""
    law = R("d", flow=lambda e: -h - r * e + e**3)
    graph = assemble("cusp", Zero("n") >> (C("c", 1), law), parameters={h: -1.0, r: 1.0})
    edge = assess(graph, vary=["h=-2:2:40"], span=None).edges[0]
    curve = follow_edge(graph, edge, Vary("h", -2, 2), Vary("r", -1, 2))
    assert 27 * curve.values[:, 0] ** 2 == pytest.approx(4 * curve.values[:, 1] ** 3, abs=1e-10)
    assert curve.values[:, 0].min() < -1 < 1 < curve.values[:, 0].max()  # through the cusp
    assert [item.kind for item in curve.special] == ["cusp"]
    assert curve.special[0].values == pytest.approx((0, 0), abs=1e-8)


@pytest.mark.parametrize(
    ("second", "low", "high", "by_hand"),
    [
        ("v_s", 0.03, 0.2, critical_speed),
        ("mu_s", 0.42, 0.9, lambda v: critical_speed(0.05, 2250 * (v - 0.4))),
        ("zeta_w", 0.004, 0.09, lambda v: critical_speed(0.05, zeta=0.05, zeta_w=v)),
        ("k_f", 200e3, 900e3, lambda v: critical_speed(0.05, k_f=v)),
        ("f_w", 150.0, 250.0, lambda v: critical_speed(0.05, f_w=v)),
    ],
)
def test_the_brake_by_hand(second, low, high, by_hand):
    graph, across = models.bicycle_brake.graph(), Vary("V0", 0.15, 1.5)
    (edge,) = assess(graph, vary=[across], span=None).edges
    curve = follow_edge(graph, edge, across, Vary(second, low, high))
    assert curve.edge_of_stability.all() and curve.ends == ("limit", "limit")
    for speed, value in curve.values[:: max(1, len(curve.values) // 12)]:
        assert speed == pytest.approx(by_hand(value), rel=1e-7)
    assert (curve.first_lyapunov > 0).all()


def test_a_boundary_may_pass_to_another_mode():
    """With the wheel damped more and more the frame is what loses its stability first."""
    graph, across = models.bicycle_brake.graph(), Vary("V0", 0.05, 1.5)
    (edge,) = assess(graph, vary=[across], span=None).edges
    curve = follow_edge(graph, edge, across, Vary("zeta_w", 0.01, 0.3))
    c = [critical_slope(zeta=0.05, zeta_w=z) for z in curve.values[:, 1]]
    first = [
        np.abs(np.linalg.eigvals(sliding_matrix(k, zeta_w=z)).imag[0]) / 2 / np.pi
        for k, z in zip(c, curve.values[:, 1], strict=True)
    ]
    assert len(first) == len(curve.values)
    outer = np.array([critical_speed(0.05, zeta=0.05, zeta_w=z) for z in curve.values[:, 1]])
    on_it = np.abs(curve.values[:, 0] - outer) < 1e-6 * outer
    assert (curve.edge_of_stability == on_it).all() and on_it.any() and not on_it.all()


def test_each_boundary_of_a_plane_once():
    graph = models.bicycle_brake.graph()
    plane = (Vary("V0", 0.15, 1.5, 30), Vary("v_s", 0.03, 0.3, 30))
    result = assess(graph, vary=plane, planes=[("V0", "v_s")], span=None)
    assert [len(locus.edges) for locus in result.loci] == [1, 1]
    (curve,) = result.boundaries
    assert curve.parameters == ("V0", "v_s") and curve.units == ("m/s", "m/s")
    # the first follows V0's edge; from v_s's alone it is the same curve, the other way round
    edges = {"v_s": result.loci[1].edges}
    (other,), notes = boundaries(graph, edges, plane)
    assert notes == () and other.parameters == ("V0", "v_s")
    for speed, v_s in other.values[::5]:
        assert speed == pytest.approx(critical_speed(v_s), rel=1e-7)


def test_what_cannot_be_followed_is_named():
    graph = models.bicycle_brake.graph()
    (edge,) = assess(graph, vary=["V0=0.25:1.5:20"], span=None).edges
    with pytest.raises(BondGraphError, match="along 'V0', not 'v_s'"):
        follow_edge(graph, edge, Vary("v_s", 0.1, 0.2), Vary("V0", 0.1, 0.2))
    with pytest.raises(ParameterError, match="not known; did you mean v_s"):
        follow_edge(graph, edge, Vary("V0", 0.1, 0.5), Vary("v_ss", 0.1, 0.2))
    with pytest.raises(ParameterError, match="needs a range of 'mu_s'; vary it"):
        assess(graph, vary=["V0=0.25:1.5:20"], planes=[("V0", "mu_s")])


def test_inputs_are_parameters_too():
    u = sympy.Symbol("u", real=True)
    law = R("diode", flow=lambda v: v**3 - b2 * v)
    graph = assemble(
        "diode", Sf("s", u) >> Zero("n") >> (C("c", 1), law), inputs={u: "A"}, parameters={b2: 3.0}
    )
    edge = assess(graph, inputs={"u": -3.0}, vary=["u=-3:4:30"], span=None).edges[-1]
    curve = follow_edge(graph, edge, Vary("u", -3, 4), Vary("b2", 0.1, 3))
    assert curve.values[:, 0] == pytest.approx(2 * (curve.values[:, 1] / 3) ** 1.5, rel=1e-9)
    assert curve.units[0] == "A"
    assert curve.to_json()["values"][0] == curve.values[0].tolist()
