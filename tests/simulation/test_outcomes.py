"""Whatever goes wrong ends in one named outcome, in its budget, in silence, with a last good point.

What is finite in time but not in size (y' = y^2) ends in `step underflow` on every solver; what
grows for ever in `diverged`; what the law itself cannot give in `non-finite`.
"""

from __future__ import annotations

import logging
import math
import time

import numpy as np
import pytest
import sympy
from click.testing import CliRunner

from bondgraph import (
    TIME,
    C,
    Diode,
    EndStop,
    Friction,
    I,
    Integrator,
    One,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    simulate,
)
from bondgraph.cli import main
from bondgraph.simulation.chatter import reverses
from bondgraph.simulation.native import compiler
from tests.simulation.stiff import rates

BUDGET = 20.0
EXPLICIT = [
    *([{"backend": "native"}] if compiler.find_compiler() else []),
    {"backend": "vm", "solver": "dopri5"},
]
WAYS = [*EXPLICIT, *({"solver": name} for name in ("cvodes", "idas", "rosenbrock"))]


def ended(capfd, graph, until, way, **options):
    """Run, and check all that holds for every outcome."""
    began = time.monotonic()
    settings = {"time_budget": BUDGET, **way, **options}
    run = simulate(graph, until, **settings)
    taken = time.monotonic() - began
    assert taken < settings["time_budget"] + 10  # derivation and compilation included
    assert not run.outcome.ok and run.advice.startswith(run.outcome.advice)
    assert 0 <= run.t_end <= until and math.isfinite(run.t_end)
    assert all(math.isfinite(value) for value in run.final.values())
    assert np.isfinite(run.x).all() and (np.diff(run.t) >= 0).all()
    assert capfd.readouterr() == ("", "")
    return run


@pytest.mark.parametrize("way", WAYS, ids=str)
class TestEveryWay:
    def test_a_blow_up_in_finite_time(self, capfd, way):
        run = ended(capfd, rates("square", lambda y: (y**2,), (1,)), 20.0, way)
        assert run.outcome.value == "step underflow"
        assert run.t_end == pytest.approx(1, abs=1e-5) and run.final["c0.q"] > 1e6

    def test_an_exponential_blow_up(self, capfd, way):
        """y' = exp(y) has the pole log(1 - t); the law overflows beside it."""
        run = ended(capfd, rates("exp", lambda y: (sympy.exp(y),), (0,)), 20.0, way)
        overflows = way.get("solver") == "rosenbrock"
        assert run.outcome.value == ("non-finite" if overflows else "step underflow")
        assert run.t_end == pytest.approx(1, abs=1e-5)

    def test_growth_for_ever(self, capfd, way):
        run = ended(capfd, rates("growth", lambda y: (50 * y,), (1,)), 20.0, way)
        assert run.outcome.value == "diverged"
        assert run.t_end == pytest.approx(2 * math.log(10), rel=1e-3)

    def test_a_root_of_a_negative_number(self, capfd, way):
        root = sympy.sqrt(sympy.Rational(1, 2) - TIME)
        run = ended(capfd, rates("root", lambda y: (root,), (0,)), 20.0, way)
        assert run.outcome.value == "non-finite"
        assert run.t_end == pytest.approx(0.5, abs=1e-6)
        assert run.final["c0.q"] == pytest.approx(math.sqrt(0.5) / 3, rel=1e-4)

    def test_nothing_at_the_start(self, capfd, way):
        run = ended(capfd, rates("log", lambda y: (sympy.log(-y),), (1,)), 20.0, way)
        assert run.outcome.value == "non-finite" and run.t_end == 0

    def test_an_overflow(self, capfd, way):
        """exp(exp(t)) overflows at t = log(709.78)."""
        law = sympy.exp(sympy.exp(TIME)) * sympy.Rational(1, 10**300)
        run = ended(capfd, rates("overflow", lambda y: (law - y,), (0,)), 20.0, way)
        assert run.outcome.value == "non-finite"
        assert run.t_end == pytest.approx(math.log(math.log(1.797e308)), abs=1e-4)

    def test_a_sign_that_chatters(self, capfd, way):
        graph = rates("bang", lambda y: (sympy.Rational(1, 10) - sympy.sign(y),), (0.5,))
        run = ended(capfd, graph, 2.0, way, max_steps=20_000, time_budget=10.0)
        assert run.outcome.value == "chattering" and "Friction" in run.advice
        assert run.t_end == pytest.approx(0.5 / 0.9, abs=2e-2)
        assert run.final["c0.q"] == pytest.approx(0, abs=1e-4)

    def test_a_step_limit(self, capfd, way):
        graph = rates("swing", lambda x, v: (v, -x), (1, 0))
        run = ended(capfd, graph, 1e4, way, max_steps=150)
        assert run.outcome.value == "step limit" and run.steps <= 150
        # what has been reached is right: on the circle
        assert math.hypot(*run.x_end) == pytest.approx(1, abs=1e-3)

    @pytest.mark.parametrize("budget", [0.0, 0.4])
    def test_a_time_budget(self, capfd, way, budget):
        graph = rates("swing", lambda x, v: (v, -x), (1, 0))
        began = time.monotonic()
        run = ended(capfd, graph, 1e9, way, time_budget=budget, t_eval=[0.0, 1e9])
        assert run.outcome.value == "time budget"
        assert time.monotonic() - began < budget + 5
        assert math.hypot(*run.x_end) == pytest.approx(1, abs=0.1)


def test_a_fast_fall_is_no_chatter():
    assert not reverses(lambda t, x: -1e12 * x, 0.0, np.array([1e-12]), 1.0)
    assert not reverses(lambda t, x: np.array([1.0 + np.sign(x[0])]), 0.0, np.array([-1e-9]), 1.0)


@pytest.mark.parametrize("way", EXPLICIT, ids=str)
class TestEvents:
    def belt(self, kinetic):
        belt, body = Zero("belt"), One("body")
        return assemble(
            "belt",
            Sf("drive", 0.5) >> belt >> body >> (I("mass", 1), C("spring", stiffness=100)),
            belt >> Friction("contact", kinetic=lambda slip: kinetic, breakaway=10),
        )

    def test_a_storm_of_events(self, capfd, way):
        run = ended(capfd, self.belt(8), 1e6, way, max_events=25, rtol=1e-4)
        assert run.outcome.value == "event limit" and len(run.events) == 25

    def test_friction_that_contradicts_itself(self, capfd, way):
        run = ended(capfd, self.belt(12), 50.0, way)
        assert run.outcome.value == "chattering"


SEARCHED = {
    "step underflow": (lambda y: y**2, {}),
    "diverged": (lambda y: 50 * y, {}),
    "non-finite": (lambda y: sympy.sqrt(sympy.Rational(1, 2) - TIME), {}),
    "step limit": (lambda y: sympy.cos(50 * TIME), {"max_steps": 40}),
    "time budget": (lambda y: sympy.cos(10**6 * TIME), {"time_budget": 0.3}),
}


@pytest.mark.parametrize("outcome", SEARCHED)
def test_models_whose_modes_are_searched(capfd, outcome):
    law, options = SEARCHED[outcome]
    state, idle = C("c", 1, initial=1), One("idle")
    graph = assemble(
        "searched",
        Sf("f", law(state.q)) >> Zero("z") >> state,
        Se("back", -1) >> idle >> (R("r", 1), Diode("d")),
        outputs={"c0.q": state.q},
    )
    run = ended(capfd, graph, 20.0, {}, **options)
    assert run.model.switched and run.outcome.value == outcome


def test_bounces_that_pile_up(capfd):
    """Dropped from 1 m, halved at each bounce, a ball rests after 3 falls' time."""
    v = One("v")
    height = Integrator("h", -v.f, initial=1)
    floor = EndStop("floor", gap=height.y, restitution=0.5)
    graph = assemble("ball", Se("weight", 20) >> v >> (I("m", 2), floor), height)
    run = ended(capfd, graph, 5.0, {})
    assert run.outcome.value == "zeno"
    assert run.t_end == pytest.approx(3 * math.sqrt(0.2), rel=1e-2)


class TestUndefinedOutputs:
    """States may be good where an output is not."""

    def graph(self):
        fall = C("fall", 1, initial=1)
        flow = Sf("f", -1) >> Zero("z") >> fall
        return assemble("fall", flow, outputs={"root": sympy.sqrt(fall.q), "q": fall.q})

    @pytest.mark.parametrize("way", WAYS, ids=str)
    def test_they_are_named_with_their_time(self, capfd, way):
        run = simulate(self.graph(), 2.0, t_eval=np.linspace(0, 2, 21), **way)
        assert run.outcome.ok
        assert list(run.undefined) == ["root"]
        assert run.undefined["root"] == pytest.approx(1.1)
        assert math.isnan(run.final["root"])
        assert capfd.readouterr() == ("", "")
        assert simulate(self.graph(), 0.9, **way).undefined == {}

    def test_files_have_gaps_and_a_warning(self, tmp_path, caplog):
        run = simulate(self.graph(), 2.0, t_eval=[0.0, 2.0])
        with caplog.at_level(logging.WARNING):
            lines = run.save(tmp_path / "run.csv").read_text().splitlines()
        assert "root is not finite at t = 2 s" in caplog.text
        assert lines[1].startswith("time [s],root,q") and lines[-1].startswith("2.0,,-")

    def test_the_command_line_is_no_success(self, tmp_path):
        model = tmp_path / "fall.py"
        model.write_text(
            "import sympy\nfrom bondgraph import C, Sf, Zero, assemble\n"
            "c = C('fall', 1, initial=1)\n"
            "m = assemble('fall', Sf('f', -1) >> Zero('z') >> c, outputs={'root': sympy.sqrt(c.q)})\n"
        )
        words = ["simulate", f"{model}:m", "--until", "2", "--json"]
        done = CliRunner().invoke(main, words)
        assert done.exit_code == 1 and "root is not finite" in done.stderr
        assert '"root": null' in done.stdout and "NaN" not in done.stdout
        assert CliRunner().invoke(main, [*words[:3], "0.5", "--json"]).exit_code == 0
