"""Mode shapes, and limit cycles beside the verdict, in the report and on the terminal."""

from __future__ import annotations

import csv
import json
import re

import pytest

from bondgraph import models
from bondgraph.attractors import motions
from bondgraph.report import headline, write_report
from bondgraph.stability import assess
from tests.cli.test_cli import call, read
from tests.pages import Page

BRAKE = models.bicycle_brake


def columns(path):
    with path.open(encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])}


@pytest.fixture(scope="module")
def brake(tmp_path_factory):
    values = {"mu_s": 0.5, "tau": 0.02}
    result = assess(BRAKE.graph(), values)
    found = motions(BRAKE.graph(), values, vary=["tau=0.01:0.04:4"])
    path = write_report(result, tmp_path_factory.mktemp("report"), motions=found)
    return result, found, path


def test_stable_alone_would_mislead(brake):
    result, found, path = brake
    assert result.stable and found.attractors.beside
    text = path.read_text(encoding="utf-8")
    assert headline(result) == "Stable"
    assert 'class="verdict bad"' in text
    assert re.search(r'headline">Stable for small motions, with a vibration beside it<', text)


def test_cycles_stand_with_their_numbers(brake):
    _, found, path = brake
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    assert found.attractors.words in page.text
    chapter = re.search(r'<section id="limit-cycles.*?</section>', text, re.DOTALL)[0]
    # the paper's Fig. 8, and a second one that its own start does not meet
    assert "143.318" in chapter and "108.632" in chapter and "friction 65%" in chapter
    assert len(re.findall("limit cycle<", chapter)) == 2
    table = columns(path.parent / "plots" / "attractors.csv")
    assert any(name.startswith("cycle, 143.3 Hz") for name in table)


def test_what_the_own_start_ends_in_stands_along_a_parameter(brake):
    _, found, path = brake
    (along,) = found.reaches
    assert along.words in Page(path.read_text(encoding="utf-8")).text
    # fast application squeals, slow application slides
    assert along.outcomes[0] == "cycle" and along.outcomes[-1] == "steady"
    assert (path.parent / "plots" / "reach-tau.csv").exists()
    numbers = json.loads((path.parent / "stability.json").read_text(encoding="utf-8"))
    assert numbers["reach"][0]["changes"] and {"attractors", "trends"} <= set(numbers)


def test_the_papers_trends_are_the_reports_own(tmp_path):
    """Procedia Engineering 72 (2014) 471-476: what furthers vibration, from the page's tables."""
    call("stability", "bicycle_brake", "--set", "mu_s=0.42", "--report", str(tmp_path))
    text = (tmp_path / "index.html").read_text(encoding="utf-8")
    chapter = re.search(r'<section id="limit-cycles.*?</section>', text, re.DOTALL)[0]
    rows = dict(re.findall(r'<th scope="row"><code>(\w+)</code></th><td>(more|less)</td>', chapter))
    more = {"mu_s", "v_s", "F_k"}  # ratio of the coefficients, slower decay, larger force
    less = {
        "mu_k",
        "tau",
        "V0",
        "k_f",
        "k_w",
        "zeta_f",
        "zeta_w",
    }  # faster, slower bike, softer, ...
    assert more <= {name for name, word in rows.items() if word == "more"}
    assert less <= {name for name, word in rows.items() if word == "less"}
    # the eigenvalues say the same of what they know
    numbers = json.loads((tmp_path / "stability.json").read_text(encoding="utf-8"))
    place = next(k for k, row in enumerate(numbers["eigenvalues"]) if row["frequency_hz"] > 0)
    slopes = {row["parameter"]: row["d_growth"][place] for row in numbers["sensitivities"]}
    assert all(slopes[name] > 0 for name in more)
    assert all(slopes[name] < 0 for name in ("mu_k", "V0", "k_w", "zeta_w"))


def test_the_shape_of_the_critical_mode(brake):
    result, _, path = brake
    table = columns(path.parent / "plots" / "mode-shape.csv")
    sizes = dict(
        zip(
            table["element"], map(float, table["share of the largest of its unit [1]"]), strict=True
        )
    )
    # rotor and spokes move alike, the imposed rim stands still
    assert sizes["wheel.hub"] == sizes["wheel.windup"] == 1 and sizes["wheel.rim"] == 0
    energies = columns(path.parent / "plots" / "mode-energies.csv")
    place = energies["frequency [Hz]"].index(f"{result.critical.frequency_hz:.10g}")
    for name, share in result.critical.energies.items():
        assert float(energies[f"{name} [1]"][place]) == pytest.approx(share, rel=1e-9)


def test_the_command_line_looks_for_cycles_when_asked(tmp_path):
    words = ["stability", "mass_on_belt"]
    assert "attractors" not in read(*words, "--json")
    found = read(*words, "--cycles", "--json")["attractors"]
    assert found["attractors"][0]["kind"] == "cycle"
    assert "stick-slip cycle of 1.381 Hz" in call(*words, "--cycles").stdout
    call(*words, "--report", str(tmp_path), "--no-cycles")
    assert "Limit cycles" not in (tmp_path / "index.html").read_text(encoding="utf-8")
    call(*words, "--report", str(tmp_path))
    assert "Limit cycles" in (tmp_path / "index.html").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "stability.json").read_text(encoding="utf-8"))["schema"] == 1


def test_held_modes_and_a_search_for_cycles_do_not_go_together():
    words = ["stability", "mass_on_belt", "--mode", "contact=slip+", "--cycles"]
    assert "--mode" in call(*words, code=2).stderr
