"""simulate: closed forms, options, inputs, and what a trajectory gives."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from bondgraph import (
    C,
    CompiledModel,
    Friction,
    I,
    One,
    R,
    Samples,
    Se,
    Sf,
    Zero,
    assemble,
    models,
    simulate,
)
from bondgraph.errors import BondGraphError, ParameterError, SimulationError
from bondgraph.graph import TIME
from bondgraph.models import LIBRARY, mass_on_belt, quarter_car
from tests.oracles.belt import Belt


def oscillator(**options):
    v = One("v")
    return assemble("oscillator", v >> (I("m", 2, initial=3), C("k", stiffness=8)), **options)


def belt(mass=1, stiffness=100, speed=0.5, static=12, kinetic=8):
    z, body = Zero("belt"), One("body")
    contact = Friction("contact", kinetic=lambda slip: kinetic, breakaway=static)
    parts = (I("mass", mass), C("spring", stiffness=stiffness))
    return assemble("belt", Sf("drive", speed) >> z >> body >> parts, z >> contact)


def test_free_oscillation_follows_its_closed_form():
    t = np.linspace(0, 10, 101)
    run = simulate(oscillator(), (0, 10), t_eval=t, rtol=1e-10)
    assert np.abs(run["m.p"] - 3 * np.cos(2 * t)).max() < 1e-8
    assert np.abs(run["k.q"] - 0.75 * np.sin(2 * t)).max() < 1e-8
    assert run.energy.supplied == 0 and abs(run.energy.relative_residual) < 1e-9


def test_a_source_of_time_is_followed():
    """Se(exp(-t)) on R and C of one: q = t exp(-t)."""
    loop = One("loop")
    graph = assemble(
        "driven", Se("E", sympy.exp(-sympy.Symbol("t"))) >> loop >> (R("r", 1), C("c", 1))
    )
    t = np.linspace(0, 5, 51)
    run = simulate(graph, (0, 5), t_eval=t, rtol=1e-10)
    assert np.abs(run["c.q"] - t * np.exp(-t)).max() < 1e-9


BELTS = [
    Belt(),
    Belt(m=2.0, k=30.0, v_b=0.2, F_s=5.0, F_k=2.0),
    Belt(m=0.5, k=400.0, v_b=1.0, F_s=9.0, F_k=8.5),
]


@pytest.mark.parametrize("moves", [False, True], ids=["from rest", "riding the belt"])
@pytest.mark.parametrize("case", BELTS)
def test_mass_on_belt_meets_the_closed_form(case, moves):
    end, start = 6 * case.period, case.v_b if moves else 0.0
    expected = case.events(end, 0.0, start)
    graph = belt(case.m, case.k, case.v_b, case.F_s, case.F_k)
    for rtol, tolerance in ((1e-8, 1e-8), (1e-4, 1e-3)):
        run = simulate(graph, end, initial={"mass.p": case.m * start}, rtol=rtol)
        assert [(e.from_mode, e.to_mode) for e in run.events] == [
            (e.left, e.entered) for e in expected
        ]
        gaps = [found.t - right.t for found, right in zip(run.events, expected, strict=True)]
        assert max(map(abs, gaps), default=0.0) < tolerance


def test_a_braked_mass_stops_once_and_stays():
    v = One("v")
    graph = assemble("sled", v >> (I("m", 2, initial=8), Friction("floor", kinetic=lambda slip: 4)))
    run = simulate(graph, 5, rtol=1e-9)
    assert [(event.from_mode, event.to_mode) for event in run.events] == [("slip+", "stick")]
    assert run.events[0].t == pytest.approx(2.0, abs=1e-9)
    assert run.final["m.p"] == pytest.approx(0, abs=1e-12)
    assert run.energy.dissipated == pytest.approx(16.0, rel=1e-9)


def test_a_pushed_mass_breaks_away_when_the_push_exceeds_the_hold():
    push = sympy.Symbol("push")
    v = One("v")
    graph = assemble(
        "pushed",
        Se("hand", push)
        >> v
        >> (I("m", 1), Friction("floor", kinetic=lambda slip: 3, breakaway=4)),
        inputs={push: "N"},
    )
    run = simulate(graph, 6, inputs={"push": ([0, 6], [0, 6])}, rtol=1e-9)
    assert [(e.from_mode, e.to_mode) for e in run.events] == [("stick", "slip+")]
    assert run.events[0].t == pytest.approx(4.0, abs=1e-9)
    assert run.final["m.p"] == pytest.approx((36 - 16) / 2 - 3 * 2, rel=1e-9)


@pytest.mark.parametrize("backend", ["native", "vm"])
def test_inputs_are_held_as_declared(backend):
    u = sympy.Symbol("u")
    graph = assemble(
        "integrator", Sf("pump", u) >> Zero("tank") >> (C("level", 1), R("leak", 1e9)), inputs=[u]
    )
    times, values = [0, 1, 2], [1, 3, 2]
    for hold, volume in (("linear", 2 + 2.5 + 2), ("zero", 1 + 3 + 2)):
        run = simulate(
            graph, 3, inputs={u: Samples(times, values, hold)}, backend=backend, rtol=1e-10
        )
        assert run.final["level.q"] == pytest.approx(volume, rel=1e-7)


def test_a_callable_input_runs_on_the_virtual_machine():
    run = simulate(
        quarter_car.graph(), 0.2, inputs={"v_road": lambda t: 0.1 * math.sin(30 * t)}, rtol=1e-8
    )
    t = np.linspace(0, 0.2, 4001)
    table = simulate(
        quarter_car.graph(), 0.2, inputs={"v_road": (t, 0.1 * np.sin(30 * t))}, rtol=1e-8
    )
    assert run.backend == "vm"
    assert run.final["v_body"] == pytest.approx(table.final["v_body"], rel=1e-4)


def test_input_that_drives_a_dependent_storage_needs_its_rate():
    v = sympy.Symbol("v")
    j = One("j")
    graph = assemble(
        "dependent",
        Sf("source", v) >> j >> (I("m", 2), C("k", stiffness=1)),
        inputs=[v],
        outputs={"force": j.f * 0 + sympy.Integer(0)},
    )
    run = simulate(graph, 1, inputs={v: ([0, 1], [0, 3])}, rtol=1e-9)
    assert run["m.e"][1] == pytest.approx(6.0)
    with pytest.raises(ParameterError, match="steps"):
        simulate(graph, 1, inputs={v: Samples([0, 1], [0, 3], "zero")})


@pytest.mark.parametrize("name", LIBRARY)
def test_energy_is_balanced_on_every_model(name):
    run = simulate(getattr(models, name).graph(), 0.3, rtol=1e-9)
    assert run.outcome.ok
    assert abs(run.energy.relative_residual) < 1e-8


def test_energy_of_a_nonlinear_law_without_potential_is_integrated():
    v = One("v")
    graph = assemble("hard", v >> (I("m", 1, initial=1), C("k", effort=sympy.sinh)))
    run = simulate(graph, 5, rtol=1e-10)
    assert abs(run.energy.relative_residual) < 1e-9


def test_a_modulated_storage_is_audited_with_the_work_of_its_modulation():
    v = One("v")
    stiffness = 4 + sympy.sin(sympy.Symbol("t"))
    graph = assemble("pumped", v >> (I("m", 1, initial=1), C("k", stiffness=stiffness)))
    run = simulate(graph, 7, rtol=1e-10)
    assert abs(run.energy.supplied) > 1e-2
    assert abs(run.energy.relative_residual) < 1e-8


def test_names_reach_states_outputs_ports_and_units():
    run = simulate(mass_on_belt.graph(), 0.5, t_eval=np.linspace(0, 0.5, 11))
    assert np.allclose(run["v"], run["mass.f"]) and np.allclose(run["mass.p"], run["v"])
    assert np.allclose(run["contact.f"], run["slip"])
    assert run.unit("x") == "m" and run.unit("mass.p") == "N*s"
    with pytest.raises(ParameterError, match=r"did you mean .*mass\.p"):
        run["mas.p"]


def test_port_variables_follow_the_mode_of_each_sample():
    run = simulate(belt(), 1.0, t_eval=np.linspace(0, 1, 501))
    stuck = run.modes["contact"] == "stick"
    assert stuck.any() and not stuck.all()
    assert np.allclose(run["contact.e"][~stuck], 8 * np.sign(run["contact.f"][~stuck]))
    assert np.allclose(run["contact.e"][stuck], 100 * run["spring.q"][stuck])


def test_steps_are_reported_with_both_sides_of_events():
    run = simulate(belt(), 1.0)
    assert (np.diff(run.t) >= 0).all() and run.t[0] == 0 and run.t[-1] == 1.0
    for event in run.events:
        assert (run.t == event.t).sum() == 2


def test_initial_values_by_state_output_and_symbol():
    graph = mass_on_belt.graph()
    assert simulate(graph, 0.1, initial={"v": 0.1}).x[0, 0] == pytest.approx(0.1)
    assert simulate(graph, 0.1, initial={"mass.p": 0.1}).x[0, 0] == pytest.approx(0.1)
    with pytest.raises(ParameterError, match="spring"):
        simulate(graph, 0.1, initial={"sprng.q": 0.1})
    with pytest.raises(ParameterError, match="finite"):
        simulate(graph, 0.1, initial={"v": math.nan})


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"t_span": -1}, "after it starts"),
        ({"t_span": math.nan}, "finite"),
        ({"t_span": (1, 1)}, "after it starts"),
        ({"rtol": 0}, "between"),
        ({"rtol": math.nan}, "between"),
        ({"t_eval": [0.2, 0.1]}, "increasing"),
        ({"t_eval": [0.0, 2.0]}, "outside"),
        ({"inputs": {"v_rod": 1.0}}, "did you mean v_road"),
        ({"inputs": {"v_road": ([0, 0], [1, 1])}}, "increase"),
        ({"inputs": {"v_road": math.inf}}, "finite"),
        ({"inputs": {"v_road": "fast"}}, "expected a number"),
    ],
)
def test_bad_options_are_refused_by_name(options, words):
    settings = {"t_span": 1.0, **options}
    with pytest.raises(BondGraphError, match=words):
        simulate(quarter_car.graph(), **settings)


def test_a_missing_parameter_is_named():
    v = One("v")
    graph = assemble("m", v >> (I("m", sympy.Symbol("mass")), R("b", 1)))
    with pytest.raises(ParameterError, match="mass"):
        simulate(graph, 1)


def test_a_spring_whose_law_jumps():
    """Thrown up with 1 m/s against a constant force of 2 N it is back after 1 s."""
    parts = (I("m", 1, initial=1), C("k", effort=lambda q: 2 * sympy.sign(q)))
    run = simulate(assemble("bounce", One("v") >> parts), 0.99, t_eval=[0.5, 0.99])
    assert run["k.q"] == pytest.approx([0.25, 0.99 - 0.99**2], abs=1e-4)


def test_an_escape_ends_in_a_named_outcome_and_keeps_the_last_good_state():
    """p' = p^2 reaches infinity at t = 1."""
    v = One("v")
    mass = I("m", 1, initial=1)
    graph = assemble("escape", Se("push", mass.p**2) >> v >> mass)
    run = simulate(graph, 2)
    assert not run.outcome.ok
    assert run.t_end == pytest.approx(1, abs=1e-3)
    assert math.isfinite(run.final["m.p"])


def test_an_event_limit_is_a_named_outcome():
    run = simulate(belt(), 100, max_events=5)
    assert run.outcome.value == "event limit" and len(run.events) == 5


def test_one_compiled_model_serves_many_values():
    model = CompiledModel(mass_on_belt.graph())
    periods = [np.diff(simulate(model, 8, {"k": k}).sticks())[-1] for k in (50.0, 100.0)]
    assert periods[0] > periods[1]


def test_files_hold_what_the_trajectory_holds(tmp_path):
    run = simulate(mass_on_belt.graph(), 1.0, t_eval=np.linspace(0, 1, 11))
    path = run.save(tmp_path / "run.csv")
    lines = path.read_text().splitlines()
    assert lines[1] == "time [s],x [m],v [m/s],slip [m/s],mass.p [N*s],spring.q [m]"
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[2:]])
    assert np.array_equal(rows[:, 1], run["x"]) and np.array_equal(rows[:, 0], run.t)
    import xarray

    with xarray.open_dataset(run.save(tmp_path / "run.nc")) as data:
        assert np.array_equal(data["x"], run["x"])
        assert data["v"].attrs["units"] == "m/s" and data.attrs["outcome"] == "finished"
    assert run.to_dataframe()["slip"].iloc[-1] == run["slip"][-1]
    again = Samples.read(path, "x", "mm")
    assert np.allclose(again.values, run["x"])
    with pytest.raises(SimulationError, match="ending"):
        run.save(tmp_path / "run.xls")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "header"),
        ("time [s],v_road [m/s]\n", "no rows"),
        ("time [s],v_road [kg]\n0,1\n", "does not measure"),
        ("time [s],v_road [m/s]\n0,fast\n", "line 2.*no number"),
        ("time [s],v_road [m/s]\n0,nan\n", "line 2.*finite"),
        ("time [s],v_road [m/s]\n1,1\n0,1\n", "increase"),
        ("time [s],a [m],b [m]\n0,1,2\n", "no column 'v_road'"),
        ("time [s],v_road [m/s]\n0\n", "line 2"),
    ],
)
def test_bad_input_files_are_refused_by_line(tmp_path, text, words):
    path = tmp_path / "road.csv"
    path.write_text(text)
    with pytest.raises(ParameterError, match=words):
        Samples.read(path, "v_road", "m/s")


def test_a_tank_drains_through_an_orifice():
    """``q' = -sqrt(q / 2) / 2``: the root falls in proportion to time; the law is given as effort."""
    hole = R("hole", effort=lambda f: 4 * f * abs(f))
    graph = assemble("tank", Zero("z") >> (C("tank", 2, initial=8), hole))
    run = simulate(graph, 12.0, rtol=1e-9)
    expected = (math.sqrt(8) - run.t / (4 * math.sqrt(2))) ** 2
    assert run["tank.q"] == pytest.approx(expected, rel=1e-7)
    assert run["hole.e"] == pytest.approx(4 * run["hole.f"] ** 2)


@pytest.mark.parametrize("level", [0.8, 0.05, 3.0])
@pytest.mark.parametrize("backend", ["native", "vm"])
def test_breaking_loose_under_a_force_that_rises_smoothly(level, backend):
    """Slip begins with no speed and no acceleration: all that a first step sees is rounding."""
    v = One("v")
    graph = assemble(
        "block",
        Se("F", 8 * sympy.sin(9 * TIME))
        >> v
        >> (I("m", 1), R("b", 2), Friction("c", kinetic=lambda speed: sympy.Rational(str(level)))),
    )
    run = simulate(graph, 0.3, t_eval=[0.1, 0.3], backend=backend, rtol=1e-9)
    assert run.outcome.ok
    begin = math.asin(level / 8) / 9
    assert run.events[0].t == pytest.approx(begin, abs=1e-12) and run.events[0].to_mode == "slip+"

    def rate(t, p):
        return 8 * np.sin(9 * t) - level - 2 * p

    exact = solve_ivp(rate, (begin, 0.3), [0.0], t_eval=[0.1, 0.3], rtol=1e-11, atol=1e-13)
    assert run["m.p"] == pytest.approx(exact.y[0], rel=1e-7)
