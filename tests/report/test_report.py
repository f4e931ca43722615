"""The report: complete, self-contained, escaped, and in agreement with its result."""

from __future__ import annotations

import csv
import json
import re

import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, Se, assemble, models
from bondgraph.errors import BondGraphError
from bondgraph.plot import new_axes
from bondgraph.report import Figure, Panel, Section, Table, Text, stability_planes, write_report
from bondgraph.report.words import number
from bondgraph.stability import Vary, assess
from tests.pages import Page

BRAKE = models.bicycle_brake


@pytest.fixture(scope="module")
def squeal(tmp_path_factory):
    values = {"mu_s": 0.5, "tau": 0.06, "v_s": 0.2}
    result = assess(BRAKE.graph(), values, vary=BRAKE.VARY)
    folder = tmp_path_factory.mktemp("report")
    sections = BRAKE.figures(values)
    maps = stability_planes(result, [(Vary("V0", 0.25, 1.5, 20), Vary("v_s", 0.02, 0.4, 15))])
    page = write_report(result, folder, sections, BRAKE.__doc__, maps)
    return result, page, Page(page.read_text(encoding="utf-8")), sections


def columns(path):
    with path.open(encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])}


def test_the_page_stands_alone(squeal):
    _, path, page, _ = squeal
    text = path.read_text(encoding="utf-8")
    inline = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=\s]+", "", text)
    assert len(inline) < len(text)  # maps are images within the page
    assert re.findall(r"https?:|data:|//[a-z]|@import|url\((?!#)", inline) == []
    assert page.tags.isdisjoint({"script", "link", "img", "iframe", "object"})


def test_all_references_lead_somewhere(squeal):
    _, path, page, _ = squeal
    assert len(page.ids) == len(set(page.ids))
    for link in page.links:
        if link.startswith("#"):
            assert link[1:] in page.ids, link
        elif not link.startswith("data:image/png;base64,"):
            assert (path.parent / link).is_file(), link


def test_every_plot_has_its_file_and_its_numbers(squeal):
    _, path, page, _ = squeal
    names = {file.stem for file in (path.parent / "plots").iterdir()}
    expected = {"locus-V0", "growth-V0", "fig4", "fig5", "run-phase", "run-time"}
    expected |= {"mode-shares", "mode-feeds", "mode-shape", "mode-energies", "sensitivities"}
    expected |= {"map-V0-v_s", "map-V0-v_s-damping"}
    expected |= {f"fig{k}-{kind}" for k in (6, 7, 8, 9) for kind in ("phase", "time")}
    assert names == expected
    for name in names:
        svg = (path.parent / "plots" / f"{name}.svg").read_text(encoding="utf-8")
        assert set(re.findall(r"https?://[^\"' ]*", svg)) <= {
            "http://www.w3.org/2000/svg",
            "http://www.w3.org/1999/xlink",
        }
        table = columns(path.parent / "plots" / f"{name}.csv")
        words = {heading for heading in table if "[" not in heading}
        assert len(table) >= 2 and words <= {"element", "parameter", "outcome"}, name
    assert "csv" in " ".join(page.links)


def test_the_chapters_are_in_order(squeal):
    _, path, page, _ = squeal
    titles = re.findall(r"<h2>(.*?)</h2>", path.read_text(encoding="utf-8"))
    assert titles == [
        "What decides it",
        "What to change",
        "Eigenvalues",
        "Operating point",
        "Parameters",
        "Mode shapes",
        "How far the edge is",
        "Maps",
        "Braking",
        "The paper&#x27;s figures",
        "Model",
        "Equations",
        "Causality",
        "Warnings and assumptions",
        "Solver outcomes",
    ]
    assert "Unstable" in page.text and "math" in page.tags and "svg" in page.tags
    assert "Bond graph of bicycle_brake" in path.read_text(encoding="utf-8")


def test_the_page_says_what_the_result_says(squeal):
    result, _, page, _ = squeal
    for sentence in (*result.verdict.splitlines(), *result.reasons, *result.advice):
        assert sentence in page.text
    for warning in result.warnings:
        assert warning in page.text
    for row in result.rows:
        if row.eigenvalue.imag >= 0:
            assert number(row.eigenvalue.real, 7) in page.text
            assert number(row.frequency_hz) in page.text
            assert number(row.damping_ratio, 4) in page.text
    for entry in result.system.A.ravel():
        assert number(entry) in page.text
    for name, value in result.point.outputs.items():
        if name != "V_c":  # zero but for rounding
            assert name in page.words and number(value) in page.text
    (edge,) = result.edges
    assert number(edge.value, 8) in page.text and number(edge.frequency_hz, 8) in page.text


def section(path, title):
    """Return the text of a chapter, with the table's cells by row."""
    text = path.read_text(encoding="utf-8")
    text = re.search(rf'<section id="{title}">.*?</section>', text, re.DOTALL)[0]
    rows = re.findall(r'<tr><th scope="row"[^>]*><code>(.*?)</code></th>(.*?)</tr>', text)
    return text, {
        name: [re.sub("<.*?>", "", cell) for cell in re.findall(r"<td.*?</td>", cells)]
        for name, cells in rows
    }


def test_the_heading_is_two_sentences(squeal):
    result, path, _, _ = squeal
    text = path.read_text(encoding="utf-8")
    box = re.search(r'<div class="verdict bad">(.*?)</div>', text, re.DOTALL)[1]
    first, second = re.findall(r"<p>(.*?)</p>", box)
    assert [first, second] == result.verdict.splitlines()
    # the slope of the friction law at V0, N0 (mu_s - mu_k) e^(-V0/v_s)/v_s with N0 = F_k/mu_k, is
    # the critical one, 7.137493 N s/m, at this mu_k
    mu_k = 0.5 / (1 + 7.137493 * 0.2 * np.exp(0.9 / 0.2) / 900)
    assert f"mu_k has to rise by {100 * (mu_k / 0.4 - 1):.1f} % to {mu_k:.6g}" in second


def test_what_feeds_and_drains_adds_up(squeal):
    result, path, _, _ = squeal
    _, rows = section(path, "what-decides-it")
    feeds = [float(cells[2]) for cells in rows.values() if cells[2]]
    assert sum(feeds) == pytest.approx(result.critical.eigenvalue.real, abs=0.1)
    shares = [float(cells[0].rstrip("%")) for cells in rows.values() if cells[0]]
    assert sum(shares) == pytest.approx(100, abs=0.2)
    assert [name for name, cells in rows.items() if cells[2].startswith("+")] == ["friction"]


def test_what_to_change_is_what_a_step_does(squeal):
    result, path, _, _ = squeal
    text, rows = section(path, "what-to-change")
    for sentence in result.advice:
        assert f"<li>{sentence}</li>" in text
    for name in ("mu_s", "V0", "v_s"):
        value = result.point.parameters[name]
        ends = [
            assess(BRAKE.graph(), {**result.overrides, name: value * (1 + step)}, span=None)
            for step in (1e-4, -1e-4)
        ]
        slope = (ends[0].critical.eigenvalue - ends[1].critical.eigenvalue) / 2e-4
        # the first table of the two that hold the name is overwritten by the second: read both
        cells = re.search(rf"<code>{name}</code></th>(.*?)</tr>", text)[1]
        cells = [re.sub("<.*?>", "", cell) for cell in re.findall(r"<td.*?</td>", cells)]
        assert float(cells[1]) == pytest.approx(0.1 * slope.real, rel=1e-3)
        assert float(cells[2]) == pytest.approx(0.1 * slope.imag / (2 * np.pi), rel=1e-3)
        assert cells[3] == ("lower it" if slope.real > 0 else "raise it")
    assert rows["V0"][2] == "1.01204 m/s" and rows["V0"][4] == "200.5 Hz begin, hard"


def test_maps_tell_the_points_in_long_form(squeal):
    _, path, page, _ = squeal
    table = columns(path.parent / "plots" / "map-V0-v_s.csv")
    speed, width = (np.array(table[f"{name} [m/s]"], float) for name in ("V0", "v_s"))
    assert len(speed) == 20 * 15 and set(table["outcome"]) == {"ok"}
    # stable where the slope of the law stays below the critical one
    slope = 900 / 0.4 * 0.1 * np.exp(-speed / width) / width
    growing = np.array(table["growth rate [1/s]"], float) > 0
    assert np.array_equal(growing, slope > 7.137493)
    assert f"{300 - growing.sum()} of them stable" in page.text
    ratio = np.array(table["least damping ratio [1]"], float)
    assert np.array_equal(growing, ratio < 0)


def test_parameters_stand_with_unit_meaning_and_source(squeal):
    result, path, page, _ = squeal
    text = path.read_text(encoding="utf-8")
    text = re.search(r'<section id="parameters">.*?</section>', text, re.DOTALL)[0]
    row = re.search(r"<tr><th[^>]*><code>k_f</code>.*?</tr>", text)[0]
    cells = re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row)
    meaning = "bending stiffness of the rear frame at the caliper"
    assert cells[1:5] == ["350", "N/mm", "350000 N/m", meaning]
    assert "Procedia" in cells[5]
    row = re.search(r"<tr><th[^>]*><code>v_s</code>.*?</tr>", text)[0]
    assert "set for this report" in row
    assert "k_f/(4*pi^2*f_f^2)" in page.text
    assert "not in these equations: r_t, V_b" in page.text
    assert result.point.parameters["N0"] == pytest.approx(2250)


def test_captions_come_from_the_runs_own_events(squeal):
    _, _, page, sections = squeal
    figures = {figure.title: figure for section in sections for figure in section.figures}
    assert [len(figures[f"Fig. {k}."].run.sticks()) for k in (6, 7, 8, 9)] == [0, 1, 72, 64]
    said = {title: figure.caption for title, figure in figures.items()}
    assert "never stick: the least slip is 0.2023" in said["Fig. 6."]
    assert "1 stick, after 1.6274 ms" in said["Fig. 7."]
    assert "72 sticks, the first after 1.58461 ms" in said["Fig. 8."]
    assert "143.318 Hz" in said["Fig. 8."] and "stuck for 65%" in said["Fig. 8."]
    assert "64 sticks, the first after 57.2102 ms" in said["Fig. 9."]
    assert "64 sticks" in said["This brake."]  # the report's own parameters are Fig. 9's
    for caption in said.values():
        assert " ".join(caption.split()) in " ".join(page.text.split())
    assert page.text.count("finished") >= 10  # in captions and among the outcomes


def test_json_and_csv_hold_the_results_numbers(squeal):
    result, path, _, _ = squeal
    data = json.loads((path.parent / "stability.json").read_text(encoding="utf-8"))
    assert data == json.loads(json.dumps(result.to_json()))
    table = columns(path.parent / "plots" / "locus-V0.csv")
    locus = result.loci[0]
    assert np.array(table["V0 [m/s]"], float) == pytest.approx(locus.values, rel=1e-9)
    real = np.array([table[f"growth rate {k} [1/s]"] for k in range(1, 6)], float).T
    assert real == pytest.approx(locus.eigenvalues.real, rel=1e-9)


@pytest.mark.parametrize("name", models.LIBRARY)
def test_any_model_has_a_report(name, tmp_path):
    module = getattr(models, name)
    result = assess(module.graph())
    path = write_report(result, tmp_path / "deep" / "out", description=module.__doc__)
    page = Page(path.read_text(encoding="utf-8"))
    assert result.verdict.splitlines()[0] in page.text
    assert len(page.ids) == len(set(page.ids))


def test_whatever_comes_from_outside_is_escaped(tmp_path):
    evil = "<script>alert('x')</script>&"
    k = sympy.Symbol("k", positive=True)
    v = One("v<i")
    spring = C("spring<b", stiffness=k)
    graph = assemble(
        "evil<u",
        Se("F", 1) >> v >> (I("m", 2), spring, R("d", 1)),
        parameters={k: (8.0, "N/m", evil, evil)},
        outputs={"x<hr": (spring.q, "m", evil)},
    )
    ax = new_axes()
    ax.plot([0, 1], [1, 2], label=evil)
    ax.set_xlabel(evil)
    section = Section(
        evil,
        (
            Text(evil),
            Text(evil, "code"),
            Table((evil,), ((evil,),), caption=evil),
            Figure(evil, (Panel("plot", ax, evil),), evil),
        ),
    )
    result = assess(graph, vary=["k=1:9:5"])
    text = write_report(result, tmp_path, [section], evil).read_text(encoding="utf-8")
    page = Page(text)
    assert page.tags.isdisjoint({"script", "b", "i", "u", "hr"})
    assert evil in page.text


def test_names_of_plots_are_names_of_files(tmp_path):
    result = assess(models.quarter_car.graph())
    for name in ("../up", "a b"):
        section = Section("s", (Figure("f", (Panel(name, new_axes(), "d"),)),))
        with pytest.raises(BondGraphError, match="its name is that of files"):
            write_report(result, tmp_path, [section])


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BondGraphError, match="cannot write the report into"):
        write_report(assess(models.quarter_car.graph()), tmp_path / "file" / "out")


def test_numbers_are_short_and_exact():
    assert [number(x) for x in (0.0, 1e-18, -2.96053e6, 0.05, 1234567.0)] == [
        "0",
        "1e-18",
        "-2.96053e6",
        "0.05",
        "1.23457e6",
    ]


def test_every_mode_says_what_moves_it(squeal):
    result, _, page, _ = squeal
    effect = result.sensitivities.ranked(0, derived=False, by="growth")[0]
    assert f"{effect.parameter} +{effect.growth(0.1):.3g}" in page.text
    # the frame's own frequency is what moves the frame's mode
    place = next(k for k, row in enumerate(result.rows) if row.frequency_hz > 290)
    pitch = result.sensitivities.ranked(place, derived=False, by="frequency")[0]
    assert pitch.parameter == "f_f" and f"f_f +{pitch.frequency(0.1):.3g}" in page.text
