"""Answers made by hand, judged and counted."""

import math

import pytest

from bondgraph.discrepancy.discovery import Gap

from . import judge, score
from .judge import judged
from .score import asked, by, by_noise, failures


def truth(kind="effect", right=(("coulomb_friction", "carriage"),), **more):
    hidden = [{"effect": n, "site": site, "values": {"level": 2.0}} for n, site in right[:1]]
    return {
        "id": "a1",
        "kind": kind,
        "machine": "mass_spring",
        "noise": 0.02,
        "hidden": hidden if kind == "effect" else [],
        "right": [[list(pair) for pair in right]] if right else [],
        "asked": [{"level": 2.0}] if kind == "effect" else [],
        "wrong": {},
        "flaw": "",
        "unmeasured": "",
        "identifiable": kind == "effect",
    } | more


def said(verdict, *pairs, level=(2.1, 0.1), **more):
    effects = [{"name": name, "site": site, "parameters": {"level": level}} for name, site in pairs]
    return {"id": "a1", "verdict": verdict, "effects": effects, "wall": 3.0} | more


COULOMB = ("coulomb_friction", "carriage")


def test_a_right_name_at_the_right_site():
    row = judged(truth(), said("named", COULOMB))
    assert row.named and row.placed and row.classed and not row.false and score.well(row)
    assert row.errors == pytest.approx((0.05,)) and row.covered == (True,)
    assert judged(truth(), said("named", COULOMB, level=(2.5, 0.1))).covered == (False,)


@pytest.mark.parametrize(
    ("answer", "named", "placed", "classed", "false"),
    [
        (said("named", ("quadratic_drag", "carriage")), False, True, False, True),
        (said("named", ("coulomb_friction", "second")), True, False, False, True),
        (said("named", COULOMB, ("sensor_bias", "output v")), False, True, False, True),
        (said("ambiguous", COULOMB, ("hysteresis", "carriage")), False, True, True, False),
        (said("ambiguous", COULOMB, ("coulomb_friction", "way")), True, True, True, False),
        (said("ambiguous", *[COULOMB] * 5), True, True, False, False),
        (said("unnamed", COULOMB), False, True, False, False),
        (said("none"), False, False, False, False),
        ({"id": "a1", "error": "over 120 s"}, False, False, False, False),
    ],
)
def test_kinds_of_answers(answer, named, placed, classed, false):
    row = judged(truth(), answer)
    assert (row.named, row.placed, row.classed, row.false) == (named, placed, classed, false)


def test_twins_are_right_and_pairs_have_no_order():
    right = (("quadratic_drag", "between first and second"), ("quadratic_drag", "way"))
    for site in ("between second and first", "way"):
        assert judged(truth(right=right), said("named", ("quadratic_drag", site))).classed


def test_two_effects_want_both():
    both = truth("two", right=(COULOMB,)) | {
        "right": [[list(COULOMB)], [["leakage", "chamber"]]],
        "identifiable": True,
    }
    assert judged(both, said("named", COULOMB, ("leakage", "chamber"))).named
    half = judged(both, said("named", COULOMB))
    assert not half.named and not half.placed and not half.false
    assert not judged(both, said("named", COULOMB, ("overflow", "chamber"))).named


def test_false_names():
    nothing = truth("nothing", right=())
    assert judged(nothing, said("named", COULOMB)).false
    assert judged(nothing, said("ambiguous", COULOMB)).false
    assert not judged(nothing, said("none")).false and score.well(judged(nothing, said("none")))
    wrong = truth("wrong", right=(("leakage", "node"),), wrong={"Rload": 0.6})
    assert not judged(wrong, said("named", ("leakage", "node"))).false
    assert judged(wrong, said("named", COULOMB)).false


def test_the_gap_is_that_of_the_contract():
    gap = Gap(nominal=5.0, before=3.0, after=1.5, noise_floor=1.0)
    told = {"gap": {"x": [gap.nominal, gap.before, gap.after, gap.noise_floor]}}
    assert judge.removed(told) == pytest.approx(gap.removed)
    assert math.isnan(judge.removed({"gap": {"x": [1.0, 0.9, 0.9, 1.0]}}))


def test_counts():
    good, bad = said("named", COULOMB), said("named", ("quadratic_drag", "carriage"))
    rows = [judged(truth(), good)] * 3 + [judged(truth(), bad)]
    rows += [judged(truth("nothing", right=()), said("none"))] * 2
    rows += [judged(truth("outside", right=()), said("unnamed"))]
    table = {row[0]: row[1:] for row in asked(rows).rows}
    assert table["element named right at 2.0% noise"] == ["4", "75%", "at least 90%", "no"]
    assert table["site right"][:2] == ["4", "100%"]
    assert table["false names, nothing missing"] == ["2", "0%", "at most 5%", "yes"]
    assert table["unnamed, effect outside the library"][:2] == ["1", "100%"]
    assert table["coefficients within 10 %"][:2] == ["3", "100%"]
    assert table["seconds a case, worst"][1:3] == ["3.0", "at most 30 s"]
    (row,) = failures(rows).rows
    assert row[:2] == ["a1", "effect"] and row[-1] == "named: quadratic_drag at carriage"
    assert by(rows, "machine").rows == [["mass_spring", "4", "3", "4", "3", "3.0"]]
    assert ["effect", "2.0%", "4", "3", "4", "0", "0", "0", "0"] in by_noise(rows).rows
