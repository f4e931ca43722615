"""Cases: all effects, the same at every call, and nothing sealed in what may be seen."""

import json
from collections import Counter

import numpy as np
import pytest

from bondgraph.discrepancy import Measurement, sites
from bondgraph.discrepancy.candidates import EFFECTS

from . import files
from .entries import ENTRIES
from .machines import MACHINES
from .make import SEEN, made
from .plans import plans, subset
from .truth.laws import OUTSIDE


def plan_of(kind, machine="mass_spring", **wanted):
    return next(
        plan
        for plan in plans()
        if (plan.kind, plan.machine) == (kind, machine)
        and all(getattr(plan, key) == value for key, value in wanted.items())
    )


def test_all_effects_are_hidden_somewhere_and_nothing_outside_is_in_the_library():
    assert {entry.effect for entry in ENTRIES} == set(EFFECTS)
    assert not set(OUTSIDE) & set(EFFECTS)


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda e: f"{e.machine} {e.effect} {e.site}")
def test_right_answers_are_sites_of_the_model(entry):
    graph = MACHINES[entry.machine]()
    for effect, site in entry.right:
        assert site in {each.name for each in sites(graph, EFFECTS[effect])}
    if not entry.form:
        assert set(entry.values) - {"pace"} <= {c.name for c in EFFECTS[entry.effect].coefficients}


def test_the_list_has_all_kinds_and_opaque_ids():
    found = plans()
    assert 300 <= len(found) <= 400
    assert len({plan.id for plan in found}) == len(found)
    kinds = Counter(plan.kind for plan in found)
    assert set(kinds) == {"effect", "nothing", "wrong", "outside", "two", "low"}
    assert {plan.flaw for plan in found} == {"", "outliers", "gaps", "coarse", "zero"}
    assert {plan.excitations() for plan in found} == {
        ("multisine", "steps"),
        ("steps", "chirp"),
        ("chirp", "multisine"),
    }


def test_a_subset_keeps_the_proportions_and_is_always_the_same():
    few = subset(0.1)
    assert few == subset(0.1) and 30 <= len(few) <= 60
    assert {plan.kind for plan in few} == {plan.kind for plan in plans()}
    assert all(plan.machine == "rlc" for plan in subset(1.0, "rlc"))
    assert len(subset(1.0, few[0].id)) == 1


def test_a_case_is_made_alike_twice():
    plan = plan_of("effect", flaw="outliers")
    first, second = made(plan), made(plan)
    assert first.sealed == second.sealed
    for label, record in first.records.items():
        for name, column in record.columns.items():
            assert np.array_equal(column, second.records[label].columns[name], equal_nan=True)


def test_what_may_be_seen_tells_nothing(tmp_path):
    some = [
        plan_of("effect"),
        plan_of("outside"),
        plan_of("wrong"),
        plan_of("effect", flaw="zero"),
    ]
    for path, plan in zip(files.write(map(made, some), tmp_path), some, strict=True):
        assert sorted(p.name for p in path.iterdir()) == ["case.json", "train.csv", "validate.csv"]
        text = "".join(p.read_text() for p in path.iterdir()) + path.name
        for word in (*EFFECTS, *OUTSIDE, "sealed", "kind", *(e.site for e in plan.entries)):
            assert word not in text
        assert set(json.loads((path / "case.json").read_text())) <= {"model", "holds"}
    assert [row["id"] for row in files.unsealed(tmp_path)] == [plan.id for plan in some]


def test_recordings_read_back(tmp_path):
    case = made(plan_of("effect", flaw="gaps"))
    (path,) = files.write([case], tmp_path)
    run = Measurement.read(path / "train.csv")
    assert dict(run.units) == {"push": "N", "x": "m", "v": "m/s"}
    assert 0.02 < np.isnan(run.columns["x"]).mean() < 0.2
    x = case.records["train"].columns["x [m]"]
    there = ~np.isnan(x)
    assert run.columns["x"][there] == pytest.approx(x[there], rel=1e-8)


def test_noise_and_strength_are_as_sealed():
    case = made(plan_of("effect", noise=0.1))
    sealed, x = case.sealed, case.records["train"].columns["x [m]"]
    # a tenth of the signal's deviation, told from differences of neighbours
    assert np.std(np.diff(x, 3)) / np.sqrt(20) == pytest.approx(0.1 * np.std(x), rel=0.25)
    assert 0.05 <= sealed["share"] <= 0.6 and sealed["identifiable"] == (sealed["gain"] >= SEEN)


def test_an_effect_that_is_not_excited_leaves_nothing():
    for plan in plans():
        if plan.kind == "low":
            assert made(plan).sealed["gain"] < 5


def test_sites_that_no_signal_tells_apart_are_both_right():
    """A load on the motor's wheel is known from one on its rotor by the twist of the shaft only."""
    blurred = next(
        plan
        for plan in plans()
        if plan.machine == "free_motor" and plan.kind == "effect" and plan.noise == 0.2
    )
    sharp = plan_of("effect", "free_motor", noise=0.002)
    assert made(blurred).sealed["right"] == [
        [["viscous_damping", "wheel"], ["viscous_damping", "motor"]]
    ]
    assert made(sharp).sealed["right"] == [[["viscous_damping", "wheel"]]]
