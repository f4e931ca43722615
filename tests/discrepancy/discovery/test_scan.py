"""Scans of stops, on a distance that can be written down."""

import math
from types import SimpleNamespace

import pytest

from bondgraph.discrepancy.candidates import EFFECTS
from bondgraph.discrepancy.discovery import scan

NAMES = {key: f"end_stop_{key}" for key in ("upper", "lower", "restitution", "rest")}
BEST = {"end_stop_upper": 1.1, "end_stop_lower": 0.9, "end_stop_restitution": 0.45}


def off(values):
    """A distance in steps, as that of impacts is: slopes tell nothing."""
    return sum(math.ceil(20 * abs(math.log(values[name] / best))) for name, best in BEST.items())


def nearest(model, rows, bench, starts):
    found = min(starts, key=off)
    return dict(found), float(off(found))


@pytest.fixture
def scanned(monkeypatch):
    monkeypatch.setattr(scan, "nearest", nearest)

    def run(effect, start, seconds=60.0):
        draft = SimpleNamespace(
            added=[SimpleNamespace(effect=EFFECTS[effect])],
            grafts=[SimpleNamespace(parameters=NAMES)],
        )
        return scan.scanned(None, (), None, draft, start, seconds)

    return run


START = {"k": 2.0, **dict.fromkeys(BEST, 1.0), "end_stop_rest": 0.01}


def test_each_coefficient_goes_where_the_run_is_nearest(scanned):
    found = scanned("end_stop", {**START, "end_stop_restitution": 0.5})
    for name, best in BEST.items():
        assert found[name] == pytest.approx(best, rel=0.05)
    assert found["k"] == 2.0 and found["end_stop_rest"] == 0.01  # own and numerical ones stay


def test_what_has_no_impacts_is_left_as_it_is(scanned):
    assert scanned("coulomb_friction", START) == START


def test_no_time_no_change(scanned):
    assert scanned("end_stop", START, seconds=-1.0) == START
