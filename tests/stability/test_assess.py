"""Stability against closed forms, and the promises of its result."""

from __future__ import annotations

import json
import math
import time

import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, Se, Sf, Zero, assemble, linearize, models, steady_state
from bondgraph.errors import ParameterError
from bondgraph.stability import Vary, assess, trace
from bondgraph.stability.branch import Branch
from bondgraph.stability.locus import track
from tests.oracles.sliding import critical_slope, sliding_matrix, slope

BRAKE = models.bicycle_brake.graph()
FRAME = models.frame_brake.graph()
FIG9 = {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2}


@pytest.mark.parametrize(("v_s", "known"), [(0.05, 0.322324), (0.1, 0.575332), (0.2, 1.012035)])
def test_hopf_speeds_of_the_brake(v_s, known):
    (edge,) = assess(BRAKE, {"v_s": v_s}, vary=["V0=0.25:1.5:200"]).edges
    expected = v_s * math.log(-225 / (v_s * critical_slope()))
    assert edge.value == pytest.approx(expected, rel=1e-9)
    assert edge.value == pytest.approx(known, abs=6e-7)
    assert (edge.kind, edge.unstable_above, edge.boundary) == ("hopf", False, True)
    assert edge.frequency_hz == pytest.approx(200.460451, abs=1e-6)
    assert edge.first_lyapunov > 0 and edge.onset.kind == "hard"


@pytest.mark.parametrize(
    ("zeta", "slope_known", "hertz"),
    [(0.02, -2.863225, 200.073997), (0.05, -7.137493, 200.460451), (0.1, -14.127405, 201.810440)],
)
@pytest.mark.parametrize("points", [2, 7, 200])
def test_edges_are_found_at_any_damping_from_any_number_of_points(zeta, slope_known, hertz, points):
    values = {"zeta_f": zeta, "zeta_w": zeta, "v_s": 0.1}
    (edge,) = assess(BRAKE, values, vary=[("V0", 0.3, 1.5, points)]).edges
    assert slope(edge.value, 0.1) == pytest.approx(slope_known, rel=1e-6)
    assert slope(edge.value, 0.1) == pytest.approx(critical_slope(zeta=zeta), rel=1e-8)
    assert edge.frequency_hz == pytest.approx(hertz, abs=1e-6)


def test_the_frame_alone_is_unstable_below_its_own_damping():
    (edge,) = assess(FRAME, {"v_s": 0.2}, vary=["V0=0.25:1.5:200"]).edges
    assert slope(edge.value, 0.2) == pytest.approx(-18.5680767, rel=1e-8)
    assert edge.frequency_hz == pytest.approx(300, rel=1e-9)


@pytest.mark.parametrize(
    ("speed", "wheel", "frame"),
    [
        (0.9, 48.396984 + 1264.600102j, -32.399833 + 1871.435608j),
        (1.0, 3.938867 + 1259.894363j, -56.042124 + 1879.237633j),
        (1.2, -38.371027 + 1256.492865j, -80.089955 + 1882.590648j),
    ],
)
def test_eigenvalues_of_the_squealing_brake(speed, wheel, frame):
    result = assess(BRAKE, {**FIG9, "V0": speed})
    found = [row.eigenvalue for row in result.rows]
    for known in (wheel, frame):
        assert min(abs(value - known) for value in found) < 1e-6 * abs(known)
    by_hand = np.linalg.eigvals(sliding_matrix(slope(speed, 0.2)))
    for value in by_hand:
        assert min(abs(value - other) for other in found) < 1e-10 * abs(value)
    assert result.stable is (speed > 1.012035)


def test_the_wheel_makes_it_squeal():
    assert assess(FRAME, FIG9).stable
    result = assess(BRAKE, FIG9)
    assert not result.stable
    worst = result.critical
    assert worst.elements == ("wheel.rotor", "wheel.spokes")
    feeds = list(worst.feeds.items())
    assert feeds[0][0] == "friction" and feeds[0][1] > 0
    assert feeds[-1][0] == "wheel.spoke_damping" and feeds[-1][1] < 0


@pytest.mark.parametrize("name", models.LIBRARY)
def test_shares_and_feeds_add_up(name):
    result = assess(getattr(models, name).graph())
    for row in result.rows:
        assert sum(row.carriers.values()) == pytest.approx(1)
        assert sum(row.energies.values()) == pytest.approx(1)
        assert sum(row.feeds.values()) == pytest.approx(
            row.eigenvalue.real, abs=1e-8 * abs(row.eigenvalue)
        )
        assert "modulation" not in row.feeds


def test_json_is_the_contract():
    result = assess(BRAKE, FIG9, vary=["V0=0.9:1.2:50"])
    data = json.loads(json.dumps(result.to_json(), allow_nan=False))
    assert data["schema"] == 1 and data["model"] == "bicycle_brake" and data["stable"] is False
    assert data["states"] == list(result.system.states)
    assert {"slip", "omega_r", *data["states"]} <= set(data["operating_point"])
    for row in data["eigenvalues"]:
        assert set(row) == {"real", "imag", "frequency_hz", "damping_ratio"}
    first = data["eigenvalues"][0]
    assert first["frequency_hz"] == pytest.approx(first["imag"] / (2 * math.pi))
    assert first["damping_ratio"] == pytest.approx(
        -first["real"] / math.hypot(first["real"], first["imag"])
    )
    assert np.array(data["A"]) == pytest.approx(result.system.A)
    (edge,) = data["edges"]
    assert set(edge) == {
        "kind",
        "parameter",
        "value",
        "frequency_hz",
        "first_lyapunov",
        "onset",
        "slopes",
    }
    assert edge["slopes"] == {"friction": pytest.approx(-7.137493, rel=1e-6)}
    assert (edge["kind"], edge["parameter"], edge["onset"]) == ("hopf", "V0", "hard")


def test_an_eigenvalue_at_zero_has_no_damping_ratio():
    v = One("v")
    result = assess(assemble("free", Se("F", 0) >> v >> I("m", 2)))
    assert result.to_json()["eigenvalues"] == [
        {"real": 0.0, "imag": 0.0, "frequency_hz": 0.0, "damping_ratio": None}
    ]
    assert not result.stable and "neither" in result.verdict
    assert any("free" in warning for warning in result.warnings)


def test_undamped_is_neither_stable_nor_unstable():
    v = One("v")
    result = assess(assemble("swing", v >> (I("m", 2), C("k", stiffness=8))))
    assert not result.stable and [row.growth for row in result.rows] == [0, 0]


def test_verdict_says_it_in_words():
    result = assess(BRAKE, FIG9, vary=["V0=0.9:1.2:50"])
    first, second = result.verdict.splitlines()
    for part in ("unstable", "201.3 Hz", "wheel.rotor"):
        assert part in first, part
    assert "mu_k has to rise by 9.4 % to 0.437531 for it to become stable" in second
    assert any("V0 has to rise by 12.4 % to 1.01204 m/s" in sentence for sentence in result.advice)
    decides = " ".join(result.reasons)
    for part in (
        "friction feeds",
        "damper of -12.5",
        "Along V0 the nearest edge is at 1.01204 m/s",
    ):
        assert part in decides, part
    result = assess(BRAKE, vary=["V0=0.5:1.2:50"])
    assert "stable at this" in result.verdict
    assert "no edge from 0.5 to 1.2 m/s" in " ".join(result.reasons)


def diode():
    """A current into a capacitor and a diode whose voltage folds at a current of 2."""
    current = sympy.Symbol("i_0", real=True)
    node = Zero("node")
    law = R("diode", flow=lambda v: v**3 - 3 * v)
    return assemble(
        "diode", Sf("source", current) >> node >> (C("c", 1), law), parameters={current: (-3, "A")}
    )


def test_both_folds_of_a_branch_are_found():
    result = assess(diode(), vary=[("i_0", -3, 4, 30)])
    for edge, at, charge in zip(result.edges, (-2, 2), (1, -1), strict=True):
        assert edge.kind == "fold" and edge.unstable_above is None and edge.frequency_hz == 0
        assert edge.value == pytest.approx(at, rel=1e-10)
        assert edge.point.states["c.q"] == pytest.approx(charge, rel=1e-6)
    locus = result.loci[0]
    # of the two the branch meets that at 2 first, although -2 is nearer to -3
    assert locus.nearest is result.edges[1]
    turns = np.diff(np.sign(np.diff(locus.path.values))) != 0
    assert turns.sum() == 2 and locus.path.ends == ("limit", "limit")
    law = locus.path.states[:, 0] ** 3 - 3 * locus.path.states[:, 0]
    assert law == pytest.approx(locus.path.values, abs=1e-9)
    assert locus.gaps and "no steady state" in locus.gaps[0].reason
    assert np.isfinite(locus.eigenvalues[-1]).all()  # the search goes on behind the gap


def test_a_real_mode_that_crosses_is_called_fold():
    b = sympy.Symbol("b", real=True)
    v = One("v")
    spring = C("spring", effort=lambda q: b * q + q**3)
    graph = assemble("strut", v >> (I("m", 1), spring, R("d", 0.5)), parameters={b: 1.0})
    (edge,) = assess(graph, vary=[("b", -0.7, 1, 20)]).edges
    assert edge.kind == "fold" and edge.unstable_above is False
    assert edge.value == pytest.approx(0, abs=1e-12)


def test_an_instability_between_two_samples_is_not_overlooked():
    p = sympy.Symbol("p", real=True)
    v = One("v")
    damper = R("d", (p - sympy.Rational(1, 2)) ** 2 - sympy.Rational(1, 10**6))
    graph = assemble("window", v >> (I("m", 1), C("k", stiffness=9), damper), parameters={p: 0.0})
    edges = assess(graph, vary=[("p", 0.0, 1.01, 12)]).edges
    assert [edge.value for edge in edges] == pytest.approx([0.499, 0.501], rel=1e-9)


def test_points_where_the_contact_leaves_its_mode_are_named_gaps():
    result = assess(BRAKE, vary=[("V0", -0.5, 1.5, 40)])
    locus = result.loci[0]
    assert {gap.value for gap in locus.gaps} == set(locus.values[locus.values <= 0])
    assert all("leaves mode 'slip+'" in gap.reason for gap in locus.gaps)
    assert np.isnan(locus.eigenvalues[0]).all() and np.isfinite(locus.eigenvalues[-1]).all()
    assert any(warning.startswith("V0: left out") for warning in result.warnings)
    assert [edge.value for edge in result.edges] == pytest.approx([0.32232355], rel=1e-6)


def test_each_column_of_a_locus_follows_one_eigenvalue():
    locus = assess(BRAKE, {"v_s": 0.2}, vary=["V0=0.5:1.5:200"]).loci[0]
    steps = np.abs(np.diff(locus.eigenvalues, axis=0)).max(axis=1)
    apart = np.abs(locus.eigenvalues[:, :, None] - locus.eigenvalues[:, None, :])
    apart[:, range(5), range(5)] = np.inf
    assert (steps < 0.5 * apart.min(axis=(1, 2))[1:]).all()
    assert track(np.array([[1 + 1j, 1 - 1j], [2 - 1j, 2 + 1j]]))[1].tolist() == [2 + 1j, 2 - 1j]


def test_a_branch_agrees_with_a_linearisation_at_each_value():
    point = steady_state(BRAKE, FIG9)
    branch = Branch(BRAKE, point, "V0", FIG9)
    for speed in (0.5, 1.3):
        x = branch.solve(speed, branch.start)
        system = linearize(BRAKE, {**FIG9, "V0": speed})
        scale = np.abs(system.A).max(axis=1, keepdims=True) + 1e-300
        matrix = branch.smooth.state_matrix(x, *branch.arguments(speed))
        assert np.abs((matrix - system.A) / scale).max() < 1e-12
        there = branch.point_at(speed, x)
        assert there.outputs["slip"] == pytest.approx(speed)
        assert there.parameters["omega_t"] == pytest.approx(speed / 0.08)


def test_derived_parameters_follow_unless_they_are_given():
    frame_mode = {}
    for overrides in ({}, {"m_f": 0.0985067063}):
        locus = assess(BRAKE, overrides, vary=[("k_f", 350e3, 4 * 350e3, 3)]).loci[0]
        frame_mode[bool(overrides)] = locus.eigenvalues.imag.max(axis=1) / (2 * math.pi)
    assert frame_mode[False][-1] == pytest.approx(300, rel=0.01)  # f_f is kept, m_f grows
    assert frame_mode[True][-1] == pytest.approx(600, rel=0.01)  # m_f is kept
    derived = assess(BRAKE, vary=[("k_t", 576, 4 * 576, 3)]).loci[0]
    assert derived.eigenvalues.imag.max(axis=1)[-1] / (2 * math.pi) == pytest.approx(400, rel=0.01)


def test_inputs_can_be_varied():
    u = sympy.Symbol("u", real=True)
    node = Zero("node")
    law = R("diode", flow=lambda v: v**3 - 3 * v)
    graph = assemble("diode", Sf("source", u) >> node >> (C("c", 1), law), inputs={u: "A"})
    edge = assess(graph, inputs={"u": -3.0}, vary=[("u", -3, 4, 30)]).edges[-1]
    assert edge.parameter == "u" and edge.value == pytest.approx(2, rel=1e-10)


def test_ranges_take_units():
    locus = assess(BRAKE, vary=["V0=0.9:5.4:10[km/h]"]).loci[0]
    assert locus.values[[0, -1]] == pytest.approx([0.25, 1.5])
    assert Vary.parse("tau=1e-3:2e-2") == Vary("tau", 1e-3, 2e-2, 200)


@pytest.mark.parametrize(
    ("item", "said"),
    [
        ("V=0:1:10", "not known; did you mean V"),
        ("V0=1:1:10", "no range"),
        ("V0=0:nan:10", "no range"),
        ("V0=0:1:1", "at least two"),
        ("V0=0..1", "NAME=LO:HI:N"),
        ("mu_s=-1:1:10", "positive"),
        ("k_f=1:2:10[kg]", "does not measure"),
        (("V0", 1), "cannot be read"),
    ],
)
def test_bad_ranges_are_refused_by_name(item, said):
    with pytest.raises(ParameterError, match=said):
        assess(BRAKE, vary=[item])


def test_a_locus_of_the_brake_is_quick():
    point = steady_state(BRAKE, FIG9)
    spent = []
    for _ in range(3):
        start = time.process_time()
        trace(BRAKE, point, Vary("V0", 0.25, 1.5, 200), FIG9)
        spent.append(time.process_time() - start)
    assert min(spent) < 1.0
