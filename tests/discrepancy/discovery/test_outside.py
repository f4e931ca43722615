"""Advice of each verdict, in a few lines."""

import pytest

from bondgraph.discrepancy import discover

from .made import lacking, recorded

NOMINAL = lacking()


def told(graph, effects, columns=("x", "v"), noise=0.01):
    runs = [
        recorded(graph, seed, columns=columns, count=241, span=3.0, noise=noise) for seed in (0, 1)
    ]
    return discover(NOMINAL, *runs, effects=effects)


def test_of_a_class_the_signal_that_splits_it_is_advised():
    biased = lacking("sensor_bias", "output x", {"offset": 5e-3})
    both = told(biased, ("sensor_bias", "effort_bias", "quadratic_drag"), ("x",))
    assert both.verdict == "ambiguous" and len(both.advice) <= 4
    assert any({"sensor_bias at output x", "effort_bias at carriage"} <= set(c) for c in both.alike)
    first = both.advice[0]
    assert first.startswith("measure spring.q:")
    assert "sensor_bias at output x" in first and "effort_bias at carriage" in first


@pytest.mark.parametrize(
    ("effect", "values", "variable"),
    [
        ("quadratic_drag", {"drag": 25.0}, "flow"),
        ("cubic_stiffness", {"cubic": 4e5}, "displacement"),
    ],
)
def test_what_is_unnamed_has_its_place_and_what_it_depends_on(effect, values, variable):
    left = told(lacking(effect, values=values), ("effort_bias",))
    assert left.verdict == "unnamed"
    assert left.advice[0].startswith("what is missing acts at carriage")
    assert f"rises with the {variable}" in left.advice[0]


def test_what_is_named_needs_no_advice():
    named = told(lacking("quadratic_drag", values={"drag": 15.0}), ("quadratic_drag",))
    assert named.verdict == "named" and named.advice == ()
