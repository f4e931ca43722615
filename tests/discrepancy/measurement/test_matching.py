"""Recordings beside models."""

import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, Se, assemble, simulate
from bondgraph.discrepancy.measurement import Measurement, matched
from bondgraph.errors import MeasurementError

F, m = sympy.symbols("F m", positive=True)
T = [0, 0.1, 0.2, 0.3]


def oscillator(unit="N", outputs=None):
    v, mass, spring = One("v"), I("mass", m), C("spring", stiffness=8)
    known = {"x": spring.q, "v": (mass.f, "km/h"), "sum": spring.e + mass.f}
    return assemble(
        "oscillator",
        Se("push", F) >> v >> (mass, spring, R("damper", 0.5)),
        parameters={m: (2, "kg")},
        inputs={F: unit},
        outputs=known if outputs is None else outputs,
    )


def recording(columns, **said):
    return Measurement(T, columns, name="run", **said)


def test_columns_are_sorted_and_brought_to_si():
    found = matched(
        recording(
            {
                "F": [0, 1, 2, 3],
                "x": [1, np.nan, 3, 4],
                "v": [3.6, 7.2, 0, 0],
                "temp": [1, 1, 1, 2],
            },
            units={"F": "kN", "x": "mm"},
            holds={"F": "zero"},
            initial={"spring.q": 0.001},
        ),
        oscillator(),
    )
    assert found.inputs["F"].hold == "zero" and found.inputs["F"].values.tolist() == [
        0,
        1e3,
        2e3,
        3e3,
    ]
    np.testing.assert_allclose(found.outputs["x"], [1e-3, np.nan, 3e-3, 4e-3])
    np.testing.assert_allclose(found.outputs["v"], [1, 2, 0, 0])  # no unit: the model's, km/h
    assert found.unknown == ("temp",) and found.missing == () and found.span == (0, 0.3)
    assert found.units == {"F": "N", "x": "m", "v": "m/s"}
    assert dict(found.initial) == {"spring.q": 0.001} and found.free == ("mass.p",)
    assert any("'v' has no unit and is taken in the model's, km/h" in w for w in found.warnings)
    assert all(warning.startswith("run: ") for warning in found.warnings)


def test_the_unit_of_a_bare_output_is_inferred():
    with pytest.raises(
        MeasurementError, match="run, column 'x': unit 's' does not measure what 'm'"
    ):
        matched(recording({"x": T}, units={"x": "s"}), oscillator())


def test_a_unit_that_nobody_can_check_is_told():
    found = matched(recording({"sum": T}, units={"sum": "kN"}), oscillator())
    assert found.outputs["sum"].tolist() == pytest.approx([0, 100, 200, 300])
    assert any("'sum' is in kN; the model does not say" in warning for warning in found.warnings)


def test_a_hold_that_nobody_declared_is_told():
    found = matched(recording({"F": T, "x": T}), oscillator())
    assert found.inputs["F"].hold == "linear"
    assert any("'F' is taken as straight lines" in warning for warning in found.warnings)
    declared = matched(recording({"F": T, "x": T}, holds={"F": "linear"}), oscillator())
    assert declared.warnings == ()


@pytest.mark.parametrize(
    ("hold", "within"), [("zero", [0, 0, 2, 3]), ("linear", [0, 1, 2, 3]), ("band", [0, 1, 2, 3])]
)
def test_gaps_of_an_input_are_filled_by_its_hold(hold, within):
    t = np.arange(60) / 10
    values = np.arange(60.0)
    values[1] = np.nan
    run = Measurement(t, {"F": values, "x": t}, holds={"F": hold})
    found = matched(run, oscillator())
    drive = found.inputs["F"]
    times, known = np.asarray(drive.times), np.asarray(drive.values)
    if hold == "zero":
        here = known[np.searchsorted(times, t[:4], side="right") - 1]
    else:
        here = np.interp(t[:4], times, known)
    assert here.tolist() == pytest.approx(within)
    assert any("1 of 60 samples missing" in warning for warning in found.warnings)


def test_missing_inputs_are_zero_and_told():
    found = matched(recording({"x": T}), oscillator())
    assert found.missing == ("F",) and not found.inputs
    assert any("'F' has no column and is taken as zero" in warning for warning in found.warnings)


def test_an_output_given_at_the_start_is_no_free_state():
    found = matched(recording({"x": T}, initial={"v": 1.0}), oscillator())
    assert found.free == ("spring.q",)


@pytest.mark.parametrize(
    ("columns", "said", "words"),
    [
        (
            {"pos": T, "xx": T},
            {},
            r"no column is an output.*pos, xx.*x, v, sum.*'xx': did you mean x",
        ),
        ({"F": T}, {}, "no column is an output of 'oscillator'"),
        ({"F": T, "x": T}, {"units": {"F": "m"}}, "column 'F': unit 'm' does not measure what 'N'"),
        ({"F": T, "x": T}, {"units": {"F": "new"}}, "column 'F': unit 'new' is not known"),
        ({"F": T, "x": T}, {"holds": {"F": "cubic"}}, "hold 'cubic' is not known"),
        (
            {"x": T},
            {"initial": {"mas.p": 1.0}},
            r"'mas\.p' is none of 'oscillator'; did you mean mass\.p",
        ),
        ({"x": T}, {"initial": {"mass.p": float("nan")}}, "is nan, not a finite number"),
    ],
)
def test_what_does_not_fit(columns, said, words):
    with pytest.raises(MeasurementError, match=words):
        matched(recording(columns, **said), oscillator())


def test_band_limited_inputs_need_uniform_times():
    run = Measurement([0, 1, 3], {"F": [1, 2, 3], "x": [1, 2, 3]}, holds={"F": "band"}, name="run")
    with pytest.raises(MeasurementError, match="run, column 'F'"):
        matched(run, oscillator())


def test_a_simulated_file_is_read_back_and_simulated_again(tmp_path):
    graph = oscillator()
    t = np.linspace(0, 3, 301)
    drive = (t, np.sin(3 * t))
    first = simulate(graph, (0, 3), inputs={"F": drive}, t_eval=t, initial={"spring.q": 0.2})
    run = Measurement.read(
        first.save(tmp_path / "run.csv"), holds={"F": "linear"}, initial={"spring.q": 0.2}
    )
    found = matched(run, graph)
    np.testing.assert_array_equal(found.outputs["x"], first["x"])
    again = simulate(
        graph, found.span, inputs=dict(found.inputs), t_eval=t, initial=dict(found.initial)
    )
    np.testing.assert_allclose(again["x"], found.outputs["x"], atol=1e-6)
