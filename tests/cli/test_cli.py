"""The command line's contract: JSON, exit codes, one line an error, cheap help."""

from __future__ import annotations

import json
import math
import resource
import subprocess
import sys
import textwrap

import pytest
from click.testing import CliRunner

from bondgraph import Samples, simulate
from bondgraph.cli import main
from bondgraph.models import quarter_car
from tests.oracles import brake as oracle

FIG9 = ["--set", "mu_s=.5", "--set", "tau=.06", "--set", "v_s=.2"]


def call(*words, code=0):
    done = CliRunner().invoke(main, list(words), prog_name="bondgraph")
    assert done.exit_code == code, done.output + done.stderr
    return done


def read(*words):
    return json.loads(call(*words).stdout)


def test_models_lists_the_library():
    assert {row["name"] for row in read("models", "--json")["models"]} >= {
        "bicycle_brake",
        "frame_brake",
    }
    assert "bicycle_brake" in call("models").stdout


def test_simulate_json_holds_the_contract():
    run = read("simulate", "bicycle_brake", "--until", "0.02", "--set", "tau=0.02", "--json")
    assert run["schema"] == 1 and run["outcome"] == "finished" and run["t_end"] == 0.02
    assert {"omega_r", "V_c", "theta_w", "x_c"} <= set(run["final"])
    assert run["events"][0]["element"] == "friction" and run["events"][0]["to"] == "stick"
    assert set(run["energy"]) == {"supplied", "stored", "dissipated", "relative_residual"}


@pytest.mark.parametrize("speed", ["0.9", "1.0", "1.2"])
def test_stability_json_gives_the_eigenvalues_of_the_brake(speed):
    found = read("stability", "bicycle_brake", *FIG9, "--set", f"V0={speed}", "--json")
    poles = [complex(row["real"], row["imag"]) for row in found["eigenvalues"]]
    brake = oracle.Brake(mu_s=0.5, tau=0.06, v_s=0.2, V0=float(speed))
    for pole in oracle.modes(oracle.sliding_matrix(brake)):
        assert min(abs(pole - other) for other in poles) < 1e-9 * abs(pole)
    assert found["stable"] == (max(pole.real for pole in poles) < 0)
    assert len(found["A"]) == len(found["states"])


def test_the_rigid_wheel_misses_the_instability():
    assert read("stability", "bicycle_brake", *FIG9, "--json")["stable"] is False
    assert read("stability", "frame_brake", *FIG9, "--json")["stable"] is True


def test_stability_finds_the_edge_along_a_parameter():
    found = read("stability", "bicycle_brake", *FIG9, "--vary", "V0=0.8:1.3:21", "--json")
    (edge,) = found["edges"]
    assert edge["kind"] == "hopf" and edge["parameter"] == "V0"
    _, frequency, slip = oracle.hopf(oracle.Brake(mu_s=0.5, tau=0.06, v_s=0.2))
    assert edge["value"] == pytest.approx(slip, rel=1e-6)
    assert edge["frequency_hz"] == pytest.approx(frequency, rel=1e-6)


def test_equations_in_three_forms():
    found = read("equations", "bicycle_brake", "--format", "json")
    assert set(found) >= {
        "schema",
        "states",
        "algebraic",
        "inputs",
        "parameters",
        "causality",
        "warnings",
    }
    assert found["parameters"]["k_f"]["unit"]
    assert any("wheel.tyre" in line for line in found["warnings"])
    assert "rear.mass.p" in call("equations", "bicycle_brake").stdout
    assert "\\dot" in call("equations", "bicycle_brake", "--format", "latex").stdout


def test_show_prints_and_draws(tmp_path):
    shown = call("show", "bicycle_brake", "--svg", str(tmp_path / "brake.svg")).stdout
    assert "derivative causality" in shown and "stiffness" in shown
    assert (tmp_path / "brake.svg").read_text().lstrip().startswith(("<svg", "<?xml"))
    assert read("show", "bicycle_brake", "--json")["derivative"] == ["wheel.tyre"]


def test_simulate_writes_files(tmp_path):
    words = [
        "--until",
        "0.05",
        "--points",
        "101",
        "--out",
        str(tmp_path / "run.csv"),
        "--plot",
        str(tmp_path / "run.png"),
    ]
    call("simulate", "mass_on_belt", *words)
    assert len((tmp_path / "run.csv").read_text().splitlines()) == 103
    assert (tmp_path / "run.png").stat().st_size > 5000


@pytest.mark.parametrize("hold", ["zero", "linear", "band"])
def test_simulate_takes_the_hold_after_the_file(tmp_path, hold):
    road = tmp_path / "a:b.csv"
    road.write_text("time [s],v_road [m/s]\n" + "".join(f"{i / 50},{i % 3}\n" for i in range(40)))
    words = ("simulate", "quarter_car", "--until", "0.5", "--json", "--input")
    run = read(*words, f"v_road={road}:{hold}")
    given = Samples.read(road, "v_road", "m/s", hold)
    direct = simulate(quarter_car.graph(), 0.5, inputs={"v_road": given})
    assert run["final"] == pytest.approx(direct.final, rel=1e-12)
    assert run["solver"]["name"] == "dopri5" and "not stiff" in run["solver"]["reason"]


def test_simulate_reads_inputs(tmp_path):
    road = tmp_path / "road.csv"
    road.write_text("# a bump\ntime [ms],v_road [mm/s]\n0,0\n50,100\n100,0\n")
    bump = read("simulate", "quarter_car", "--until", "0.2", "--input", f"v_road={road}", "--json")
    flat = read("simulate", "quarter_car", "--until", "0.2", "--json")
    assert abs(flat["final"]["v_body"]) < 1e-9 < abs(bump["final"]["v_body"])


def test_a_model_from_a_python_file(tmp_path):
    path = tmp_path / "rc.py"
    path.write_text(
        textwrap.dedent(
            """
            from bondgraph import C, One, R, Se, assemble

            def circuit():
                loop = One("loop")
                return assemble("rc", Se("E", 1) >> loop >> (R("r", 2), C("c", 3)))

            wrong = 3

            def broken():
                return 1 / 0
            """
        )
    )
    found = read("stability", f"{path}:circuit", "--json")
    assert found["eigenvalues"][0]["real"] == pytest.approx(-1 / 6)
    assert "not a BondGraph" in call("show", f"{path}:wrong", code=2).stderr
    assert "line 11" in call("show", f"{path}:broken", code=2).stderr
    assert "no such name" in call("show", f"{path}:circut", code=2).stderr


BAD = [
    (["simulate", "bicycle_brake", "--until", "0.1", "--set", "mu_s=-1"], "mu_s.*positive"),
    (["simulate", "bicycle_brake", "--until", "0.1", "--set", "k_f=350[kg]"], "k_f.*kg"),
    (["simulate", "bicycle_brake", "--until", "0.1", "--set", "k_f=350[nonsense]"], "nonsense"),
    (["simulate", "bicycle_brake", "--until", "0.1", "--set", "k_f=[N/mm]"], "NAME=VALUE"),
    (["simulate", "bicycle_brake", "--until", "0.1", "--set", "mu_k=nan"], "finite"),
    (["simulate", "bicycle_brake", "--until", "0.1", "--set", "k=1"], "not known"),
    (["simulate", "bicycle_brake", "--until", "0.1", "--set", "tau=1", "--set", "tau=2"], "twice"),
    (["simulate", "bicycle_brake", "--until", "-1"], "until"),
    (["simulate", "bicycle_brake", "--until", "nan"], "finite"),
    (["simulate", "bicycle_brake", "--until", "soon"], "no number"),
    (["simulate", "bicycle_brake", "--until", "0.1", "--rtol", "-1"], "rtol"),
    (["simulate", "bicycle_brake", "--until", "0.1", "--initial", "z=1"], "not known"),
    (["simulate", "bicycle_brake", "--until", "0.1", "--input", "u=1"], "input 'u'"),
    (["simulate", "quarter_car", "--until", "1", "--input", "v_road=a.csv:cubic"], "zero, linear"),
    (["simulate", "bicycle_brake", "--until", "0.1", "--out", "run.xls"], "ending"),
    (["simulate", "bicycle_brake"], "until"),
    (["simulate", "bicycle_brak", "--until", "1"], "did you mean bicycle_brake"),
    (["stability", "bicycle_brake", "--set", "V0=nan"], "finite"),
    (["stability", "bicycle_brake", "--vary", "V0=1"], "LO:HI"),
    (["stability", "bicycle_brake", "--vary", "V0=1:nan:3"], "finite"),
    (["stability", "bicycle_brake", "--vary", "V0=1:2:3[kg]"], "V0"),
    (["stability", "bicycle_brake", "--vary", "V=1:2:3"], "not known"),
    (["stability", "bicycle_brake", "--mode", "friction=fly"], "no mode"),
    (["stability", "missing.py:graph"], "no such file"),
    (["stability", "missing.toml"], "missing.toml"),
    (["simulate", "mass_on_belt", "--until", "1", "--solver", "cvodes"], "locates no events"),
    (["simulate", "quarter_car", "--until", "1", "--solver", "euler"], "cvodes"),
    (["show"], "MODEL"),
    (["shwo", "bicycle_brake"], "shwo"),
]


@pytest.mark.parametrize(
    ("words", "match"),
    BAD,
    ids=lambda value: " ".join(value)[-40:] if isinstance(value, list) else "",
)
def test_bad_input_is_one_line_and_exit_two(words, match):
    import re

    for extra in ([], ["--json"]) if "shwo" not in words else ([],):
        done = call(*words, *extra, code=2)
        assert done.stdout == ""
        assert len(done.stderr.splitlines()) == 1 and "Traceback" not in done.stderr
        assert re.search(match, done.stderr), done.stderr


def test_a_run_that_stops_early_is_exit_one_with_its_reason(tmp_path):
    path = tmp_path / "escape.py"
    path.write_text(
        "from bondgraph import I, One, Se, assemble\n"
        "m = I('m', 1, initial=1)\n"
        "g = assemble('escape', Se('push', m.p**2) >> One('v') >> m)\n"
    )
    done = call("simulate", f"{path}:g", "--until", "2", "--json", code=1)
    found = json.loads(done.stdout)
    assert found["outcome"] != "finished" and math.isfinite(found["t_end"])
    assert found["outcome"] in done.stderr


def test_debug_shows_the_traceback():
    done = CliRunner().invoke(main, ["show", "nothing", "--debug"], prog_name="bondgraph")
    assert done.exception is not None and not isinstance(done.exception, SystemExit)


def test_help_costs_little():
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [sys.executable, "-m", "bondgraph.cli", "--help"], check=True, capture_output=True
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    assert used < 0.5  # CPU seconds, the contract
