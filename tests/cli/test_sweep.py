"""``bondgraph sweep``: its JSON, its exit status, one line for what goes wrong."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import pytest
import xarray

from .test_cli import call, read

BELT = ["sweep", "mass_on_belt", "--until", "1", "--quantity", "count:contact:stick"]
VARY = ["--vary", "k=50:100:3"]


def test_json_holds_the_contract():
    found = read(*BELT, *VARY, "--vary", "m=-1:1:3[kg]", "--quantity", "final:v", "--json")
    assert found["schema"] == 1 and found["model"] == "mass_on_belt" and found["points"] == 9
    assert found["axes"] == {
        "k": {"unit": "N/m", "values": 3},
        "m": {"unit": "kg", "values": 3},
    }
    assert found["outcomes"] == {"refused": 6, "finished": 3}
    assert set(found["quantities"]) == {"count:contact:stick", "final:v"}
    assert found["quantities"]["final:v"]["unit"] == "m/s"
    assert found["resumed"] == 0 and found["written"] == []


def test_outputs_and_sticks_are_kept_where_nothing_is_asked_for():
    found = read("sweep", "mass_on_belt", "--until", "1", *VARY, "--json")
    asked = {"final:x", "final:v", "count:contact:stick", "energy:residual"}
    assert asked <= set(found["quantities"])


def test_people_get_a_table_and_files(tmp_path):
    plot = tmp_path / "map.png"
    done = call(*BELT, *VARY, "--out", str(tmp_path / "s"), "--plot", str(plot))
    assert "3 points, 3 finished" in done.stdout and "count:contact:stick" in done.stdout
    assert plot.stat().st_size > 5000 and "written" in done.stdout
    assert done.stderr == ""  # no bar where there is no terminal
    with xarray.open_dataset(tmp_path / "s" / "dataset.nc") as dataset:
        assert dataset.k.values.tolist() == [50.0, 75.0, 100.0]


def test_resume_and_refusal(tmp_path):
    words = [*BELT, *VARY, "--out", str(tmp_path / "s")]
    call(*words)
    assert "already" in call(*words, code=2).stderr
    assert read(*words, "--resume", "--json")["resumed"] == 3
    assert "options: rtol" in call(*words, "--resume", "--rtol", "1e-5", code=2).stderr


@pytest.mark.parametrize("design", ["uniform", "latin", "sobol"])
def test_drawn_designs(design, tmp_path):
    words = [*BELT, "--vary", "k=50:100", "--design", design, "--count", "8"]
    call(*words, "--out", str(tmp_path / "a"))
    call(*words, "--out", str(tmp_path / "b"), "--seed", "1")
    with xarray.open_dataset(tmp_path / "a" / "dataset.nc") as a:
        assert a.k.dims == ("point",) and a.k.size == 8
        with xarray.open_dataset(tmp_path / "b" / "dataset.nc") as b:
            assert (a.k.values != b.k.values).any()


def test_states_and_inputs_are_varied():
    words = ["--vary", "v_road=0:1:3[m/s]", "--vary", "sprung.p=0:1:2", "--until", "0.1"]
    found = read("sweep", "quarter_car", *words, "--quantity", "final:v_body", "--json")
    assert found["outcomes"] == {"finished": 6}
    assert found["quantities"]["final:v_body"]["max"] > 0


def test_progress_is_told_on_stderr_when_asked():
    done = call(*BELT, *VARY, "--progress", "--json")
    assert re.search(r"3 of 3, .* points/s", done.stderr) and json.loads(done.stdout)


def test_no_point_with_values_is_exit_one():
    done = call(*BELT, "--vary", "m=-2:-1:2", "--json", code=1)
    assert json.loads(done.stdout)["outcomes"] == {"refused": 2}
    assert "refused" in done.stderr and len(done.stderr.splitlines()) == 1


BAD = [
    (["--vary", "k=50"], "LO:HI"),
    (["--vary", "kk=1:2:3"], "did you mean"),
    (["--vary", "k=1:2:3[kg]"], "k.*kg"),
    (["--vary", "k=1:2:3", "--vary", "k=1:2:3"], "twice"),
    (["--vary", "k=1:2:3", "--quantity", "loudest:v"], "cannot be read"),
    (["--vary", "k=1:2:3", "--quantity", "final:w"], "'w' is not known"),
    (["--vary", "k=1:2:3", "--until", "-1"], "until"),
    (["--vary", "k=1:2:3", "--rtol", "7"], "rtol"),
    (["--vary", "k=1:2:3", "--resume"], "--out"),
    (["--vary", "k=1:2:3", "--count", "5"], "--design"),
    (["--vary", "k=1:2:3", "--design", "latin"], "--count"),
    (["--vary", "k=1:2", "--design", "sobol", "--count", "5"], "powers of two"),
    (["--vary", "k=1:2:3", "--workers", "0"], "workers"),
    (["--vary", "k=1:2:3", "--solver", "cvodes"], "locates no events"),
    ([], "vary"),
]


@pytest.mark.parametrize(("words", "match"), BAD, ids=lambda value: " ".join(value)[-40:])
def test_bad_input_is_one_line_and_exit_two(words, match):
    done = call(*BELT, *words, "--json", code=2)
    assert done.stdout == "" and len(done.stderr.splitlines()) == 1
    assert re.search(match, done.stderr), done.stderr


def test_it_runs_as_a_process_too():
    words = [sys.executable, "-m", "bondgraph.cli", *BELT, *VARY, "--json"]
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    assert json.loads(done.stdout)["outcomes"] == {"finished": 3} and done.stderr == ""
