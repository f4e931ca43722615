"""Edges of stability from the command line, against matrices written down by hand."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bondgraph.cli import main
from tests.oracles.sliding import critical_slope, critical_speed, sliding_matrix

ROOT = Path(__file__).parents[2]


def stability(*words):
    done = CliRunner().invoke(main, ["stability", *words, "--json"], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return json.loads(done.output)


def hertz(c, **values):
    """Frequency of the pair on the axis at a slope of friction."""
    poles = np.linalg.eigvals(sliding_matrix(c, **values))
    return abs(poles[np.argmax(poles.real)].imag) / (2 * np.pi)


@pytest.mark.parametrize(("v_s", "speed"), [(0.05, 0.322324), (0.1, 0.575332), (0.2, 1.012035)])
def test_speeds(v_s, speed):
    (edge,) = stability("bicycle_brake", "--set", f"v_s={v_s}", "--vary", "V0=0.25:1.5:50")["edges"]
    assert edge["kind"] == "hopf" and edge["parameter"] == "V0"
    assert edge["value"] == pytest.approx(speed, abs=6e-7)
    assert edge["value"] == pytest.approx(critical_speed(v_s), rel=1e-6)
    assert edge["frequency_hz"] == pytest.approx(200.460451, abs=6e-7)
    assert edge["slopes"]["friction"] == pytest.approx(-7.137493, abs=6e-7)


@pytest.mark.parametrize(
    ("zeta", "c", "frequency"),
    [(0.02, -2.863225, 200.073997), (0.05, -7.137493, 200.460451), (0.1, -14.127405, 201.810440)],
)
@pytest.mark.parametrize("vary", ["V0=0.25:1.5:50", "v_s=0.05:0.5:50", "mu_s=0.41:1.2:20"])
def test_slopes(zeta, c, frequency, vary):
    settings = [f"zeta_f={zeta}", f"zeta_w={zeta}", "v_s=0.1", "mu_s=0.45", "V0=0.6"]
    words = [word for setting in settings for word in ("--set", setting)]
    edges = stability("bicycle_brake", *words, "--vary", vary)["edges"]
    assert edges
    for edge in edges:
        assert edge["slopes"]["friction"] == pytest.approx(c, abs=6e-7)
        assert edge["frequency_hz"] == pytest.approx(frequency, abs=6e-7)


@pytest.mark.parametrize("seed", range(4))
def test_other_sets(seed):
    rng = np.random.default_rng([6, seed])
    zeta, zeta_w = rng.uniform(0.015, 0.1, 2).tolist()
    k_f, k_w, drop = *rng.uniform((200, 50), (600, 150)).tolist(), float(rng.uniform(0.05, 0.2))
    own = {"zeta": zeta, "zeta_w": zeta_w, "k_f": 1e3 * k_f, "k_w": 1e3 * k_w}
    settings = [
        f"zeta_f={zeta!r}",
        f"zeta_w={zeta_w!r}",
        f"k_f={k_f!r}[N/mm]",
        f"k_w={k_w!r}[N/mm]",
        f"mu_s={0.4 + drop!r}",
        "v_s=0.12",
    ]
    words = [word for setting in settings for word in ("--set", setting)]
    edges = stability("bicycle_brake", *words, "--vary", "V0=0.1:3:80")["edges"]
    assert edges[-1]["value"] == pytest.approx(critical_speed(0.12, 2250 * drop, **own), rel=1e-6)
    assert edges[-1]["slopes"]["friction"] == pytest.approx(critical_slope(**own), rel=1e-6)
    assert edges[-1]["frequency_hz"] == pytest.approx(hertz(critical_slope(**own), **own), rel=1e-6)


def test_the_frame_alone():
    for zeta in (0.02, 0.05, 0.1):
        b_f = 2 * zeta * 350e3 / (2 * np.pi * 300)
        words = ["--set", f"zeta_f={zeta}", "--set", "v_s=0.2", "--vary", "V0=0.25:2:50"]
        (edge,) = stability("frame_brake", *words)["edges"]
        assert edge["slopes"]["friction"] == pytest.approx(-b_f, rel=1e-9)
        assert edge["frequency_hz"] == pytest.approx(300, rel=1e-9)


def test_a_slope_that_is_a_parameter(tmp_path):
    """The model of docs/stability.md, from a file as it says."""
    page = (ROOT / "docs" / "stability.md").read_text(encoding="utf-8")
    (source,) = re.findall(r"```python\n(# sliding\.py\n.*?)```", page, re.S)
    (tmp_path / "sliding.py").write_text(source, encoding="utf-8")
    found = stability(f"{tmp_path}/sliding.py:sliding", "--vary", "c=-30:0:50")
    edge = found["edges"][-1]
    assert edge["value"] == pytest.approx(-7.137493, abs=6e-7)
    assert edge["frequency_hz"] == pytest.approx(200.460451, abs=6e-7)
    assert edge["onset"] == "degenerate" and edge["first_lyapunov"] == 0
