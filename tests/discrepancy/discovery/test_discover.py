"""The whole chain on small machines: verdicts, options, errors, and what is left alone."""

import numpy
import pytest
import sympy

from bondgraph import C, I, One, R, Se, Zero, assemble, derive, simulate
from bondgraph.discrepancy import Measurement, discover, graft
from bondgraph.discrepancy.candidates import FLOW, Coefficient, Effect, Feature, resistor
from bondgraph.errors import (
    BondGraphError,
    LawError,
    MeasurementError,
    ParameterError,
    SimulationError,
)
from bondgraph.files import dumps

from .made import lacking, push, recorded

NOMINAL = lacking()
FEW = ("viscous_damping", "quadratic_drag", "linear_stiffness", "cubic_stiffness", "effort_bias")
DRAGGED = lacking("quadratic_drag", values={"drag": 15.0})


def found(graph, *, effects=FEW, seeds=(0, 1), **options):
    columns = options.pop("columns", ("x", "v"))
    runs = [recorded(graph, seed, columns=columns, count=241, span=3.0) for seed in seeds]
    return discover(NOMINAL, runs[:-1], runs[-1], effects=effects, **options)


@pytest.fixture(scope="module")
def drag():
    return found(DRAGGED)


def test_drag_is_named_and_measured(drag):
    assert drag.verdict == "named"
    (effect,) = drag.effects
    assert (effect.name, effect.site) == ("quadratic_drag", "carriage")
    estimate = effect.parameters["drag"]
    assert abs(estimate.value - 15) < max(4 * estimate.std, 0.1) and estimate.std < 1.5
    truth = {"m": 2.0, "k": 800.0, "b": 4.0}
    for name, own in drag.parameters.items():
        assert abs(own.value - truth[name]) < 5 * own.std


def test_the_held_out_gap_comes_down_to_the_noise(drag):
    for gap in drag.gap["validation"].values():
        assert gap.before > 2 * gap.noise_floor
        assert gap.after < 1.2 * gap.noise_floor
        assert gap.nominal >= 0.9 * gap.before


def test_the_improved_graph_runs_as_the_machine_does(drag):
    t = numpy.linspace(0, 3, 61)
    inputs = {"push": (t, push(t, 5))}
    truth = simulate(DRAGGED, 3, inputs=inputs, t_eval=t)
    better = simulate(drag.improved, 3, inputs=inputs, t_eval=t)
    worse = simulate(NOMINAL, 3, inputs=inputs, t_eval=t)
    off, before = (numpy.abs(run["v"] - truth["v"]).max() for run in (better, worse))
    assert off < 0.1 * before


def test_courses_and_law_are_those_of_the_recordings(drag):
    (course,) = drag.train
    assert course.name == "run 0" and set(course.after) == {"x", "v"}
    assert numpy.array_equal(course.measured["x"], drag.recordings[0].columns["x"])
    (law,) = drag.laws
    drag_of = drag.effects[0].parameters["drag"].value
    assert numpy.allclose(law.y, drag_of * law.x * numpy.abs(law.x))


def test_ranked_ends_with_the_model_by_itself(drag):
    assert drag.ranked[0].label == "quadratic_drag at carriage"
    assert any(item.label == "nothing missing" for item in drag.ranked)
    assert drag.ranked[0].delta_bic == max(item.delta_bic for item in drag.ranked)
    assert drag.diff and all(line.startswith(("+", "~", "-")) for line in drag.diff)


def test_the_graph_is_left_as_it_was_and_the_answer_is_the_same_twice(drag):
    before = dumps(NOMINAL)
    again = found(DRAGGED)
    assert dumps(NOMINAL) == before
    assert again.words == drag.words and again.verdict == drag.verdict
    assert again.effects[0].parameters == drag.effects[0].parameters
    assert {k: v.value for k, v in again.parameters.items()} == {
        k: v.value for k, v in drag.parameters.items()
    }


def test_the_order_of_recordings_matters_little():
    runs = [recorded(DRAGGED, seed, count=241, span=3.0) for seed in (0, 2, 1)]
    one = discover(NOMINAL, runs[:2], runs[2], effects=FEW)
    two = discover(NOMINAL, runs[1::-1], runs[2], effects=FEW)
    assert [e.label for e in one.effects] == [e.label for e in two.effects]
    values = [d.effects[0].parameters["drag"].value for d in (one, two)]
    assert values[0] == pytest.approx(values[1], rel=0.01)


def test_recordings_of_one_name_are_told_apart():
    """Two that begin at different states, neither of them named."""
    t = numpy.linspace(0, 3, 241)
    rng = numpy.random.default_rng(8)
    runs = []
    for seed, start in ((0, 0.03), (2, -0.03), (1, 0.0)):
        inputs = {"push": (t, push(t, seed))}
        run = simulate(DRAGGED, 3, initial={"spring.q": start}, inputs=inputs, t_eval=t)
        columns = {n: run[n] + 0.01 * run[n].std() * rng.normal(size=241) for n in ("x", "v")}
        runs.append(Measurement(t, {"push": inputs["push"][1], **columns}))
    told = discover(NOMINAL, runs[:2], runs[2], effects=FEW)
    assert [effect.label for effect in told.effects] == ["quadratic_drag at carriage"]
    assert len({course.name for course in told.train}) == 2
    assert all(gap.after < 1.3 * gap.noise_floor for gap in told.gap["train"].values())


def test_a_complete_model_lacks_nothing():
    none = found(lacking(), effects=None)
    assert none.verdict == "none" and not none.effects and none.improved is None
    assert "lacks" in none.words[0] and not none.diff


def test_a_wrong_number_is_fitted_and_no_effect():
    run = [
        recorded(lacking(), seed, count=241, span=3.0, parameters={"k": 1000.0}) for seed in (0, 1)
    ]
    none = discover(NOMINAL, *run, effects=FEW)
    assert none.verdict == "none"
    assert none.parameters["k"].value == pytest.approx(1000, rel=0.01)
    assert none.nominal["k"] == 800


def test_what_one_signal_cannot_tell_is_ambiguous():
    """An offset of the only sensor, or a force that nothing measures: the same."""
    biased = lacking("sensor_bias", "output x", {"offset": 5e-3})
    both = found(biased, columns=("x",), effects=("sensor_bias", "effort_bias", "quadratic_drag"))
    assert both.verdict == "ambiguous"
    assert {effect.label for effect in both.effects} == {
        "sensor_bias at output x",
        "effort_bias at carriage",
    }
    assert both.advice and len(both.advice) <= 4


def test_what_no_effect_explains_is_not_named():
    """Friction, where only springs and offsets are known."""
    rubbed = lacking("coulomb_friction", values={"level": 4.0})
    left = found(rubbed, effects=("cubic_stiffness", "effort_bias"))
    assert left.verdict == "unnamed" and left.improved is None
    assert "none of the known effects" in left.words[0]


def test_an_own_effect_is_found():
    b = Coefficient("b", "{e}/({f})^3", "cubic damping", lambda s: s.effort / s.flow**3, 0.0, True)
    cubic = Effect(
        "cubic_damping",
        ("1-junction",),
        (b,),
        {"effort": b.symbol * FLOW**3},
        resistor,
        "damping that grows with the cube of the flow",
        "none",
        features=(Feature("f^3", lambda s: s.flow**3),),
    )
    machine = graft(NOMINAL, cubic, "carriage", parameters={"b": 40.0}).graph
    own = found(machine, effects=("viscous_damping", cubic))
    assert [effect.label for effect in own.effects] == ["cubic_damping at carriage"]
    assert own.effects[0].parameters["b"].value == pytest.approx(40, rel=0.1)


def test_only_what_is_free_is_fitted():
    fixed = found(DRAGGED, free=["b"])
    assert set(fixed.parameters) == {"b"} and fixed.verdict == "named"
    nothing = found(DRAGGED, free=[])
    assert not nothing.parameters and nothing.verdict == "named"


def test_given_values_count_instead_of_the_table():
    run = [recorded(DRAGGED, seed, count=241, span=3.0, parameters={"m": 3.0}) for seed in (0, 1)]
    told = discover(NOMINAL, *run, effects=FEW, free=["k", "b"], parameters={"m": 3.0})
    assert told.verdict == "named" and told.nominal == {"k": 800.0, "b": 4.0}
    assert told.effects[0].parameters["drag"].value == pytest.approx(15, rel=0.1)


def test_one_recording_is_split_and_progress_is_told():
    lines = []
    run = recorded(DRAGGED, count=401)
    told = discover(NOMINAL, run, effects=FEW, progress=lines.append)
    assert told.verdict == "named" and len(lines) > 2
    assert any("held out" in line for line in told.warnings)
    assert told.train[0].t[-1] <= told.validation[0].t[0]


@pytest.mark.parametrize(
    ("change", "error", "word"),
    [
        ({"measurements": []}, MeasurementError, "no measurement"),
        ({"free": ["kk"]}, ParameterError, "kk"),
        ({"parameters": {"mm": 1.0}}, BondGraphError, "mm"),
        ({"parameters": {"m": numpy.nan}}, ParameterError, "finite"),
        ({"effects": ["coulomb_frictoin"]}, LawError, "coulomb_friction"),
        ({"effects": []}, LawError, "no effects"),
    ],
)
def test_what_is_wrong_is_said(change, error, word):
    given = {"measurements": recorded(lacking(), count=101, span=1.0)} | change
    with pytest.raises(error, match=word):
        discover(NOMINAL, **given)


@pytest.mark.parametrize(
    ("columns", "initial", "word"),
    [
        ({"push": 0.0}, {}, "output"),
        ({"stray": 1.0}, {}, "stray|common"),
        ({"push": 0.0, "x": 1.0}, {"spring.q": numpy.nan}, "spring.q"),
        ({"push": 0.0, "x": 1.0}, {"springs.q": 0.0}, "springs.q"),
        ({"push": numpy.nan, "x": 1.0}, {}, "push"),
    ],
)
def test_recordings_that_do_not_fit_are_refused(columns, initial, word):
    t = numpy.linspace(0, 1, 50)
    wave = {name: value * numpy.sin(9 * t) for name, value in columns.items()}
    with pytest.raises(BondGraphError, match=word):
        discover(NOMINAL, Measurement(t, wave, initial=initial))


def test_a_model_without_states_is_refused():
    b, u = sympy.symbols("b u", positive=True)
    flow = One("flow")
    static = assemble(
        "static",
        Se("source", u) >> flow >> R("film", b),
        parameters={b: 2.0},
        inputs=[u],
        outputs={"f": flow.f},
    )
    t = numpy.linspace(0, 1, 50)
    with pytest.raises(SimulationError, match="'static' has no states"):
        discover(static, Measurement(t, {"u": numpy.sin(9 * t), "f": numpy.sin(9 * t)}))


def test_a_sensor_that_is_stuck_is_said_and_names_nothing():
    run = recorded(DRAGGED, count=241, span=3.0)
    stuck = run.changed(columns={"push": run.columns["push"], "v": numpy.zeros(len(run))})
    told = discover(NOMINAL, stuck, stuck, effects=FEW)
    assert told.verdict != "named"
    assert any("all values are the same" in line for line in told.warnings)


@pytest.mark.parametrize("harm", ["gaps", "outliers", "unequal steps", "late clock"])
def test_recordings_as_they_come_still_name_it(harm):
    def harmed(seed):
        run = recorded(DRAGGED, seed, count=301, span=3.0)
        rng = numpy.random.default_rng(seed)
        columns = {name: numpy.array(values) for name, values in run.columns.items()}
        if harm == "gaps":
            columns["v"][rng.random(301) < 0.5] = numpy.nan
        if harm == "outliers":
            columns["x"][[20, 100, 250]] += 0.5
        if harm == "unequal steps":
            kept = numpy.sort(rng.choice(301, 240, replace=False))
            return Measurement(
                run.t[kept], {name: values[kept] for name, values in columns.items()}
            )
        return run.changed(columns=columns, t=run.t + 100 * (harm == "late clock"))

    told = discover(NOMINAL, harmed(0), harmed(1), effects=FEW)
    assert [effect.label for effect in told.effects] == ["quadratic_drag at carriage"]
    assert told.effects[0].parameters["drag"].value == pytest.approx(15, rel=0.1)


def test_a_model_that_keeps_algebraic_variables_is_followed():
    """A pipe of two resistances in series with a tank: no formula gives its flow. What lacks is its fluid's mass."""
    supply, resistance, drag = sympy.Symbol("p0"), *sympy.symbols("R k", positive=True)

    def fed(mass):
        line, tank = One("line"), Zero("tank")
        pipe = R("pipe", effort=lambda f: resistance * f + drag * f * abs(f))
        inside = (pipe, I("fluid", mass)) if mass else (pipe,)
        return assemble(
            "fed",
            Se("pump", supply) >> line >> inside,
            line >> tank >> (C("store", 2.0), R("out", flow=lambda e: 0.3 * e)),
            parameters={resistance: 1.0, drag: 2.0},
            inputs=[supply],
            outputs={"p": tank.e, "q": line.f},
        )

    assert derive(fed(0)).algebraic
    rows = []
    for seed in (0, 1):
        t = numpy.linspace(0, 12, 241)
        level = 1 + 3 * numpy.sin(t + seed) + 2 * numpy.sin((0.37 + 0.9 * seed) * t)
        run = simulate(fed(0.4), t[-1], inputs={"p0": (t, level)}, t_eval=t)
        rng = numpy.random.default_rng(seed)
        noisy = {n: run[n] + 0.01 * run[n].std() * rng.normal(size=len(t)) for n in ("p", "q")}
        rows.append(Measurement(t, {"p0": level, **noisy}))
    told = discover(fed(0), *rows, effects=["added_inertia", "leakage", "effort_bias"])
    assert [effect.label for effect in told.effects] == ["added_inertia at line"]
    assert told.effects[0].parameters["inertance"].value == pytest.approx(0.4, rel=0.05)
