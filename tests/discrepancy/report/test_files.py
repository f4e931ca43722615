"""The files beside the page: JSON as the contract has it, a model that runs, courses that can be read."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from bondgraph import One, R, Se, assemble, simulate
from bondgraph.discrepancy import Measurement
from bondgraph.discrepancy.report import to_json, write_report
from bondgraph.errors import BondGraphError
from bondgraph.files import load
from tests.discrepancy.report import made
from tests.discrepancy.report.test_page import odd

EFFECT = ["name", "element", "site", "between", "parameters", "delta_bic"]


def refuse(word):
    raise AssertionError(f"JSON holds no {word}")


@pytest.fixture(scope="module")
def named(tmp_path_factory):
    found = made.named()
    return found, write_report(found, tmp_path_factory.mktemp("report") / "deep" / "out")


def check(told):
    """Hold an object against the contract of `bondgraph discover --json`."""
    head = ["schema", "model", "verdict", "effects", "alternatives", "gap", "improved_model"]
    assert list(told)[:7] == head
    assert told["schema"] == 1 and isinstance(told["model"], str)
    assert told["verdict"] in ("named", "ambiguous", "unnamed", "none")
    for effect in (*told["effects"], *told["alternatives"]):
        assert list(effect) == EFFECT
        assert all(isinstance(effect[key], str) for key in ("name", "element", "site"))
        between = effect["between"]
        assert between is None or (isinstance(between, list) and len(between) == 2)
        for estimate in effect["parameters"].values():
            assert list(estimate) == ["value", "std", "unit"]
            assert isinstance(estimate["value"], float) and isinstance(estimate["unit"], str)
    assert list(told["gap"]) == ["train", "validation"]
    for gaps in told["gap"].values():
        for gap in gaps.values():
            assert list(gap)[:4] == ["before", "after", "noise_floor", "unit"]


@pytest.mark.parametrize("verdict", made.VERDICTS)
def test_json_holds_the_contract(verdict):
    found = made.VERDICTS[verdict]()
    told = to_json(found)
    check(told)
    assert json.loads(json.dumps(told, allow_nan=False)) == told
    assert told["verdict"] == str(found.verdict) and told["improved_model"] is None


def test_json_holds_the_values():
    found = made.named()
    effect = replace(found.effects[0], site="between a and b", between=("a", "b"))
    told = to_json(replace(found, effects=(effect,)), "out/improved.toml")
    assert told["improved_model"] == "out/improved.toml"
    assert told["effects"][0]["between"] == ["a", "b"]
    level = effect.parameters["level"]
    assert told["effects"][0]["parameters"] == {
        "level": {"value": level.value, "std": level.std, "unit": "N"}
    }
    gap = found.gap["validation"]["v"]
    assert told["gap"]["validation"]["v"]["after"] == gap.after
    assert told["parameters"]["b"]["nominal"] == 4.0
    assert [item["label"] for item in told["explanations"]][-1] == "nothing missing"


def test_what_is_not_finite_is_null():
    told = to_json(odd())
    text = json.dumps(told, allow_nan=False)
    json.loads(text, parse_constant=refuse)
    assert told["gap"]["train"]["v"]["before"] is None and told["gap"]["validation"] == {}
    assert told["parameters"]["k"] == {"nominal": None, "value": 0.0, "std": None, "unit": ""}
    (rival,) = told["alternatives"]
    assert rival["parameters"]["damping"]["std"] is None


def test_the_file_is_the_object(named):
    found, written = named
    told = json.loads(written.data.read_text(encoding="utf-8"))
    check(told)
    assert told == json.loads(json.dumps(to_json(found, "improved.toml")))


def test_the_improved_model_runs_as_the_fit_did(named):
    found, written = named
    again = load(written.improved)
    run = found.held_out[0]
    inputs = {"push": (run.t, run.columns["push"])}
    span = (float(run.t[0]), float(run.t[-1]))
    one, other = (
        simulate(graph, span, inputs=inputs, t_eval=run.t) for graph in (again, found.improved)
    )
    for name in ("x", "v"):
        size = np.abs(other[name]).max()
        assert np.abs(one[name] - other[name]).max() < 1e-9 * size
        # and as near to what was measured as the report says
        gap = math.sqrt(np.mean((run.columns[name] - one[name]) ** 2))
        assert gap == pytest.approx(found.gap["validation"][name].after, rel=1e-3)


def test_courses_are_recordings(named):
    found, written = named
    names = [path.name for path in written.courses]
    assert names == ["train-1-train.csv", "validation-1-validation.csv"]
    for path, course in zip(written.courses, (*found.train, *found.validation), strict=True):
        read = Measurement.read(path, rename={"v": "v after"})
        assert read.t == pytest.approx(course.t, rel=1e-9)
        assert read.columns["v"] == pytest.approx(course.after["v"], rel=1e-9, abs=1e-12)
        assert read.units["v"] == "m/s" and "x measured" in read.columns


def test_gaps_of_a_course_are_empty_cells(tmp_path):
    text = write_report(odd(), tmp_path).courses[0].read_text(encoding="utf-8")
    first, *rows = [line.split(",") for line in text.splitlines()]
    assert first[1] == "v measured [1]" and len(first) == 10
    assert all(row[1] == "" for row in rows) and "nan" not in text


@pytest.mark.parametrize("verdict", ["ambiguous", "unnamed", "nothing"])
def test_without_a_name_there_is_no_improved_model(verdict, tmp_path):
    (tmp_path / "improved.toml").write_text("of an earlier report")
    written = write_report(made.plain(made.VERDICTS[verdict]()), tmp_path)
    assert written.improved is None and not (tmp_path / "improved.toml").exists()


def test_a_model_no_file_can_hold_is_a_warning(tmp_path):
    v = One("v")
    graph = assemble("odd", Se("F", 1) >> v >> R("r", effort=unwritable))
    written = write_report(replace(made.plain(made.named()), improved=graph), tmp_path)
    assert written.improved is None
    assert "is not written as a model file" in written.page.read_text(encoding="utf-8")
    assert json.loads(written.data.read_text())["improved_model"] is None


def unwritable(flow):
    import sympy

    return flow + sympy.besselj(0, flow)


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BondGraphError, match="cannot write the report into"):
        write_report(made.plain(made.nothing()), tmp_path / "file" / "out")


def test_a_model_with_an_odd_name_has_a_page(tmp_path):
    found = made.plain(made.nothing())
    graph = replace(found.graph, name="rig 2/a")
    assert write_report(replace(found, graph=graph), tmp_path).page.name == "rig-2-a.html"
