"""`stability` with maps and reports, `reports` on the library, and the verdict on the terminal."""

from __future__ import annotations

import csv
import json

import pytest

from bondgraph.cli.library import library_reports
from bondgraph.errors import BondGraphError
from bondgraph.models import quarter_car
from tests.pages import Page

from .test_cli import call, read

BELT = ["stability", "mass_on_belt", "--vary", "v_b=0.05:0.8:12", "--vary", "v_s=0.05:0.3"]


def rows(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.reader(file))[1:]


def test_two_varied_make_a_map_in_the_report(tmp_path):
    call(*BELT, "--report", str(tmp_path))
    # the first says how many points, the second leaves it to the map
    assert len(rows(tmp_path / "plots" / "map-v_b-v_s.csv")) == 12 * 60


def test_maps_that_are_asked_for(tmp_path):
    words = [*BELT, "--vary", "c=0:2:9", "--map", "c,v_b", "--map", "v_b,v_s"]
    found = read(*words, "--report", str(tmp_path), "--json")
    assert [item["axes"] for item in found["maps"]] == [["c", "v_b"], ["v_b", "v_s"]]
    assert found["maps"][0]["shape"] == [9, 12]
    curves = {tuple(item["parameters"]): item["kind"] for item in found["boundaries"]}
    assert curves == {("c", "v_b"): "hopf", ("v_b", "v_s"): "hopf"}
    maps = {path.stem for path in (tmp_path / "plots").glob("map-*-damping.svg")}
    assert maps == {"map-c-v_b-damping", "map-v_b-v_s-damping"}


def test_a_model_names_its_own_maps(tmp_path):
    call("stability", "quarter_car", "--report", str(tmp_path))
    assert {"map-b_s-k_s.svg", "locus-b_s.svg"} <= {f.name for f in (tmp_path / "plots").iterdir()}


def test_without_a_map_there_is_none():
    assert "maps" not in read(*BELT, "--json")


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("v_b", "two different names"),
        ("v_b,v_b", "two different names"),
        ("v_b,v_s,c", "two different names"),
        ("v_b,c", "'c' is not varied; add --vary c=LO:HI"),
    ],
)
def test_maps_that_make_no_sense(word, said):
    assert said in call(*BELT, "--map", word, code=2).stderr


def test_the_terminal_tells_in_the_pages_order(monkeypatch):
    said = call("stability", "mass_on_belt", "--vary", "v_b=0.05:0.8:12").stdout
    order = ["Unstable", "The nearest edge: mu_s", "What decides it", "What to change"]
    order += ["Eigenvalues", "How far the edge is", "edge: hopf at v_b = 0.4317"]
    places = [said.find(words) for words in order]
    assert -1 not in places and places == sorted(places)
    assert "onset hard" in said
    feeds = {
        line.split()[0]: float(line.split()[-1])
        for line in said.splitlines()
        if "amper" in line[:8]
    }
    assert feeds["damper"] == pytest.approx(-0.1)  # c/2m


def test_no_line_is_wider_than_a_narrow_terminal(monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    from rich.console import Console

    from bondgraph.cli import verdict
    from bondgraph.stability import assess

    console = Console(width=80, record=True, highlight=False, soft_wrap=True)
    monkeypatch.setattr(verdict, "new_console", lambda: console)
    from bondgraph.models import bicycle_brake

    verdict.stability_tables(assess(bicycle_brake.graph(), {"v_s": 0.2}, vary=["V0=0.5:1.5:20"]))
    assert max(map(len, console.export_text().splitlines())) <= 80


def test_reports_on_the_library(tmp_path):
    entries = library_reports(tmp_path, ["mass_on_belt", "quarter_car"])
    assert [entry.headline for entry in entries] == ["Unstable", "Stable"]
    page = Page((tmp_path / "index.html").read_text(encoding="utf-8"))
    assert page.links == ["mass_on_belt/index.html", "quarter_car/index.html"]
    assert all((tmp_path / link).is_file() for link in page.links)
    assert (
        "1 of 2 to look at" in page.text
        and "mass_on_belt: Unstable." in page.text
        and "mass_on_belt is unstable" in page.text
    )


def test_a_report_that_fails_is_named_and_the_others_go_on(tmp_path, monkeypatch):
    def broken():
        raise BondGraphError("out of order")

    monkeypatch.setattr(quarter_car, "graph", broken)
    words = ["reports", str(tmp_path), "--model", "quarter_car", "--model", "mass_on_belt"]
    done = call(*words, "--json", code=1)
    told = json.loads(done.stdout)["reports"]
    assert [(row["headline"], row["page"]) for row in told] == [
        ("No report", None),
        ("Unstable", "mass_on_belt/index.html"),
    ]
    assert "no report for quarter_car: out of order" in done.stderr
    assert "no_such" in call("reports", str(tmp_path), "--model", "no_such", code=2).stderr
