"""Sensitivities through events against closed forms and central differences of runs."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

from bondgraph import (
    TIME,
    C,
    Clutch,
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
    sensitivities,
    simulate,
)
from bondgraph.errors import ParameterError, SimulationError
from bondgraph.models import bicycle_brake, frame_brake, mass_on_belt, quarter_car
from bondgraph.simulation.native import compiler
from tests.differences import STEPS, differences

BACKENDS = ["native", "vm"] if compiler.find_compiler() else ["vm"]
compiled = pytest.mark.skipif(len(BACKENDS) < 2, reason="slow on the virtual machine")


CLOSE = 1e-6


def agree(
    model, until, names, sizes=None, rtol=1e-10, times=101, runs=1e-12, steps=STEPS, **options
):
    """Hold sensitivities along a run, at its end and of its events against differences."""
    grid = np.linspace(0, until, times)
    exact = sensitivities(model, until, names, t_eval=grid, rtol=rtol, **options)
    assert exact.trajectory.outcome.ok
    for c, name in enumerate(names):
        size = (sizes or {}).get(name)
        moving = exact.x[:, c].any(axis=1)
        how = {"size": size, "moving": moving, "rtol": runs, "steps": steps}
        found = differences(model, until, name, grid, **how, **options)
        error = np.abs(exact.x[:, c] - found.x)[:, found.far].max(axis=1)
        # the mean of two steps is several times as good as they agree
        allowed = (CLOSE + found.doubt / 4) * found.scale
        assert found.doubt < 5e-6, name
        assert (error <= allowed)[moving].all(), name
        still = np.abs(exact.trajectory.x).max(axis=1) / (size or exact.trajectory.parameters[name])
        assert (error < 1e-3 * still)[~moving].all(), name
        if found.far[-1]:
            error = np.abs(exact.x_end[:, c] - found.x[:, -1])
            assert (error <= allowed)[moving].all(), name
        if found.events is not None and np.abs(found.events).max(initial=0.0) > 0:
            scale = max(np.abs(found.events).max(), 1e-9)
            error = np.abs(exact.events[:, c] - found.events).max()
            assert error < (CLOSE + found.doubt / 4) * scale, name
    return exact


# ---------------------------------------------------------------------- closed forms


def rc():
    tau_r, c, e = sympy.symbols("r c E", positive=True)
    loop = One("loop")
    return assemble(
        "rc",
        Se("E", e) >> loop >> (R("R", tau_r), C("C", c)),
        parameters={tau_r: 2.0, c: 0.25, e: 3.0},
    )


@pytest.mark.parametrize("backend", BACKENDS)
def test_charging_a_capacitor(backend):
    """q = c E (1 - exp(-t/rc)) + q0 exp(-t/rc)."""
    t = np.linspace(0, 2, 41)
    found = sensitivities(rc(), 2.0, ["r", "c", "E", "C.q"], t_eval=t, rtol=1e-11, backend=backend)
    r, c, e = 2.0, 0.25, 3.0
    decay = np.exp(-t / (r * c))
    expected = np.array(
        [
            -e * t / r**2 * decay,
            e * (1 - decay) - e * t / (r * c) * decay,
            c * (1 - decay),
            decay,
        ]
    )
    assert found.x[0] == pytest.approx(expected, abs=1e-9)
    assert found["C.q"] == pytest.approx(expected, abs=1e-9)
    # the current (E - q/c)/r depends on the parameters itself, too
    q = c * e * (1 - decay)
    direct = np.array([-(e - q / c) / r**2, q / c**2 / r, np.full_like(t, 1 / r), 0 * t])
    assert found["R.f"] == pytest.approx(direct - expected / (c * r), abs=1e-8)


def belt(start=0.0):
    """Mass on a belt with constant friction: each phase is a line or a harmonic."""
    m, k, v_b, F_s, F_k = sympy.symbols("m k v_b F_s F_k", positive=True)
    side, body = Zero("belt"), One("body")
    return assemble(
        "belt",
        Sf("drive", v_b) >> side >> body >> (I("mass", m), C("spring", stiffness=k, initial=start)),
        side >> Friction("contact", kinetic=lambda speed: F_k, breakaway=F_s),
        parameters={m: 1.0, k: 100.0, v_b: 0.5, F_s: 12.0, F_k: 8.0},
    )


def stick_and_slip():
    """Durations of stick and slip of the belt's settled cycle, and their derivatives."""
    symbols = m, k, v_b, F_s, F_k = sympy.symbols("m k v_b F_s F_k", positive=True)
    omega = sympy.sqrt(k / m)
    stick = 2 * (F_s - F_k) / (k * v_b)
    slip = 2 * (sympy.pi - sympy.atan((F_s - F_k) / k * omega / v_b)) / omega
    at = dict(zip(symbols, (1, 100, sympy.Rational(1, 2), 12, 8), strict=True))
    return [
        np.array([float(sympy.diff(of, symbol).subs(at)) for symbol in symbols])
        for of in (stick, slip)
    ]


@pytest.mark.parametrize("backend", BACKENDS)
def test_event_times_of_a_mass_on_a_belt(backend):
    """Stuck from x = 0 it lets go at F_s/(k v_b); each cycle then adds a slip and a stick."""
    names = ["m", "k", "v_b", "F_s", "F_k"]
    found = sensitivities(belt(), 3.0, names, None, {"mass.p": 0.5}, rtol=1e-11, backend=backend)
    # the momentum at the start is given: a faster belt drags the mass along at once
    stick, slip = stick_and_slip()
    first = np.array([0, -12 / (100**2 * 0.5), -12 / (100 * 0.5**2), 1 / 50, 0])
    expected = [first]
    for event in found.trajectory.events[1:]:
        expected.append(expected[-1] + (slip if event.to_mode == "stick" else stick))
    assert len(expected) == 9
    assert found.events == pytest.approx(np.array(expected), abs=2e-8)


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_sticks_at_the_start_stays_stuck_when_the_belt_is_changed(backend):
    """p(0) is given, but the belt's speed is that of the mass as long as it sticks."""
    found = sensitivities(
        belt(), 0.2, ["v_b", "m", "mass.p", "spring.q"], None, {"mass.p": 0.5}, backend=backend
    )
    t = found.trajectory.t
    assert found["mass.p"] == pytest.approx(np.array([1 + 0 * t, 0.5 + 0 * t, 0 * t, 0 * t]))
    assert found["spring.q"] == pytest.approx(np.array([t, 0 * t, 0 * t, 1 + 0 * t]))
    assert found["contact.f"] == pytest.approx(np.zeros((4, len(t))), abs=1e-12)


# ---------------------------------------------------------------------- differences

BRAKE = ["V0", "F_k", "zeta_f", "mu_s", "v_s", "k_f", "tau", "k_w"]
FIGURES = {
    "fig6": ({"mu_s": 0.42, "tau": 0.03}, 0),
    "fig7": ({"mu_s": 0.42, "tau": 0.02}, 2),
    "fig8": ({"mu_s": 0.5, "tau": 0.02}, 87),
    "fig9": ({"mu_s": 0.5, "tau": 0.06, "v_s": 0.2}, 71),
}


@pytest.fixture(scope="module")
def brake():
    return CompiledModel(bicycle_brake.graph())


@compiled
@pytest.mark.parametrize(
    ("figure", "names"),
    [
        ("fig6", BRAKE),
        ("fig7", BRAKE),
        ("fig8", ["V0", "zeta_f"]),
        pytest.param("fig8", BRAKE, marks=pytest.mark.slow),
        ("fig9", BRAKE),
    ],
)
def test_the_brake_through_all_its_sticks(brake, figure, names):
    given, events = FIGURES[figure]
    found = agree(
        brake,
        0.3,
        [*names, "rear.bending.q"],
        {"rear.bending.q": 2e-3},
        parameters=given,
        times=301,
        rtol=1e-11,
        runs=1e-12 if figure in ("fig7", "fig9") else 1e-13,
    )
    assert len(found.events) == events


def test_the_run_is_that_of_simulate(brake):
    for grid in (None, np.linspace(0, 0.02, 57)):
        for backend in BACKENDS:
            given = {"parameters": {"tau": 0.02}, "t_eval": grid, "backend": backend}
            found = sensitivities(brake, 0.02, ["V0", "k_f"], **given)
            run = simulate(brake, 0.02, **given)
            assert np.array_equal(found.trajectory.x, run.x)
            assert np.array_equal(found.trajectory.t, run.t)
            assert found.trajectory.events == run.events
            assert found.x.shape == (5, 2, len(run.t))


def test_a_mass_on_a_belt():
    names = ["m", "k", "c", "N", "mu_s", "mu_k", "v_s", "v_b", "spring.q", "mass.p"]
    model = CompiledModel(mass_on_belt.graph())
    found = agree(model, 2.0, names, {"spring.q": 0.01, "mass.p": 0.1}, times=51)
    assert len(found.events) > 4


@pytest.mark.parametrize("hold", ["zero", "linear", "band"])
def test_a_quarter_car_on_a_road(hold):
    road = Samples(np.linspace(0, 1, 11), np.sin(7 * np.arange(11.0)), hold)
    model = CompiledModel(quarter_car.graph())
    agree(model, 1.2, ["m_s", "m_u", "k_s", "k_t", "b_s", "g"], times=51, inputs={"v_road": road})


def clutch():
    names = "J1 J2 drag torque plate k"
    J1, J2, drag, torque, plate, k = sympy.symbols(names, positive=True)
    pressure = sympy.Symbol("pressure")
    engine, plates, load = One("engine"), Zero("plates"), One("load")
    return assemble(
        "driveline",
        Se("T", torque * (1 + sympy.sin(9 * TIME) / 2)) >> engine >> I("J1", J1),
        engine >> plates >> load >> (I("J2", J2), R("drag", drag), C("shaft", stiffness=k)),
        plates >> Clutch("c", plate * pressure, static=1.2 * plate * pressure),
        parameters={J1: 0.2, J2: 0.5, drag: 0.3, torque: 3.0, plate: 4.0, k: 2.0},
        inputs=[pressure],
    )


@pytest.mark.parametrize("hold", ["zero", "linear", "band"])
def test_a_clutch_that_is_pressed_and_let_go(hold):
    pressed = Samples([0, 0.5, 1, 1.5, 2, 2.5], [0.2, 1, 1.7, 0.6, 1.8, 0.3], hold)
    found = agree(
        CompiledModel(clutch()),
        3.0,
        ["J1", "J2", "drag", "torque", "plate", "k", "J1.p"],
        {"J1.p": 0.3},
        times=61,
        initial={"J1.p": 0.3},
        inputs={"pressure": pressed},
        max_step=0.02,
    )
    modes = {(event.from_mode, event.to_mode) for event in found.trajectory.events}
    assert {("slip+", "stick"), ("stick", "slip+")} <= modes


def test_two_frictions_in_a_row():
    F1, F2, k, v = sympy.symbols("F1 F2 k v", positive=True)
    a, b, belt1, belt2 = One("a"), One("b"), Zero("belt1"), Zero("belt2")
    between, tie = Zero("between"), One("tie")
    graph = assemble(
        "two",
        Sf("drive1", v) >> belt1 >> a >> (I("m1", 1), C("s1", stiffness=k), R("r1", 0.5)),
        belt1 >> Friction("one", kinetic=lambda speed: F1 / (1 + speed), breakaway=1.3 * F1),
        Sf("drive2", v) >> belt2 >> b >> (I("m2", 2), C("s2", stiffness=1.7 * k)),
        belt2 >> Friction("other", kinetic=lambda speed: F2 / (1 + 2 * speed)),
        a >> between >> b,
        between >> tie >> (C("spring", stiffness=k / 3), R("loose", 2)),
        parameters={F1: 3.0, F2: 5.0, k: 90.0, v: 0.4},
    )
    found = agree(CompiledModel(graph), 3.0, ["F1", "F2", "k", "v"], times=61)
    assert {event.element for event in found.trajectory.events} == {"one", "other"}


def test_functions_of_time_run_on_the_virtual_machine():
    model = CompiledModel(quarter_car.graph())
    t = np.linspace(0, 1, 21)
    smooth = {"v_road": lambda time: np.sin(5 * time)}
    fine = np.linspace(0, 1, 4001)
    table = {"v_road": Samples(fine, np.sin(5 * fine))}
    one = sensitivities(model, 1.0, ["k_s"], inputs=smooth, t_eval=t, rtol=1e-9)
    other = sensitivities(model, 1.0, ["k_s"], inputs=table, t_eval=t, rtol=1e-9)
    assert one.trajectory.backend == "vm"
    assert np.abs(one.x - other.x).max() < 1e-6 * np.abs(one.x).max()


# ---------------------------------------------------------------------- signals, units, refusals


@compiled
def test_signals_by_differences(brake):
    """Outputs and port variables depend on parameters themselves, and differently by mode."""
    t = np.linspace(0, 0.05, 83)
    names = ["mu_s", "k_f", "V0"]
    given = {"tau": 0.02}
    found = sensitivities(brake, 0.05, names, given, t_eval=t, rtol=1e-10)
    assert set(found.trajectory.modes["friction"]) == {"stick", "slip+"}
    for c, name in enumerate(names):
        step = 1e-5 * found.trajectory.parameters[name]
        middle = found.trajectory.parameters[name]
        ends = [
            simulate(brake, 0.05, {**given, name: middle + s * step}, t_eval=t, rtol=1e-12)
            for s in (1, -1)
        ]
        same = (ends[0].codes == ends[1].codes)[:, 0] & (ends[0].codes == found.trajectory.codes)[
            :, 0
        ]
        for signal in ("F_f", "slip", "rear.bending.e", "friction.e", "x_c"):
            slope = (ends[0][signal] - ends[1][signal]) / (2 * step)
            scale = np.abs(slope[same]).max()
            error = np.abs(found[signal][c] - slope)[same].max()
            assert error < 1e-4 * scale, (name, signal)
    assert np.array_equal(found["rear.bending.q"], found.x[3])
    assert np.array_equal(found["mu_s"], np.array([1 + 0 * t, 0 * t, 0 * t]))


def test_units(brake):
    found = sensitivities(brake, 1e-3, ["V0", "k_f", "mu_s", "rear.bending.q"])
    assert found.unit("x_c", "V0") == "m/(m/s)"
    assert found.unit("x_c", "k_f") == "m/(kg/s^2)"
    assert found.unit("x_c", "mu_s") == "m"
    assert found.unit("t", "rear.bending.q") == "s/(m)"
    with pytest.raises(ParameterError, match="k_w"):
        found.unit("x_c", "k_w")


def test_frame_brake_by_every_parameter():
    model = CompiledModel(frame_brake.graph())
    names = [symbol.name for symbol in model.equations.graph.parameters]
    found = sensitivities(model, 0.05, names)
    assert found.x.shape[1] == len(names) and np.isfinite(found.x).all()
    assert "by " in repr(found) and "finished" in repr(found)


@pytest.mark.parametrize(
    ("wrt", "match"),
    [
        (["k", "mu_z"], r"'mu_z' is not known; did you mean mu_[sk] or mu_[sk]"),
        (["masss.p"], r"'masss.p'.*did you mean mass.p"),
        (["k", "k"], "'k' stands twice"),
        ([], "wrt is empty"),
        (3, "wrt must be names"),
    ],
)
def test_unknown_names_are_refused_before_the_run(wrt, match):
    with pytest.raises(ParameterError, match=match):
        sensitivities(mass_on_belt.graph(), 1.0, wrt)


def swing(excess):
    """Swings about F/k = 0.08 at 10 rad/s, by `excess` in energy faster than the belt at most."""
    speed = sympy.Symbol("speed", positive=True)
    side, body, reach = Zero("belt"), One("body"), 0.05 * np.sqrt(1 + excess)
    mass = I("mass", 1, initial=float(10 * reach * np.sin(1)))
    spring = C("spring", stiffness=100, initial=float(0.08 - reach * np.cos(1)))
    return assemble(
        "swing",
        Sf("drive", speed) >> side >> body >> (mass, spring),
        side >> Friction("contact", kinetic=lambda v: 8, breakaway=9),
        parameters={speed: 0.5},
    )


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_grazing_contact_has_no_derivative(backend):
    """v(t) = 10 a sin(1 + 10 t) meets the belt's speed where dt/dspeed = 1/v'."""
    excess = 1e-5
    found = sensitivities(swing(excess), 0.3, ["speed"], rtol=1e-9, backend=backend)
    assert found.events[0, 0] == pytest.approx(1 / (10 * 0.5 * np.sqrt(excess)), rel=1e-3)
    with pytest.raises(SimulationError, match=r"'contact'.* at t = 0\.05.*grazing") as raised:
        sensitivities(swing(1e-7), 0.3, ["speed"], rtol=1e-6, backend=backend)
    assert raised.value.elements == ("contact",)


@pytest.mark.parametrize("backend", BACKENDS)
def test_two_events_at_once_that_move_apart_have_no_derivative(backend):
    push, one, other = sympy.symbols("push one other", positive=True)
    a, b = One("a"), One("b")
    graph = assemble(
        "twins",
        Se("P", push * TIME) >> a >> (I("m1", 1), Friction("f1", kinetic=lambda s: one)),
        Se("Q", push * TIME) >> b >> (I("m2", 1), Friction("f2", kinetic=lambda s: other)),
        parameters={push: 1.0, one: 1.0, other: 1.0},
    )
    both = sensitivities(graph, 2.0, ["push"], backend=backend)
    assert both.events == pytest.approx(np.array([[-1.0], [-1.0]]))
    with pytest.raises(SimulationError, match="at once"):
        sensitivities(graph, 2.0, ["push", "one"], backend=backend)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_law_without_a_finite_slope_is_no_success(backend):
    body = One("body")
    width = sympy.Symbol("width", positive=True)
    graph = assemble(
        "root",
        body >> (I("m", 1), R("r", effort=lambda f: width * sympy.sqrt(sympy.Abs(f)))),
        Se("F", 1) >> body,
        parameters={width: 1.0},
    )
    with pytest.raises(SimulationError, match="finite"):
        sensitivities(graph, 1.0, ["width"], backend=backend)


def test_a_run_that_stops_early_has_its_sensitivities_up_to_there():
    found = sensitivities(mass_on_belt.graph(), 20.0, ["k"], max_events=5)
    assert found.trajectory.outcome.value == "event limit"
    assert found.x.shape[2] == len(found.trajectory.t) and np.isfinite(found.x).all()
    assert len(found.events) == 5
