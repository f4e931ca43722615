"""Batches: many runs whose ends alone are asked for are those that `simulate` gives."""

import math
import threading

import numpy
import pytest

from bondgraph import CompiledModel, EndStop, I, Integrator, One, R, Se, assemble, simulate
from bondgraph.errors import ParameterError, SimulationError
from bondgraph.models import bicycle_brake, mass_on_belt, quarter_car
from bondgraph.simulation.batch import run_many
from bondgraph.simulation.outcome import Outcome

BRAKE = {"mu_s": 0.5, "tau": 0.02}
POINTS = {"V0": [0.9, 0.6, 1.3, 0.75], "F_k": [900.0, 400.0, 1100.0, 650.0]}


@pytest.fixture(scope="module")
def brake():
    return CompiledModel(bicycle_brake.graph())


def assert_same(ends, row, run):
    """One row of a batch against one run, to the bit."""
    assert ends.outcomes[row] is run.outcome
    assert ends.t_end[row] == run.t_end
    assert (ends.x[row] == numpy.append(run.x_end, run.z_end)).all()
    assert (ends.codes[row] == run.codes_end).all()
    audit = ends.supplied[row], ends.stored[row], ends.dissipated[row]
    assert audit == (run.energy.supplied, run.energy.stored, run.energy.dissipated)
    assert ends.steps[row] == run.steps
    for j, name in enumerate(run.model.contact_names):
        modes = run.model.equations.graph[name].modes
        for label, code in modes.items():
            entered = [e for e in run.events if (e.element, e.to_mode) == (name, label)]
            assert ends.entered[row, j, code % 3] == len(entered)


class TestSameAsSimulate:
    @pytest.mark.parametrize("backend", ["auto", "vm"])
    def test_brake(self, brake, backend):
        ends = run_many(brake, (0, 0.02), POINTS, BRAKE, backend=backend)
        for row in range(4):
            own = {name: column[row] for name, column in POINTS.items()}
            run = simulate(brake, 0.02, BRAKE | own, t_eval=[], backend="auto")
            assert_same(ends, row, run)
            final = ends.signals(("V_c", "omega_r", "friction.e"))[:, row]
            assert final[0] == pytest.approx(run.final["V_c"], rel=1e-14)
            assert final[1] == pytest.approx(run.final["omega_r"], rel=1e-14)
        assert ends.entered[:, 0, 0].any()

    def test_other_points_do_not_matter(self, brake):
        whole = run_many(brake, (0, 0.05), POINTS, BRAKE)
        for row in range(4):
            own = {name: column[row : row + 1] for name, column in POINTS.items()}
            alone = run_many(brake, (0, 0.05), own, BRAKE)
            assert (alone.x[0] == whole.x[row]).all()
            assert (alone.entered[0] == whole.entered[row]).all()
            assert (
                whole.signals(("V_c", "friction.e"))[:, row]
                == alone.signals(("V_c", "friction.e")).T
            ).all()

    def test_threads(self, brake):
        points = {"V0": numpy.linspace(0.5, 1.5, 40)}
        whole = run_many(brake, (0, 0.05), points, BRAKE)
        found = {}

        def work(part):
            found[part] = run_many(brake, (0, 0.05), {"V0": points["V0"][part::4]}, BRAKE)

        workers = [threading.Thread(target=work, args=(part,)) for part in range(4)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        for part, ends in found.items():
            assert (ends.x == whole.x[part::4]).all()

    def test_initial_states_and_inputs(self):
        model = CompiledModel(quarter_car.graph())
        state = model.equations.states[0].name
        points = {state: [0.0, 0.1, -0.2], "v_road": [0.3, 0.0, -0.1]}
        ends = run_many(model, (0, 0.5), points)
        for row in range(3):
            initial, inputs = {state: points[state][row]}, {"v_road": points["v_road"][row]}
            run = simulate(model, 0.5, initial=initial, inputs=inputs, t_eval=[])
            assert_same(ends, row, run)
        assert ends.signals(("v_road",))[0].tolist() == points["v_road"]

    def test_inputs_over_time_are_shared(self):
        model = CompiledModel(quarter_car.graph())
        road = ([0, 0.1, 0.2, 0.5], [0.0, 0.3, -0.2, 0.0])
        name = model.equations.parameters[0].name
        base = model.resolver()[name]
        ends = run_many(model, (0, 0.5), {name: [base, 2 * base]}, inputs={"v_road": road})
        for row, value in enumerate([base, 2 * base]):
            run = simulate(model, 0.5, {name: value}, inputs={"v_road": road}, t_eval=[])
            assert_same(ends, row, run)

    def test_models_that_search_their_modes(self):
        v = One("v")
        h = Integrator("h", -v.f, initial=1.0)
        floor = EndStop("floor", gap=h.y, restitution=0.7)
        ball = assemble("ball", Se("weight", 9.81) >> v >> (I("m", 1), floor), h)
        model = CompiledModel(ball)
        ends = run_many(model, (0, 1), {"h.y": [1.0, 0.3]})
        for row, height in enumerate([1.0, 0.3]):
            assert_same(ends, row, simulate(model, 1, initial={"h.y": height}, t_eval=[]))
        assert ends.entered[1].any()

    def test_implicit_solvers(self):
        loop = One("loop") >> (Se("supply", 2), I("coil", 1), R("load", effort=lambda f: f + f**3))
        model = CompiledModel(assemble("coil", loop))
        ends = run_many(model, (0, 1), {"coil.p": [0.0, 0.5]}, solver="rosenbrock")
        for row, start in enumerate([0.0, 0.5]):
            run = simulate(model, 1, initial={"coil.p": start}, solver="rosenbrock", t_eval=[])
            assert_same(ends, row, run)


class TestPointsThatFail:
    def test_a_value_that_is_not_admissible(self, brake):
        ends = run_many(brake, (0, 0.01), {"V0": [0.9, 0.9, 0.8], "k_f": [1e5, -1.0, 1e5]}, BRAKE)
        assert [outcome and outcome.value for outcome in ends.outcomes] == [
            "finished",
            None,
            "finished",
        ]
        assert "'k_f' is -1; it must be positive" in ends.refusals[1]
        assert numpy.isnan(ends.x[1]).all() and math.isnan(ends.t_end[1])
        assert numpy.isnan(ends.signals(("V_c",))[0]).tolist() == [False, True, False]

    def test_all_refused(self, brake):
        ends = run_many(brake, (0, 0.01), {"k_f": [-1.0, math.nan]}, BRAKE)
        assert ends.outcomes == (None, None) and set(ends.refusals) == {0, 1}

    def test_an_outcome_of_one_point_stays_its_own(self):
        model = CompiledModel(mass_on_belt.graph())
        ends = run_many(model, (0, 20), {"k": [1.0, 100.0]}, max_events=5)
        assert ends.outcomes[1] is Outcome.EVENT_LIMIT
        assert_same(ends, 1, simulate(model, 20, {"k": 100.0}, max_events=5, t_eval=[]))

    def test_the_time_budget_is_that_of_each_run(self, brake):
        ends = run_many(brake, (0, 1000), {"V0": [0.9, 0.8]}, BRAKE, time_budget=0.1)
        assert ends.outcomes == (Outcome.TIME_BUDGET,) * 2
        assert ((ends.t_end > 0) & (ends.t_end < 1000)).all() and numpy.isfinite(ends.x).all()


class TestRefused:
    def test_unknown_names(self, brake):
        with pytest.raises(ParameterError, match="'V_0' is not known; did you mean V0"):
            run_many(brake, (0, 1), {"V_0": [1.0]})

    @pytest.mark.parametrize(
        "points", [{}, {"V0": [1.0], "F_k": [1.0, 2.0]}, {"V0": [[1.0]]}, {"V0": 1.0}], ids=str
    )
    def test_columns_that_do_not_fit(self, brake, points):
        with pytest.raises(SimulationError, match=r"one row|a value of every name"):
            run_many(brake, (0, 1), points)

    def test_stop(self, brake):
        asked = []

        def stop():
            asked.append(1)
            return len(asked) == 3

        with pytest.raises(KeyboardInterrupt):
            run_many(brake, (0, 1000), {"V0": [0.9, 0.8]}, BRAKE, stop=stop)
        assert len(asked) == 3
