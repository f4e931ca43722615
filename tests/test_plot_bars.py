"""Bars and damping maps: what they show is what closed forms say."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, assemble, eigenvalue_map, plot
from bondgraph.models import bicycle_brake
from bondgraph.stability import Vary, assess, follow_edge

m, k, b = sympy.symbols("m k b", positive=True)
GRAPH = assemble(
    "oscillator",
    One("v") >> (I("mass", m), C("spring", stiffness=k), R("damper", b)),
    parameters={m: (2, "kg"), k: (8, "N/m"), b: (0.5, "N*s/m")},
)


@pytest.fixture(scope="module")
def result():
    return assess(GRAPH)


def lengths(ax):
    names = [text.get_text() for text in ax.get_yticklabels()]
    return {name: patch.get_width() for name, patch in zip(names, ax.patches, strict=False)}


def test_feeds_are_those_of_a_damper(result):
    ax = plot.feed_bars(result.critical)
    assert lengths(ax) == {"damper": pytest.approx(-0.5 / 4)}
    assert ax.patches[0].get_facecolor()[:3] == pytest.approx((0, 0x72 / 255, 0xB2 / 255))


def test_shares_are_halves(result):
    ax = plot.share_bars(result.critical)
    assert [patch.get_width() for patch in ax.patches[:2]] == pytest.approx([50, 50], rel=0.02)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [
        "takes part",
        "holds energy",
    ]


def test_slopes_are_those_of_b_over_2m(result):
    index = result.rows.index(result.critical)
    ax = plot.sensitivity_bars(result.sensitivities.ranked(index, by="growth"), 0.1)
    assert lengths(ax) == {"b": pytest.approx(-0.0125), "m": pytest.approx(0.0125)}


def test_names_of_many_parameters_do_not_overlap():
    symbols = sympy.symbols("b:20", positive=True)
    parts = [R(f"damper{j}", symbol) for j, symbol in enumerate(symbols)]
    table = {symbol: (0.01 * (j + 1), "N*s/m") for j, symbol in enumerate(symbols)}
    graph = assemble("many", One("v") >> (I("m", 1), C("k", stiffness=9), *parts), parameters=table)
    ax = plot.sensitivity_bars(assess(graph, span=None).sensitivities.ranked(0, by="growth"))
    ax.figure.canvas.draw()
    boxes = [text.get_window_extent() for text in ax.get_yticklabels()]
    assert len(boxes) == 12
    assert all(low.y1 <= high.y0 for high, low in itertools.pairwise(boxes))


def test_least_damping_is_the_textbooks_ratio():
    axes = {"k": np.linspace(2, 20, 7), "b": np.linspace(0.1, 20, 9)}
    found = eigenvalue_map(GRAPH, axes, product=True)
    expected = np.minimum(found.points["b"] / (2 * np.sqrt(2 * found.points["k"])), 1)
    assert plot.least_damping(found) == pytest.approx(expected)
    cells = plot.damping_map(found).collections[0].get_array()
    assert np.ma.getdata(cells).ravel() == pytest.approx(100 * found.on_grid(expected).T.ravel())


def test_a_followed_boundary_takes_the_place_of_the_one_between_the_points():
    graph, ranges = bicycle_brake.graph(), (Vary("V0", 0.3, 1.5, 30), Vary("v_s", 0.05, 0.3, 30))
    axes = {item.name: np.linspace(item.lo, item.hi, item.n) for item in ranges}
    found = eigenvalue_map(graph, axes, product=True)
    edge = assess(graph, {"v_s": 0.2}, vary=[ranges[0]], span=None).edges[0]
    curve = follow_edge(graph, edge, *ranges, {"v_s": 0.2})
    for draw in (plot.damping_map, plot.stability_map):
        ax = draw(found, boundaries=[curve], at={"V0": 0.9, "v_s": 0.2})
        labels = [line.get_label() for line in ax.lines]
        assert "_b" in labels and "_edge" not in labels
        line = next(line for line in ax.lines if line.get_label() == "_b")
        x, y = line.get_xydata()[np.isfinite(line.get_xydata()).all(axis=1)].T
        assert x == pytest.approx(y * np.log(225 / (y * 7.137493)), rel=1e-5)
        cross = ax.lines[-1]
        assert (cross.get_xdata()[0], cross.get_ydata()[0]) == pytest.approx((0.9, 0.2))
        assert [line.get_label() for line in draw(found).lines] == ["_edge"]
        beyond = draw(found, at={"V0": 9.0, "v_s": 0.2})
        assert "_operating point" not in [line.get_label() for line in beyond.lines]


def test_a_map_without_oscillation_has_its_frame():
    graph = assemble(
        "slow",
        One("v") >> (I("mass", m), R("damper", b)),
        parameters={m: (1, "kg"), b: (1, "N*s/m")},
    )
    found = eigenvalue_map(
        graph, {"m": np.linspace(1, 2, 4), "b": np.linspace(1, 3, 5)}, product=True
    )
    ax = plot.stability_map(found)
    assert (ax.get_xlim(), ax.get_ylim()) == ((1, 2), (1, 3))
    assert plot.least_damping(found) == pytest.approx(1)
