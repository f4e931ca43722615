"""Recordings made ready: SI, noise, gaps, and what is held out."""

import numpy
import pytest

from bondgraph.discrepancy import Measurement
from bondgraph.discrepancy.discovery.prepare import HELD_OUT, distinct, held_out, prepared
from bondgraph.errors import MeasurementError

from .made import lacking, recorded

GRAPH = lacking()
RUN = recorded(GRAPH)


def test_columns_are_in_si_and_the_noise_is_what_was_added():
    milli = Measurement(
        RUN.t,
        {"push": RUN.columns["push"], "x": 1e3 * RUN.columns["x"], "v": RUN.columns["v"]},
        {"x": "mm"},
    )
    ready, _ = prepared(milli, GRAPH)
    assert ready.signals == ("x", "v")
    assert numpy.allclose(ready.plain.columns["x"], RUN.columns["x"])
    for name in ready.signals:
        added = 0.01 * numpy.std(RUN.columns[name])
        assert ready.noise[name] == pytest.approx(added, rel=0.25)


def test_gaps_stay_gaps_and_missing_signals_are_gaps_throughout():
    v = RUN.columns["v"].copy()
    v[50:80] = numpy.nan
    ready, _ = prepared(Measurement(RUN.t, {"push": RUN.columns["push"], "v": v}), GRAPH)
    record = ready.record(["x", "v"])
    assert numpy.isnan(record.measured[:, 0]).all()
    assert numpy.flatnonzero(numpy.isnan(record.measured[:, 1])).tolist() == list(range(50, 80))


def test_too_few_values_are_refused_by_name():
    x = numpy.full(len(RUN.t), numpy.nan)
    x[:9] = 0.0
    with pytest.raises(MeasurementError, match=r"run 7.*'x'.*ten"):
        prepared(Measurement(RUN.t, {"push": RUN.columns["push"], "x": x}, name="run 7"), GRAPH)


def test_the_last_of_several_is_held_out():
    rows = [RUN, RUN.changed(name="b"), RUN.changed(name="c")]
    train, test, words = held_out(rows)
    assert train == rows[:2] and test == rows[2:]
    assert words.startswith("c is held out")


def test_the_end_of_the_only_one_is_held_out():
    (first,), (last,), words = held_out([RUN])
    assert f"{HELD_OUT:.0%}" in words and RUN.name in words
    assert first.t[0] == RUN.t[0] and last.t[-1] == RUN.t[-1]
    assert abs(len(last) - HELD_OUT * len(RUN)) <= 1
    assert first.t[-1] <= last.t[0]


def test_names_stay_where_they_differ_and_are_numbered_where_not():
    names = ["a", "b", "a", "a 1", "a"]
    rows = distinct([RUN.changed(name=name) for name in names])
    assert [row.name for row in rows] == ["a 2", "b", "a 3", "a 1", "a 4"]
