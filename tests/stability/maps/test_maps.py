"""Maps against the scalar path, point by point, and against published eigenvalues."""

import numpy
import pytest
import sympy

from bondgraph import (
    C,
    Diode,
    EndStop,
    Friction,
    I,
    One,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    eigenvalue_map,
    linearize,
    models,
    steady_state,
)
from bondgraph.errors import BondGraphError, ParameterError
from bondgraph.resolver import Resolver
from bondgraph.stability.maps import PointOutcome

k, b, m, F = sympy.symbols("k b m F", positive=True)
VALUES = {k: 2.0, b: 0.3, m: 1.0, F: 5.0}
EVERY = ["k", "b", "m", "F"]


def line(name, *parts, source=None):
    """One-ports on a junction of one flow, pushed."""
    return assemble(name, (source or Se("E", F)) >> One("v") >> parts, parameters=VALUES)


def sled():
    slide = Friction("floor", kinetic=lambda speed: 10 * b)
    return line("sled", I("mass", m), C("spring", stiffness=k), slide)


GRAPHS = {
    "dependent storage": line("dependent", I("a", m), I("c", k), R("r", b), C("q", 2)),
    "nonlinear spring": line(
        "duffing", I("mass", m), R("r", b), C("q", effort=lambda q: k * q + q**3)
    ),
    "nonlinear loop": line(
        "dae", R("odd", effort=lambda f: k * f + b * f**3), C("c", m), I("l", m)
    ),
    "nonlinear node": assemble(
        "node",
        Sf("J", F) >> Zero("n") >> (C("c", m), R("r", effort=lambda f: k * f + b * f**3)),
        parameters=VALUES,
    ),
    "no isolated point": assemble(
        "coast", One("v") >> (I("mass", m), C("at", stiffness=0), R("r", b)), parameters=VALUES
    ),
    "none at all": line("thrown", I("mass", m)),
    "stuck or not": sled(),
    "diode": assemble(
        "rectifier",
        Se("E", F - 4) >> One("in") >> (Diode("d"), I("l", m), R("r", b), load := Zero("load")),
        load >> (C("c", k), R("lamp", 2)),
        parameters=VALUES,
    ),
    "end stop": line(
        "stopped",
        I("mass", m),
        (spring := C("s", stiffness=k)),
        EndStop("wall", gap=1 - spring.q, restitution=0),
        R("r", b),
    ),
}


def sampled(graph, names, count, spread):
    rng = numpy.random.default_rng(len(names))
    nominal = Resolver(graph.parameters)(partial=True)
    return {name: nominal[name] * rng.uniform(1 - spread, 1 + spread, count) for name in names}


def check(graph, points, **given):
    """Compare each point of a map with what the scalar path makes of it."""
    found = eigenvalue_map(graph, points, **given)
    for place in range(len(found)):
        own = {name: float(column[place]) for name, column in points.items()}
        try:
            point = steady_state(graph, own, **given)
            poles = linearize(graph, at=point).poles()
        except BondGraphError:
            assert not found.ok[place], own
            continue
        assert found.ok[place], (own, found.reasons)
        mine = found.eigenvalues[place]
        assert numpy.isnan(mine[len(poles) :]).all()
        off = abs(mine[: len(poles), None] - poles[None, :])
        scale = abs(poles).max(initial=1e-300)
        assert (
            max(off.min(axis=0).max(), off.min(axis=1).max()) <= 1e-9 * scale
            if len(poles)
            else True
        )
        states = [point.states.get(name, numpy.nan) for name in found.states]
        near = 1e-9 * numpy.nanmax(numpy.abs(states))
        assert found.steady_states[place] == pytest.approx(states, rel=1e-7, abs=near, nan_ok=True)
        assert bool(found.isolated[place]) == point.isolated
        for name, codes in found.modes.items():
            assert found.labels[name][int(codes[place])] == point.modes[name]
    return found


@pytest.mark.parametrize("spread", [0.4, 1.5], ids=["near", "some refused"])
@pytest.mark.parametrize("name", models.LIBRARY)
def test_library(name, spread):
    graph = getattr(models, name).graph()
    names = [symbol.name for symbol, row in graph.parameters.items() if not row.derived]
    found = check(graph, sampled(graph, names if spread < 1 else names[:2], 12, spread))
    assert found.ok.any()


@pytest.mark.parametrize("name", GRAPHS)
def test_other_graphs(name):
    check(GRAPHS[name], sampled(GRAPHS[name], EVERY, 12, 0.6))


def test_modes_are_those_of_each_point():
    graph = models.bicycle_brake.graph()
    found = check(graph, {"V0": numpy.array([-1.2, 1.2, -0.3])})
    assert found.modes["friction"].tolist() == [-1, 1, -1]


def test_held_modes():
    found = check(
        models.bicycle_brake.graph(), {"V0": numpy.array([0.0])}, modes={"friction": "stick"}
    )
    # 267.720392 Hz undamped, zeta .0491835; the number is from an independent solver
    natural = abs(found.leading) / (2 * numpy.pi)
    assert natural == pytest.approx(267.720392, rel=1e-8)
    assert found.damping_ratio == pytest.approx(0.0491835, abs=1e-7)


def test_published_eigenvalues():
    """Fig 9's set by slip speed, computed with an independent solver from the paper's Eq. 1."""
    found = eigenvalue_map(
        models.bicycle_brake.graph(), {"V0": numpy.array([0.9, 1.0, 1.2])}, {"v_s": 0.2}
    )
    wheel = [48.396984 + 1264.600102j, 3.938867 + 1259.894363j, -38.371027 + 1256.492865j]
    frame = [-32.399833 + 1871.435608j, -56.042124 + 1879.237633j, -80.089955 + 1882.590648j]
    for place in range(3):
        for expected in (wheel[place], frame[place]):
            assert abs(found.eigenvalues[place] - expected).min() < 2e-6
    assert found.leading == pytest.approx(numpy.array(wheel), rel=1e-8)
    assert found.stable.tolist() == [False, False, True]
    assert found.frequency_hz == pytest.approx(numpy.imag(wheel) / (2 * numpy.pi), rel=1e-8)


def test_the_boundary_of_a_product_is_the_published_one():
    """Unstable below v_s ln(N dmu/(v_s |c_H|)), c_H = -7.137493 N s/m."""
    axes = {"V0": numpy.linspace(0.2, 1.5, 40), "v_s": numpy.linspace(0.04, 0.2, 9)}
    found = eigenvalue_map(models.bicycle_brake.graph(), axes, product=True)
    edge = axes["v_s"] * numpy.log(225 / (axes["v_s"] * 7.137493))
    assert found.shape == (40, 9)
    expected = axes["V0"][:, None] > edge[None, :]
    assert (found.on_grid(found.stable) == expected).all()


def test_chunks_and_threads_change_nothing():
    axes = {"V0": numpy.linspace(-0.2, 1.5, 20), "v_s": numpy.linspace(-0.02, 0.2, 11)}
    graph = models.bicycle_brake.graph()
    whole = eigenvalue_map(graph, axes, product=True)
    parts = eigenvalue_map(graph, axes, product=True, chunk=7, workers=2)
    assert numpy.array_equal(whole.eigenvalues, parts.eigenvalues, equal_nan=True)
    assert (whole.outcomes == parts.outcomes).all() and whole.counts() == parts.counts()


def test_inputs_may_vary():
    u = sympy.Symbol("u")
    v = One("v")
    spring = C("q", effort=lambda q: k * q + q**3)
    graph = assemble(
        "pushed",
        Se("E", u) >> v >> (I("mass", m), R("r", b), spring),
        inputs=[u],
        parameters=VALUES,
    )
    found = eigenvalue_map(graph, {"u": numpy.array([0.0, 3.0])}, guess={"q.q": 0.5})
    # k q + q^3 = u has the root 1 at u = 3; the stiffness there is k + 3 q^2
    assert found.steady_states[:, found.states.index("q.q")] == pytest.approx([0, 1], abs=1e-9)
    stiffness = (abs(found.leading) ** 2).tolist()
    assert stiffness == pytest.approx([2.0, 5.0])


def test_units_are_converted_and_checked():
    graph = models.bicycle_brake.graph()
    found = eigenvalue_map(graph, {"k_f": (numpy.array([350.0]), "N/mm")})
    assert found.points["k_f"].tolist() == [350e3]
    with pytest.raises(ParameterError, match="k_f"):
        eigenvalue_map(graph, {"k_f": (numpy.array([350.0]), "kg")})


def test_points_are_refused_one_by_one_and_with_a_reason():
    found = eigenvalue_map(
        models.mass_on_belt.graph(), {"m": numpy.array([1.0, -1.0, numpy.nan, 2.0])}
    )
    assert found.outcomes.tolist() == [0, 1, 1, 0]
    assert found.reasons[PointOutcome.REFUSED] == "parameter 'm' is -1; it must be positive"
    assert numpy.isnan(found.growth).tolist() == [False, True, True, False]
    assert not found.stable[1] and "refused parameter" in repr(found)


def test_a_fold_is_no_steady_state_on_one_side():
    soft = C("q", effort=lambda q: k * q * sympy.exp(-q))
    graph = line("fold", I("mass", m), R("r", b), soft)
    push = numpy.linspace(0.1, 1.2, 12)  # the spring holds k/e = 0.7358 at most
    found = eigenvalue_map(graph, {"F": push})
    assert (found.ok == (push < 2 / numpy.e)).all()


def test_long_searches_are_bounded():
    graph = line("thrown", I("mass", m))
    found = eigenvalue_map(graph, {"F": numpy.linspace(1, 2, 5)}, searches=2)
    assert found.counts()[PointOutcome.NOT_TRIED.label] == 3
    assert found.counts()["no steady state"] == 2


def test_a_singular_fold_of_algebraic_variables_is_named():
    """At zero flow the law f**3 has no slope: the node's effort does not decide the flow."""
    graph = assemble(
        "cubic",
        Zero("n") >> (C("c", m), R("r", effort=lambda f: b * f**3 - k * f + F * f)),
        parameters=VALUES,
    )
    found = eigenvalue_map(graph, {"F": numpy.array([2.0, 3.0])})
    assert found.outcomes.tolist() == [PointOutcome.NOT_DETERMINED, PointOutcome.OK]


def test_names_and_shapes_are_checked_at_once():
    graph = models.bicycle_brake.graph()
    with pytest.raises(ParameterError, match="'V_0' is not known; did you mean V0"):
        eigenvalue_map(graph, {"V_0": numpy.ones(3)})
    with pytest.raises(ParameterError, match="product=True"):
        eigenvalue_map(graph, {"V0": numpy.ones(3), "v_s": numpy.ones(4)})
    with pytest.raises(ParameterError, match="one row of numbers"):
        eigenvalue_map(graph, {"V0": numpy.ones((3, 3))})
    with pytest.raises(ParameterError, match="array of numbers"):
        eigenvalue_map(graph, {"V0": "fast"})
    with pytest.raises(ParameterError, match="something that varies"):
        eigenvalue_map(graph, {})


def test_to_xarray():
    pytest.importorskip("xarray")
    axes = {"V0": numpy.array([0.9, 1.2]), "v_s": numpy.array([0.05, 0.1, 0.2])}
    found = eigenvalue_map(models.bicycle_brake.graph(), axes, product=True)
    data = found.to_xarray()
    assert dict(data.sizes) == {"V0": 2, "v_s": 3, "eigenvalue": 5, "state": 5}
    assert not data.stable.sel(V0=0.9, v_s=0.2) and data.stable.sel(V0=1.2, v_s=0.2)
    assert float(data.growth.sel(V0=0.9, v_s=0.2)) == pytest.approx(48.396984, rel=1e-7)
    listed = eigenvalue_map(models.bicycle_brake.graph(), {"V0": numpy.array([0.9, 1.2])})
    assert listed.to_xarray().sizes["point"] == 2
