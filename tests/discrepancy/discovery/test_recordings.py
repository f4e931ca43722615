"""The simulators against closed forms, published numbers and, with the truth grafted, the engine."""

import numpy as np
import pytest

from bondgraph import simulate
from bondgraph.discrepancy.grafting import graft
from bondgraph.discrepancy.measurement import gaps, matched, outliers, quantisation, sampling
from bondgraph.models import bicycle_brake

from .recordings import (
    brake,
    car,
    drives,
    drops,
    drum,
    duffing,
    messy,
    pendulum,
    shaker,
    stage,
    tanks,
)

SHORT = {
    "stage": (stage, {"samples": 3000}),
    "duffing": (duffing, {"samples": 4000}),
    "tanks": (tanks, {"samples": 200}),
    "drives": (drives, {"samples": 200}),
    "shaker": (shaker, {"samples": 512}),
    "brake": (brake, {"span": 0.03}),
    "drum": (drum, {"samples": 800}),
    "car": (car, {"samples": 400}),
}


@pytest.mark.parametrize("name", SHORT)
def test_repeatable_and_known_to_its_graph(name):
    machine, options = SHORT[name]
    graph = machine.graph()
    train, held_out = machine.simulate(3, **options)
    again, _ = machine.simulate(3, **options)
    assert all((train[0].columns[k] == again[0].columns[k]).all() for k in train[0].columns)
    for run in (*train, *held_out):
        found = matched(run, graph)
        assert found.outputs and not (found.warnings or found.missing or found.unknown)
        assert sampling(run).uniform
    own = train[0].columns
    other = held_out[0].columns
    assert any(not np.array_equal(own[k][:100], other[k][:100]) for k in own)


def left(graph, run, parameters=None, initial=None, rtol=1e-7):
    """RMS of what a graph leaves of a recording's outputs, over their deviation."""
    found = matched(run, graph)
    end = simulate(
        graph,
        (run.t[0], run.t[-1]),
        parameters or {},
        inputs=found.inputs,
        initial={**found.initial, **(initial or {})},
        t_eval=run.t,
        rtol=rtol,
    )
    assert end.outcome.ok
    return {
        name: float(np.sqrt(np.nanmean((end[name] - values) ** 2)) / np.nanstd(values))
        for name, values in found.outputs.items()
    }


class TestStage:
    def test_speed_decays_as_friction_says(self):
        """Below no force: m v' = -b v - F, without the Stribeck part that speed has left behind."""
        v, step = 0.2, 1e-4
        for _ in range(100):
            v = stage.stepped(v, 0.0, step)
        rate = stage.VISCOUS / stage.MASS
        rest = stage.FORWARD / stage.VISCOUS
        assert v == pytest.approx((0.2 + rest) * np.exp(-rate * 0.01) - rest, rel=1e-6)

    @pytest.mark.parametrize(("force", "moves"), [(6.0, 0), (6.2, 1), (-5.0, 0), (-5.2, -1)])
    def test_breaks_loose_beyond_either_level(self, force, moves):
        assert np.sign(stage.stepped(0.0, force, 1e-4)) == moves

    def test_encoder_and_closed_loop(self):
        (run,), _ = stage.simulate(0, samples=5000)
        assert quantisation(run, "x") == pytest.approx(stage.RESOLUTION)
        assert np.abs(run.columns["x"]).max() < 0.1

    def test_truth_grafted(self):
        """Position integrates all errors; the speed is what tells whether the effects are right."""
        (run,), _ = stage.simulate(1, "v", samples=4000)
        graph = stage.graph("v")
        truth = stage.EXPECTED.parameters
        level = truth["coulomb_friction.level"]
        rubbing = graft(graph, "coulomb_friction", "carriage", parameters={"level": level})
        effort = truth["effort_bias.effort"]
        grown = graft(rubbing.graph, "effort_bias", "carriage", parameters={"effort": effort})
        values = stage.EXPECTED.truth
        without = left(graph, run, values)["v"]
        assert left(grown.graph, run, values)["v"] < 0.05 * without


class TestDuffing:
    def test_energy_without_loss(self, monkeypatch):
        """Kicked and left alone; the period of the undamped oscillator is a complete integral."""
        monkeypatch.setattr(duffing, "DAMPING", 0.0)
        kick = np.zeros(2000 * duffing.FINE)
        kick[1:40] = 8000.0
        y = duffing.run(kick)[20:]
        top = np.abs(y).max()
        crossings = np.flatnonzero((y[:-1] < 0) & (y[1:] >= 0))
        at = crossings - y[crossings] / (y[crossings + 1] - y[crossings])
        period = (at[-1] - at[0]) / (len(at) - 1) / duffing.RATE
        angle = (np.arange(4000) + 0.5) * np.pi / 8000
        k, c = duffing.STIFFNESS, duffing.CUBIC
        speed = np.sqrt((k + c * top**2 / 2 * (1 + np.sin(angle) ** 2)) / duffing.MASS)
        assert period == pytest.approx(4 * np.mean(1 / speed) * np.pi / 2, rel=1e-3)
        assert np.abs(y[-500:]).max() == pytest.approx(top, rel=5e-3)  # top is seen at samples only

    def test_truth_grafted(self):
        (run,), _ = duffing.simulate(0, samples=4000)
        cubic = {"cubic": duffing.CUBIC}
        grown = graft(duffing.graph(), "cubic_stiffness", "velocity", parameters=cubic)
        assert left(grown.graph, run, duffing.EXPECTED.truth)["y"] == pytest.approx(0.005, rel=0.1)
        assert left(duffing.graph(), run, duffing.EXPECTED.truth)["y"] > 0.03


class TestTanks:
    def test_rest(self):
        """Torricelli: pump = hole sqrt(2 g h) in both."""
        upper, lower = tanks.run(np.full(600, 4.0), (0.1, 0.1), True)
        for level, hole in zip((upper, lower), tanks.HOLE, strict=True):
            assert level[-1] == pytest.approx((4 * tanks.PUMP / hole) ** 2 / (2 * 9.81), rel=1e-6)

    def test_brim_and_top(self):
        (run,), _ = tanks.simulate(0)
        assert run.columns["level"].max() == tanks.TOP
        assert 0.02 < np.mean(run.columns["level"] == tanks.TOP) < 0.3
        volts = run.columns["volts"]
        assert tanks.run(volts, (0.1, 0.1), True)[0].max() > tanks.BRIM + 1e-3

    def test_truth_grafted(self):
        (run,), _ = tanks.simulate(0, samples=500, noise=0.0)
        truth = tanks.EXPECTED.parameters
        graph = tanks.graph()
        for i, name in enumerate(("upper", "lower")):
            drag = {"drag": truth[f"quadratic_drag.drag.{i}"]}
            graph = graft(graph, "quadratic_drag", f"{name}_hole", parameters=drag).graph
        brim = {key: truth[f"overflow.{key}"] for key in ("conductance", "threshold")}
        graph = graft(graph, "overflow", "upper", parameters=brim).graph
        top = {"limit": truth["saturation.limit"]}
        graph = graft(graph, "saturation", "output level", parameters=top).graph
        rng = np.random.default_rng(0)
        levels = rng.uniform(0.05, 0.2), rng.uniform(0.05, 0.15)
        own = {"R1": 1.0, "R2": 1.0}
        start = {
            f"{name}_tank.q": level * area
            for name, level, area in zip(("upper", "lower"), levels, tanks.AREA, strict=True)
        }
        own |= tanks.EXPECTED.truth
        assert left(graph, run, own, start)["level"] < 2e-3


class TestDrives:
    @pytest.mark.parametrize("kind", drives.KINDS)
    def test_rest(self, kind):
        """Both wheels turn as fast, and the motor holds both drags."""
        w1, w2 = drives.run(np.full(3000, 1.0), kind)
        assert w1[-1] == pytest.approx(drives.GAIN / sum(drives.DRAG), rel=1e-3)
        assert w2[-1] == pytest.approx(w1[-1], rel=1e-3)

    @pytest.mark.parametrize("kind", ["stiffening", "backlash"])
    def test_truth_grafted(self, kind):
        (run,), _ = drives.simulate(0, kind, noise=0.01)
        beyond = {"stiffness": drives.STIFFER, "width": drives.SLACK}
        grown = graft(drives.graph(), "dead_zone", "stretch", parameters=beyond)
        own = {**drives.EXPECTED.truth, **({"k": 1e-9} if kind == "backlash" else {})}
        assert max(left(grown.graph, run, own).values()) < 0.012
        assert min(left(drives.graph(), run, drives.EXPECTED.truth).values()) > 0.2

    def test_hysteresis_keeps_what_it_held(self):
        """One slow cycle to 1 rad and back to zero leaves every slider at its limit."""
        way = np.concatenate([np.linspace(0, 1, 500), np.linspace(1, 0, 500)])
        cells = [0.0] * len(drives.CELLS)
        for step in np.diff(way):
            cells = [
                max(-limit, min(limit, held + step))
                for held, (_, limit) in zip(cells, drives.CELLS, strict=True)
            ]
        limits = sum(stiffness * limit for stiffness, limit in drives.CELLS)
        assert drives.torque("hysteresis", 0.0, cells) == pytest.approx(-limits)


class TestShaker:
    def test_small_loops_are_elastic(self):
        """So little force that nothing yields: the static answer is F / (k + slope)."""
        slow = 1e-4 * np.sin(2 * np.pi * np.arange(8192 * 16) / (8192 * 16))
        y = shaker.run(slow)
        assert np.abs(y).max() == pytest.approx(1e-4 / (shaker.STIFFNESS + shaker.SLOPE), rel=1e-3)

    def test_yield_wastes_energy(self):
        t = np.arange(8192 * 16) / (750 * 16)
        force = 150 * np.sin(2 * np.pi * t * 750 / 8192 * 20)
        y = shaker.run(force)
        assert -np.trapezoid(y, force[::16]) > 0

    def test_reaches_yield(self):
        (run, _), _ = shaker.simulate(0)
        assert np.abs(run.columns["y"]).max() > 2 / shaker.LOOP


class TestBrake:
    def test_published_sticks(self):
        """The automaton against the numbers of docs/brake.md."""
        times = np.linspace(0, 0.5, 1001)
        signals, sticks = brake.run(brake.FIGURES["Fig. 8"], times)
        assert len(sticks) == 72
        assert sticks[:3] == pytest.approx([1.58460798e-3, 7.44285947e-3, 13.51151160e-3], rel=1e-6)
        assert np.isfinite(signals["x_c"]).all()

    def test_damped_figure_against_the_engine(self):
        """Fig. 6 never sticks, and both solvers follow the same curve."""
        times = np.linspace(0, 0.1, 2001)
        signals, sticks = brake.run(brake.FIGURES["Fig. 6"], times)
        settings = vars(brake.FIGURES["Fig. 6"])
        run = simulate(bicycle_brake.graph(), 0.1, settings, t_eval=times, rtol=1e-10)
        assert not sticks and signals["slip"].min() > 0.2
        assert signals["slip"] == pytest.approx(run["slip"], abs=1e-7)
        assert signals["x_c"] == pytest.approx(run["x_c"], abs=1e-9)

    def test_truth_grafted(self):
        (run,), _ = brake.simulate(0, span=0.04)
        truth = brake.EXPECTED.parameters
        coupling = {key: truth[f"compliant_coupling.{key}"] for key in ("stiffness", "damping")}
        coupled = graft(brake.graph(), "compliant_coupling", "bond road>hub", parameters=coupling)
        inertia = {"inertance": truth["added_inertia.inertance"]}
        grown = graft(coupled.graph, "added_inertia", "hub", parameters=inertia)
        start = {"added_inertia.p": inertia["inertance"] * brake.SPEED / brake.RADIUS}
        after = left(grown.graph, run, None, start)
        before = left(brake.graph(), run)
        assert max(after.values()) < 0.01 and min(before.values()) > 0.3

    def test_caliper_alone_does_not_see_the_wheel(self):
        (run,), _ = brake.simulate(0, "Fig. 6", ("x_c",))
        assert left(brake.graph("Fig. 6"), run)["x_c"] == pytest.approx(0.005, rel=0.1)


class TestDrum:
    def test_heat_balance(self):
        """What the drum loses by rubbing is in the lining or in the air."""
        rng = np.random.default_rng(0)
        drive, _, w, warm = drum.run(4000, rng, (0.5, 3.0))
        made = np.sum(drive * w - drum.DRAG * w**2) * drum.INTERVAL
        made -= drum.INERTIA * (w[-1] ** 2 - w[0] ** 2) / 2
        held = drum.HEAT * warm[-1] + drum.COOLING * warm.sum() * drum.INTERVAL
        assert held == pytest.approx(made, rel=0.02)
        assert 100 < warm.max() < 300 and w.min() > 5

    def test_truth_grafted(self):
        """A straight line against an exponential: the fade is most of it, not all."""
        (run,), _ = drum.simulate(0)
        truth = drum.EXPECTED.parameters
        fade = {key: truth[f"thermal_fade.{key}"] for key in ("fade", "cooling")}
        grown = graft(drum.graph(), "thermal_fade", "dissipator lining", parameters=fade)
        own = drum.EXPECTED.truth
        without = left(drum.graph(), run, own)["speed"]
        assert left(grown.graph, run, own)["speed"] < 0.5 * without


def test_quarter_car_has_nothing_missing():
    """Exact linear solution against the engine, to the noise."""
    (run, _), _ = car.simulate(0)
    assert left(car.graph(), run, car.EXPECTED.truth) == pytest.approx(
        {"v_body": 0.02, "suspension": 0.02}, rel=0.06
    )


class TestRealThings:
    def test_swings(self):
        for split in pendulum.SPLITS:
            train, held_out = pendulum.recordings(split)
            assert sorted(len(run) for run in (*train, *held_out)) == [1834] * 6
            assert all(np.abs(run.columns["theta"]).max() < 1.7 for run in train)
        assert not matched(train[0], pendulum.graph()).warnings

    @pytest.mark.parametrize("ball", [*drops.HEAVY, *drops.MIDDLE, *drops.LIGHT])
    def test_falls(self, ball):
        (train,), (held_out,) = drops.recordings(ball)
        assert not matched(train, drops.graph()).warnings
        assert train.start > 0.33 and held_out.name.endswith("2")
        assert train.columns["height"][0] - train.columns["height"][-1] > 30


@pytest.fixture(scope="module")
def run():
    return drives.simulate(0)[0][0]


class TestMessy:
    def test_gaps(self, run):
        holed = messy.gaps(run, ["w1"], 0)
        assert 0.02 < np.mean(~holed.present("w1")) < 0.1 and gaps(holed, "w1")
        assert holed.present("w2").all()

    def test_outliers(self, run):
        struck = messy.outliers(run, ["w2"], 1, share=0.01, size=20)
        wrong = struck.columns["w2"] != run.columns["w2"]
        assert 0 < wrong.sum() < 15
        assert outliers(struck, "w2")[wrong].mean() > 0.6

    def test_unequal(self, run):
        odd = messy.unequal(run, 0)
        assert not sampling(odd).uniform and 300 < len(odd) < 400
        assert (odd.t[0], odd.t[-1]) == (run.t[0], run.t[-1])

    def test_clipped(self, run):
        cut = messy.clipped(run, "w1", 0.5)
        assert np.abs(cut.columns["w1"]).max() == 0.5 * np.abs(run.columns["w1"]).max()

    def test_unitless_late_and_silent(self, run):
        bare = messy.unitless(run, "volts")
        assert "volts" not in bare.units and matched(bare, drives.graph()).inputs
        delayed = messy.late(run, "w1", 0.04)
        assert np.allclose(delayed.columns["w1"][2:], run.columns["w1"][:-2])
        assert "w1" not in messy.silent(run, "w1").columns
