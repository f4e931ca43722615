"""The page: complete for each verdict, self-contained, escaped, in agreement with its value."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape

import numpy as np
import pytest

from bondgraph.discrepancy import EFFECTS
from bondgraph.discrepancy.discovery import Course, Estimate, Gap
from bondgraph.discrepancy.report import write_report
from bondgraph.discrepancy.report.words import headline
from tests.discrepancy.report import made
from tests.pages import Page

FOUND = {
    "named": ["What was found"],
    "ambiguous": ["What it may be"],
    "unnamed": ["The nearest of the known effects"],
    "nothing": [],
}


def titles(text):
    return re.findall(r"<h2>(.*?)</h2>", text)


def cells(text, first):
    """Return the cells of the rows whose first cell is a word."""
    rows = re.findall(rf'<tr><th scope="row"[^>]*><code>{first}</code></th>(.*?)</tr>', text)
    return [[re.sub("<.*?>", "", cell) for cell in re.findall(r"<td.*?</td>", row)] for row in rows]


@pytest.fixture(scope="module", params=sorted(made.VERDICTS))
def report(request, tmp_path_factory):
    found = made.VERDICTS[request.param]()
    written = write_report(found, tmp_path_factory.mktemp("report"))
    text = written.page.read_text(encoding="utf-8")
    return request.param, found, written, text, Page(text)


def test_the_page_stands_alone(report):
    _, _, written, text, page = report
    assert re.findall(r"https?:|//[a-z]|@import|url\((?!#)", text) == []
    assert page.tags.isdisjoint({"script", "link", "img", "iframe", "object"})
    assert len(page.ids) == len(set(page.ids))
    for link in page.links:
        if link.startswith("#"):
            assert link[1:] in page.ids, link
        else:
            assert (written.page.parent / link).is_file(), link


def test_chapters_follow_the_verdict(report):
    name, found, _, text, page = report
    assert titles(text) == [
        *FOUND[name],
        "How far the model is off",
        "Measured against model",
        "What is left",
        *(["The law in the data"] if found.laws else []),
        "The improved model" if name == "named" else "The model",
        "The model&#x27;s own parameters",
        "What else was tried",
        "What the data cannot tell",
        "What these data cannot tell apart",
        "What to measure next",
        "Warnings",
        "What was done",
    ]
    assert page.text.index(headline(found)) < page.text.index(found.words[0])
    assert page.text.index(found.words[1]) < page.text.index("How far the model is off")
    for line in (*found.words, *found.unseen, *found.advice, *found.warnings):
        assert line in page.text
    assert all(", ".join(members) in page.text for members in found.alike)


def test_effects_stand_with_site_parameters_law_and_source(report):
    name, found, _, text, page = report
    if name == "nothing":
        assert "formulas" not in re.sub("<style>.*?</style>", "", text, flags=re.DOTALL)
        assert "Blue" not in page.text
        return
    (effect, *_) = found.effects
    row = cells(text, "coulomb_friction")[0]
    assert row[:2] == ["carriage", effect.element] and float(row[2]) == effect.delta_bic
    assert "Karnopp" in row[4]
    _, value, std, unit, meaning = cells(text, "level")[0]
    level = effect.parameters["level"]
    assert float(value) == pytest.approx(level.value, abs=level.std / 10) and unit == "N"
    assert float(std) == pytest.approx(level.std, rel=0.06) and "friction" in meaning
    assert "math" in page.tags and "level" in page.text


def test_what_the_data_do_not_tell_is_no_number(report):
    name, _, _, text, _ = report
    if name == "ambiguous":
        assert cells(text, "damping")[0][1:3] == ["3.1", "not told"]
    assert ">nan<" not in text and ">inf<" not in text


def test_reasons_not_to_name_are_told(report):
    name, found, _, _, page = report
    for item in found.ranked:
        for reason in item.failed:
            assert reason in page.text
    assert ("Do not take them for the cause" in page.text) == (name == "unnamed")


def test_the_gap_table_holds_the_gaps(report):
    name, found, _, text, _ = report
    for signal in ("x", "v"):
        for kind, row in zip(("train", "validation"), cells(text, signal), strict=True):
            gap = found.gap[kind][signal]
            assert row[:2] == [{"train": "learned from", "validation": "held out"}[kind], gap.unit]
            expected = [gap.nominal, gap.before, gap.after, gap.noise_floor, 100 * gap.removed]
            if name == "nothing":
                expected = [gap.nominal, gap.before, gap.noise_floor]
            numbers = [float(cell.replace("%", "")) for cell in row[2:]]
            assert numbers == pytest.approx(expected, rel=6e-3)


def test_parameters_stand_as_given_and_as_fitted(report):
    _, found, _, text, _ = report
    given, fitted, std, unit, change, shifted = cells(text, "b")[0]
    b = found.parameters["b"]
    assert (float(given), unit) == (4.0, "N·s/m")
    assert float(fitted) == pytest.approx(b.value, rel=1e-3)
    assert float(std) == pytest.approx(b.std, rel=0.06)
    assert change == f"+{100 * (b.value / 4 - 1):.0f} %"
    assert float(shifted) == pytest.approx((b.value - 4) / b.std, rel=0.06)


def test_new_elements_are_blue_and_the_diff_is_told(report):
    name, found, _, text, page = report
    drawing = re.search(r'<div class="drawing">.*?</svg>', text, re.DOTALL)[0]
    assert ("#0b57d0" in drawing) == (name != "nothing")
    if name != "nothing":
        assert found.diff[0] in page.text
        # the value that was fitted stands in the place of the one it started from
        (line,) = re.findall(r"\+ parameter &#x27;coulomb_friction_level&#x27; = (\S+) N", text)
        level = found.effects[0].parameters["level"].value
        assert float(line) == pytest.approx(level, rel=1e-5) and level != pytest.approx(0.1)


def test_every_plot_is_described_and_has_files(report):
    name, _, written, text, _ = report
    shown = re.findall(r'<svg [^>]*role="img" aria-label="([^"]+)"', text)
    assert len(shown) == len(written.plots) + 1  # and the drawing
    stems = {path.stem for path in written.plots}
    courses = {
        f"{kind}-{s}{z}" for kind in ("train", "validation") for s in "xv" for z in ("", "-close")
    }
    left = {f"left-{s}-{z}" for s in "xv" for z in ("time", "spectrum")}
    law = {"law-1-coulomb_friction-at-carriage"} if name != "nothing" else set()
    assert stems == courses | left | law | {"gap-train", "gap-validation"}
    for path in written.plots:
        assert path.is_file() and path.with_suffix(".csv").stat().st_size > 20
    captions = re.findall(r"<figcaption>(.*?)</figcaption>", text)
    assert captions and all(len(caption) > 60 for caption in captions)


def odd():
    """Nothing held out, runs that failed, a signal without a value, numbers that are none."""
    t = np.arange(400.0) ** 1.1
    nothing, wave = np.full(400, np.nan), np.sin(t / 20)
    part = np.where(t < 100, wave, np.nan)
    course = Course(
        "a b/c",
        t,
        {"v": nothing, "x": part, "y z": wave},
        {"v": nothing, "x": nothing, "y z": np.full(400, np.inf)},
        {"v": nothing, "x": wave, "y z": part},
        {"v": np.nan, "x": 0.0},
        {},
    )
    gaps = {
        "v": Gap(np.nan, np.inf, np.nan, 0.0),
        "x": Gap(1.0, 1.0, 1.0, np.nan),
        "y z": Gap(0.0, 0.0, 0.0, 0.0),
    }
    return replace(
        made.named(),
        train=(course,),
        validation=(),
        held_out=(),
        gap={"train": gaps, "validation": {}},
        laws=(),
        parameters={"k": Estimate(0.0, np.inf), "b": Estimate(np.nan, np.nan)},
        nominal={},
        words=(),
    )


@pytest.mark.filterwarnings("error")
def test_what_is_missing_leaves_no_hole(tmp_path):
    written = write_report(odd(), tmp_path)
    page = Page(written.page.read_text(encoding="utf-8"))
    assert "No recording was held out" in page.text and "nothing was held out" in page.text
    assert "nan" not in page.text.split() and "inf" not in page.text.split()
    stems = {path.stem for path in written.plots}
    assert "train-x" in stems and "train-y-z" in stems and "train-v" not in stems


@pytest.mark.filterwarnings("error")
def test_nothing_at_all_is_still_a_page(tmp_path):
    bare = {"train": (), "validation": (), "ranked": (), "recordings": (), "held_out": ()}
    told = {
        "words": (),
        "unseen": (),
        "advice": (),
        "alike": (),
        "warnings": (),
        "gap": {},
        "parameters": {},
    }
    written = write_report(replace(made.nothing(), **bare, **told), tmp_path)
    text = written.page.read_text(encoding="utf-8")
    assert titles(text) == ["How far the model is off", "The model", "What was done"]
    assert "nothing missing" in Page(text).text


def test_many_signals_are_in_the_tables_and_the_worst_are_drawn(tmp_path):
    t = np.linspace(0, 10, 200)
    names = [f"s{k}" for k in range(9)]
    measured = {name: np.sin(t) for name in names}
    before = {name: (1 - 0.1 * k) * np.sin(t) for k, name in enumerate(names)}
    course = Course("run", t, measured, before, measured, dict.fromkeys(names, 0.01), {})
    gap = dict.fromkeys(names, Gap(1, 1, 1, 1))
    found = replace(made.named(), train=(course,), validation=(), gap={"train": gap})
    text = write_report(found, tmp_path).page.read_text(encoding="utf-8")
    assert "Not drawn, in the tables and files: s0, s1, s2." in text
    assert all(cells(text, name) for name in names)


def test_whatever_comes_from_outside_is_escaped(tmp_path):
    evil = "<script>alert('x')</script>&<b>"
    found = made.named()
    effect = replace(found.effects[0], name=evil, element=evil, site=evil, words=evil)
    chosen = replace(found.chosen, effects=(effect,), failed=(evil,), diff=(evil,))
    train = replace(
        found.train[0],
        name=evil,
        measured={evil: found.train[0].measured["v"]},
        before={evil: found.train[0].before["v"]},
        after={evil: found.train[0].after["v"]},
        noise={evil: 1e-3},
        units={evil: evil},
    )
    law = replace(found.laws[0], effect=evil, across=evil, along=evil, units=(evil, evil))
    told = dict.fromkeys(("words", "unseen", "advice", "warnings"), (evil,))
    told["alike"] = ((evil, evil),)
    dirty = replace(
        found,
        effects=(effect,),
        chosen=chosen,
        ranked=(chosen,),
        train=(train,),
        validation=(train,),
        laws=(law,),
        gap={"train": {evil: replace(found.gap["train"]["v"], unit=evil)}},
        parameters={evil: Estimate(1.0, 0.1, evil)},
        recordings=(found.recordings[0].changed(name=evil),),
        **told,
    )
    page = Page(write_report(dirty, tmp_path).page.read_text(encoding="utf-8"))
    assert page.tags.isdisjoint({"script", "b"}) and evil in page.text


def test_every_known_effect_has_formula_letters_and_source(tmp_path):
    found = made.plain(made.named())
    effects = tuple(replace(found.effects[0], name=name, words="") for name in EFFECTS)
    text = write_report(replace(found, effects=effects), tmp_path).page.read_text(encoding="utf-8")
    page = Page(text)
    assert text.count("<math ") == sum(len(effect.law) for effect in EFFECTS.values())
    for effect in EFFECTS.values():
        assert effect.meaning in page.text and effect.reference in page.text
    (letters,) = re.findall(r'<p class="note">(f: flow.*?)</p>', text)
    assert [part.split(":")[0] for part in unescape(letters).split("; ")] == list("feqpuz")
