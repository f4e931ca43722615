"""``bondgraph discover``: JSON, exit status, one line for what goes wrong, what reaches the engine."""

from __future__ import annotations

import json
import re

import pytest

from bondgraph.errors import SimulationError
from bondgraph.files import load, save
from tests.discrepancy.report import made

from .test_cli import call

EFFECT = {"name", "element", "site", "between", "parameters", "delta_bic"}


@pytest.fixture
def files(tmp_path, monkeypatch):
    """A model and two recordings beside each other; the names they have."""
    found = made.named()
    save(found.graph, tmp_path / "m.toml")
    found.recordings[0].write(tmp_path / "train.csv")
    found.held_out[0].write(tmp_path / "held.csv")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def engine(monkeypatch):
    """Stands in for the search: keeps what it was given, returns what it is told to."""

    class Engine:
        given = None
        result = None

        def __call__(self, graph, measurements, **options):
            self.given = (graph, list(measurements), options)
            options["progress"]("screening")
            if isinstance(self.result, Exception):
                raise self.result
            return self.result

    stand_in = Engine()
    stand_in.result = made.named()
    monkeypatch.setattr("bondgraph.discrepancy.discovery.discover", stand_in, raising=False)
    return stand_in


def one_line(text):
    lines = [line for line in text.splitlines() if "bondgraph: screening" not in line]
    assert len(lines) == 1 and lines[0].startswith("bondgraph: ") and "Traceback" not in text, text
    return lines[0]


@pytest.mark.parametrize("verdict", made.VERDICTS)
def test_any_verdict_is_done_and_json_is_all_there_is(verdict, files, engine):
    engine.result = made.VERDICTS[verdict]()
    done = call("discover", "m.toml", "train.csv", "--validate", "held.csv", "--json")
    found = json.loads(done.stdout)
    keys = ["schema", "model", "verdict", "effects", "alternatives", "gap", "improved_model"]
    assert list(found)[: len(keys)] == keys
    assert found["schema"] == 1 and found["model"] == "mass_spring"
    assert found["verdict"] == {"nothing": "none"}.get(verdict, verdict)
    assert found["improved_model"] is None  # nothing was written
    for effect in (*found["effects"], *found["alternatives"]):
        assert set(effect) == EFFECT
    assert "screening" in done.stderr and "screening" not in done.stdout


def test_options_reach_the_search(files, engine):
    call(
        *("discover", "m.toml", "train.csv", "--validate", "held.csv"),
        *("--hold", "push=zero", "--initial", "spring.q=12[mm]", "--free", "k", "--free", "b"),
        *("--effects", "coulomb_friction", "--set", "m=3", "--time-budget", "7.5", "--json"),
    )
    graph, runs, options = engine.given
    assert graph.name == "mass_spring"
    assert [run.name for run in runs] == ["train.csv"] and runs[0].holds == {"push": "zero"}
    assert runs[0].initial == {"spring.q": pytest.approx(0.012)}
    assert [run.name for run in options["validation"]] == ["held.csv"]
    assert options["free"] == ("k", "b") and options["effects"] == ("coulomb_friction",)
    assert options["parameters"] == {"m": 3.0} and options["time_budget"] == 7.5


def test_what_is_not_said_is_left_to_the_search(files, engine):
    call("discover", "m.toml", "train.csv", "--json")
    _, _, options = engine.given
    assert options["free"] is None and options["effects"] is None
    assert options["validation"] == [] and "time_budget" not in options


def test_columns_of_other_names_are_mapped(files, engine):
    text = (files / "train.csv").read_text().replace("v [m/s]", "speed [m/s]", 1)
    (files / "other.csv").write_text(text)
    call("discover", "m.toml", "other.csv", "--map", "v=speed", "--json")
    assert "v" in engine.given[1][0].columns


HELD = {
    "repeated": ["m.toml", "train.csv", "--validate", "held.csv", "--validate", "b.csv"],
    "several": ["m.toml", "train.csv", "--validate", "held.csv", "b.csv"],
    "written together": ["m.toml", "train.csv", "--validate=held.csv", "b.csv"],
    "option between": ["m.toml", "train.csv", "--validate", "held.csv", "b.csv", "--free", "k"],
}


@pytest.mark.parametrize("case", HELD)
def test_no_held_out_file_is_learned_from(case, files, engine):
    (files / "b.csv").write_text((files / "held.csv").read_text())
    call("discover", *HELD[case], "--json")
    _, runs, options = engine.given
    assert [run.name for run in runs] == ["train.csv"]
    assert [run.name for run in options["validation"]] == ["held.csv", "b.csv"]


def test_options_may_stand_first(files, engine):
    call("discover", "--validate", "held.csv", "m.toml", "train.csv", "--json")
    assert [run.name for run in engine.given[1]] == ["train.csv"]


def test_people_read_verdict_gaps_changes_and_advice(files, engine):
    found = engine.result
    done = call("discover", "m.toml", "train.csv", "--report", "out")
    for text in (*found.words, *found.advice, *found.unseen, *found.warnings, found.diff[0]):
        assert text in done.stdout
    assert "coulomb_friction_level' = 1.49" in done.stdout  # the fitted value, not the first one
    (effect,) = found.effects
    level = effect.parameters["level"]
    assert f"{level.value:.4f} ± {level.std:.2g} N" in done.stdout
    assert "report: out/mass_spring.html" in done.stdout
    assert (files / "out" / "mass_spring.html").is_file()
    # gaps of the table are those of the value
    row = re.search(r"^v +held out +(\S+) +(\S+) +(\S+) +(\S+) +(\S+) %", done.stdout, re.M)
    gap = found.gap["validation"]["v"]
    expected = [gap.nominal, gap.before, gap.after, gap.noise_floor, 100 * gap.removed]
    assert [float(text) for text in row.groups()] == pytest.approx(expected, rel=6e-3)


def test_the_report_is_named_in_json(files, engine):
    done = call("discover", "m.toml", "train.csv", "--report", "deep/out", "--json")
    path = json.loads(done.stdout)["improved_model"]
    assert path == "deep/out/improved.toml" and "coulomb_friction" in load(path).elements


BAD = {
    "no file": (["m.toml", "none.csv"], "none.csv"),
    "no model": (["none.toml", "train.csv"], "no such file"),
    "no data": (["m.toml"], "Missing argument"),
    "bad column": (["m.toml", "train.csv", "--map", "v=nope"], "nope"),
    "no overlap": (["m.toml", "strange.csv"], "no column is an output"),
    "wrong unit": (["m.toml", "kelvin.csv"], "column 'v'"),
    "wrong unit held out": (["m.toml", "train.csv", "--validate", "kelvin.csv"], "column 'v'"),
    "no number": (["m.toml", "broken.csv"], "broken.csv"),
    "unknown effect": (["m.toml", "train.csv", "--effects", "colomb_friction"], "did you mean"),
    "unknown parameter": (["m.toml", "train.csv", "--set", "mm=1"], "mm"),
    "unknown free": (["m.toml", "train.csv", "--free", "kk"], "kk"),
    "unknown hold": (["m.toml", "train.csv", "--hold", "push=spline"], "spline"),
    "unknown start": (["m.toml", "train.csv", "--initial", "spring.z=1"], "spring.z"),
    "budget": (["m.toml", "train.csv", "--time-budget", "0"], "above zero"),
    "budget word": (["m.toml", "train.csv", "--time-budget", "soon"], "no number"),
    "twice": (["m.toml", "train.csv", "--validate", "train.csv"], "learned from already"),
    "same": (["m.toml", "train.csv", "./train.csv"], "twice"),
    "report": (["m.toml", "train.csv", "--report", "train.csv"], "train.csv"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_line_and_two(case, files, engine):
    (files / "strange.csv").write_text("time [s],w [m/s]\n0,1\n1,2\n")
    (files / "kelvin.csv").write_text("time [s],push [N],v [K]\n0,1,1\n1,2,1\n2,2,3\n")
    (files / "broken.csv").write_text("time [s],push [N],v [m/s]\n0,1,1\n1,many,1\n2,2,3\n")
    words, said = BAD[case]
    done = call("discover", *words, "--json", code=2)
    assert said in one_line(done.stderr) and done.stdout == ""
    assert engine.given is None  # told before any work was done


def test_work_that_fails_is_one_line(files, engine):
    engine.result = RuntimeError("the search broke")
    done = call("discover", "m.toml", "train.csv", "--json", code=1)
    assert "the search broke" in one_line(done.stderr) and done.stdout == ""


def test_debug_shows_the_traceback(files, engine):
    engine.result = SimulationError("no")
    from click.testing import CliRunner

    from bondgraph.cli import main

    done = CliRunner().invoke(main, ["discover", "m.toml", "train.csv", "--debug"])
    assert isinstance(done.exception, SimulationError)
