"""Inputs of all kinds on all solvers, and output on any grid, against closed forms."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import sympy

from bondgraph import C, Diode, I, One, R, Samples, Se, Sf, Zero, assemble, simulate
from bondgraph.errors import ParameterError
from bondgraph.simulation.native import compiler
from bondgraph.simulation.problem import InputTable

U = sympy.Symbol("u")
WAYS = [
    *([{"backend": "native"}] if compiler.find_compiler() else []),
    {"backend": "vm"},
    *({"solver": name} for name in ("cvodes", "idas", "rosenbrock")),
]


def tank(extra=()):
    """q' = u - q."""
    return assemble(
        "tank", Sf("pump", U) >> Zero("z") >> (C("c", 1), R("leak", 1), *extra), inputs=[U]
    )


def diode_tank():
    """The same, with a diode that always blocks: its modes are searched."""
    z, path = Zero("z"), One("path")
    return assemble(
        "tank",
        Sf("pump", U) >> z >> (C("c", 1), R("leak", 1)),
        z >> path >> (Diode("d"), Se("far", 100)),
        inputs=[U],
    )


def response(omega, t):
    """q of q' = sin(omega t) - q from zero."""
    scale = 1 / (1 + omega**2)
    return scale * (np.sin(omega * t) - omega * np.cos(omega * t) + omega * np.exp(-t))


@pytest.mark.parametrize("way", WAYS, ids=str)
def test_band_limited_samples_on_every_solver(way):
    """Six samples a period: straight lines are off by 12 percent, this is not."""
    times = np.arange(0, 12.0001, 1 / 30)
    omega = 10 * math.pi
    grid = np.random.default_rng(2).uniform(1, 11, 60)
    grid.sort()
    taken = Samples(times, np.sin(omega * times), "band")
    run = simulate(tank(), 12.0, inputs={U: taken}, t_eval=grid, rtol=1e-8, **way)
    assert np.abs(run["u"] - np.sin(omega * grid)).max() < 2e-5
    # near the first sample the wave cannot be known: what is off there decays with exp(-t)
    off = run["c.q"] - response(omega, grid)
    assert np.abs(off - off[0] * np.exp(grid[0] - grid)).max() < 2e-6
    lines = simulate(tank(), 12.0, inputs={U: (times, taken.values)}, t_eval=grid, **way)
    assert np.abs(lines["u"] - np.sin(omega * grid)).max() > 0.05


@pytest.mark.skipif(not compiler.find_compiler(), reason="nothing to compare with")
@pytest.mark.parametrize("name", ["band", "linear", "zero"])
def test_twins_give_the_same_bits_on_cubics(name):
    values = np.random.default_rng(5).normal(size=60)
    inputs = {U: Samples(np.arange(60) / 20, values, name)}
    one, other = (
        simulate(tank(), 4.0, inputs=inputs, backend=backend) for backend in ("native", "vm")
    )
    assert np.array_equal(one.t, other.t) and np.array_equal(one.x, other.x)
    assert one.steps == other.steps and one.energy == other.energy


def test_inputs_of_different_holds_share_a_table():
    v, w = sympy.symbols("v w")
    graph = assemble(
        "three",
        (Sf("a", U), Sf("b", v), Sf("c", w)) >> Zero("z") >> (C("c0", 1), R("leak", 1e12)),
        inputs=[U, v, w],
    )
    times = np.linspace(0, 1, 41)
    inputs = {
        U: Samples(times, times**2, "band"),
        v: Samples([0.1, 0.65], [0, 1], "linear"),
        w: Samples([0.33], [2.0], "zero"),
    }
    for way in WAYS:
        run = simulate(graph, 1.0, inputs=inputs, rtol=1e-9, t_eval=[0.7, 1.0], **way)
        expected = 1 / 3 + (0.275 + 0.35) + 2.0
        assert run["c0.q"][-1] == pytest.approx(expected, abs=2e-5)
        assert run["v"][0] == 1 and run["w"][0] == 2
        assert run["u"][0] == pytest.approx(0.49, abs=1e-5)


@pytest.mark.parametrize("hold", ["band", "linear", "function"])
def test_rates_of_inputs_follow(hold):
    """A mass bound to a moving source: its force is m times the rate."""
    graph = assemble(
        "bound", Sf("source", U) >> One("j") >> (I("m", 2), C("k", stiffness=1)), inputs=[U]
    )
    times = np.linspace(0, 2, 201)
    given = math.sin if hold == "function" else Samples(times, np.sin(times), hold)
    grid = np.linspace(0.5, 1.5, 33)
    run = simulate(graph, 2.0, inputs={U: given}, t_eval=grid, rtol=1e-8)
    near = {"linear": 0.011, "band": 2e-4, "function": 2e-5}[hold]
    assert np.abs(run["m.e"] - 2 * np.cos(grid)).max() < near


def test_before_the_first_sample_rates_are_zero():
    graph = assemble(
        "bound", Sf("source", U) >> One("j") >> (I("m", 2), C("k", stiffness=1)), inputs=[U]
    )
    for hold in ("linear", "band"):
        given = Samples([1, 2, 3], [1, 2, 3], hold)
        run = simulate(graph, (0, 4), inputs={U: given}, t_eval=[0.5, 2.5, 3.5])
        assert run["m.e"] == pytest.approx([0, 2, 0], abs=1e-3)


def test_steps_are_refused_where_a_rate_is_needed():
    graph = assemble(
        "bound", Sf("source", U) >> One("j") >> (I("m", 2), C("k", stiffness=1)), inputs=[U]
    )
    with pytest.raises(ParameterError, match="'band'"):
        simulate(graph, 1, inputs={U: Samples([0, 1], [0, 3], "zero")})


def test_cubics_that_do_not_meet_are_jumps():
    cubics = np.zeros((3, 3, 1))
    cubics[:, 0] = 1.0
    table = InputTable([0, 1, 2], [[0.0], [1.0], [5.0]], [2], cubics)
    assert table.jumps.tolist() == [0, 0, 1]
    assert not table.shapes[-1].any()


GRIDS = {
    "one point": [0.7312],
    "ends": [0.0, 2.0],
    "start": [0.0],
    "end": [2.0],
    "dense": np.linspace(0, 2, 20_001),
    "close": 1.0 + 1e-9 * np.arange(50),
    "random": np.sort(np.random.default_rng(8).uniform(0, 2, 300)),
    "few": np.sort(np.random.default_rng(9).uniform(0, 2, 3)),
}


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("way", WAYS, ids=str)
def test_any_grid_is_met(way, grid):
    times = np.array(GRIDS[grid])
    wave = sympy.sin(7 * sympy.Symbol("t"))
    graph = assemble("tank", Sf("pump", wave) >> Zero("z") >> (C("c", 1), R("leak", 1)))
    run = simulate(graph, 2.0, t_eval=times, rtol=1e-9, **way)
    assert np.array_equal(run.t, times) and run.outcome.ok
    assert np.abs(run["c.q"] - response(7, times)).max() < 2e-8


@pytest.mark.parametrize("grid", GRIDS)
def test_any_grid_is_met_between_searched_modes(grid):
    times = np.array(GRIDS[grid])
    if grid == "dense":
        times = times[::10]
    run = simulate(diode_tank(), 2.0, t_eval=times, inputs={U: 1.0}, rtol=1e-9)
    assert np.array_equal(run.t, times)
    assert np.abs(run["c.q"] - (1 - np.exp(-times))).max() < 2e-9


@pytest.mark.parametrize("way", WAYS, ids=str)
def test_rows_do_not_depend_on_the_grid(way):
    wide = simulate(tank(), 2.0, inputs={U: 1.0}, t_eval=[0.5, 1.5], rtol=1e-8, **way)
    tight = simulate(tank(), 2.0, inputs={U: 1.0}, t_eval=np.linspace(0, 2, 81), rtol=1e-8, **way)
    for t, value in zip(wide.t, wide["c.q"], strict=True):
        at = int(np.argmin(np.abs(tight.t - t)))
        assert tight["c.q"][at] == pytest.approx(value, abs=2e-8)
    assert [len(run.t) for run in itertools.chain([wide, tight])] == [2, 81]
