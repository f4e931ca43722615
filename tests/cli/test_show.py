"""`show` and `equations` on a model file with each kind of element."""

from __future__ import annotations

import json
import textwrap
import xml.etree.ElementTree as ET

import pytest

from .. import showcase
from .test_cli import call, read


@pytest.fixture(scope="module")
def models(tmp_path_factory):
    """A file of models, as somebody would write one."""
    path = tmp_path_factory.mktemp("models") / "own.py"
    path.write_text(
        "import sys\n"
        f"sys.path.insert(0, {str(showcase.__file__).rpartition('/tests/')[0]!r})\n"
        f"from tests.showcase import {', '.join(showcase.GRAPHS)}\n"
    )
    return path


@pytest.mark.parametrize("name", sorted(showcase.GRAPHS))
def test_show_and_equations_run(models, tmp_path, name):
    word = f"{models}:{name}"
    drawn = call("show", word, "--svg", str(tmp_path / "g.svg")).stdout
    assert "drawing:" in drawn
    ET.parse(tmp_path / "g.svg")
    assert "State equations" in call("equations", word).stdout
    assert read("equations", word, "--format", "json")["states"]
    assert "\\dot" in call("equations", word, "--format", "latex").stdout
    assert call("show", word, "--causality").stdout.startswith(showcase.GRAPHS[name]().name)
    assert read("show", word, "--causality", "--json")["schema"] == 1


def test_laws_of_switching_elements_and_blocks_are_shown(models):
    shown = call("show", f"{models}:ball").stdout
    assert "free while height.q > 0 with e = 0" in shown
    assert "der(y) = 3 - gauge.y" in call("show", f"{models}:controlled").stdout


def test_causality_takes_the_place_of_the_overview(tmp_path):
    plain = call("show", "bicycle_brake").stdout
    report = call("show", "bicycle_brake", "--causality", "--svg", str(tmp_path / "b.svg")).stdout
    assert "Parameters" in plain and "Parameters" not in report
    assert "wheel.tyre.p = J_t*wheel.rim.f = J_t*omega_t, bound by wheel.road" in report
    assert report.rstrip().endswith(f"drawing: {tmp_path / 'b.svg'}")
    found = read("show", "bicycle_brake", "--causality", "--json", "--svg", str(tmp_path / "c.svg"))
    assert [row["modes"] for row in found["modes"]] == [{"friction": "slip"}, {"friction": "stick"}]


def test_a_conflict_is_one_line(tmp_path):
    path = tmp_path / "bad.py"
    path.write_text(
        textwrap.dedent(
            """
            from bondgraph import One, R, Sf, assemble
            shaft = One("shaft")
            g = assemble("g", (Sf("a", 1), Sf("b", 1)) >> shaft >> R("r", 1))
            """
        )
    )
    done = call("show", f"{path}:g", "--causality", "--json", code=1)
    assert done.stdout == "" and len(done.stderr.splitlines()) == 1 and "'shaft'" in done.stderr


def test_json_is_one_object(models):
    done = call("show", f"{models}:rectifier", "--causality", "--json")
    assert json.loads(done.stdout)["possible_modes"] == 4
