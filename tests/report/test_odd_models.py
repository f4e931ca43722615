"""Reports on models that have little to report: few states, free ones, equal ones, algebraic ones."""

from __future__ import annotations

import re

import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, Se, Sf, Zero, assemble
from bondgraph.errors import ParameterError
from bondgraph.models import mass_on_belt
from bondgraph.report import plane, stability_planes, write_report
from bondgraph.stability import Vary, assess
from tests.pages import Page

k, b, m = sympy.symbols("k b m", positive=True)
OVER_M, OVER_B = Vary("m", 0.5, 2, 12), Vary("b", 0.5, 5, 10)


def free(name, *parts, parameters):
    return assemble(name, One("v") >> parts, parameters=parameters)


def one_state():
    return free("one", I("m", m), R("d", b), parameters={m: (1, "kg"), b: (4, "N*s/m")})


def no_state():
    force = {m: (1, "N*s/m"), b: (4, "N")}
    return assemble("none", Se("e", b) >> One("v") >> R("d", m), parameters=force)


def undamped():
    parts = (I("m", m), C("c", stiffness=b))
    return free("undamped", *parts, parameters={m: (1, "kg"), b: (4, "N/m")})


def twice():
    pairs = [Se(f"f{j}", 1) >> One(f"v{j}") >> (I(f"m{j}", m), R(f"d{j}", b)) for j in range(2)]
    return assemble("twice", *pairs, parameters={m: (1, "kg"), b: (4, "N*s/m")})


def algebraic():
    law = R("odd", effort=lambda f: f + m * f**3)
    loop = Se("e", 2) >> One("v") >> (law, C("c", capacitance=b))
    return assemble("algebraic", loop, parameters={m: (1, "ohm*s^2/C^2"), b: (4, "F")})


def soft():
    damper = R("d", effort=lambda f: (1 - b) * f + m * f**3)
    parts = (I("i", 1), C("c", stiffness=4), damper)
    return free("soft", *parts, parameters={m: (1, ""), b: (0.5, "")})


SAID = {
    one_state: ["without oscillation", "Nothing oscillates"],
    no_state: ["Without states nothing can move"],
    undamped: ["neither grows nor decays", "Nothing feeds or drains this mode"],
    twice: ["cannot be told by slopes", "eigenvalues that stand together"],
    algebraic: ["without oscillation", "Nothing oscillates"],
    soft: ["begin, soft", "onset"],
}


@pytest.mark.parametrize("graph", SAID, ids=lambda graph: graph.__name__)
def test_a_report_on(graph, tmp_path):
    vary = [] if graph is no_state else [OVER_M, OVER_B]
    result = assess(graph(), vary=vary)
    path = write_report(result, tmp_path, maps=stability_planes(result, [(OVER_M, OVER_B)]))
    page = Page(path.read_text(encoding="utf-8"))
    for words in (*SAID[graph], *result.verdict.splitlines(), *result.reasons):
        assert words in page.text, words
    assert not re.search(r"\b(nan|inf)\b", page.text)
    assert len(page.ids) == len(set(page.ids))
    assert "120 points" in page.text


def test_a_report_is_the_same_to_the_byte(tmp_path):
    pages = []
    for folder in ("a", "b"):
        result = assess(mass_on_belt.graph(), vary=["v_b=0.1:0.6:20"])
        maps = [plane(result, Vary("v_b", 0.1, 0.6, 20), Vary("c", 0, 2, 20))]
        pages.append(write_report(result, tmp_path / folder, maps=maps))
    first, second = (
        {path.name: path.read_bytes() for path in sorted(page.parent.rglob("*")) if path.is_file()}
        for page in pages
    )
    assert first == second and len(first) > 10


def test_maps_take_units_and_refuse_one_name_twice():
    result = assess(mass_on_belt.graph())
    across = Vary("k", 0.05, 0.2, 7, "N/mm")
    found = plane(result, across, Vary("v_b", 0.6, 0.1, 300))
    assert found.points.shape == (7, 200)
    assert found.points.axes["k"] == pytest.approx(np.linspace(50, 200, 7))
    with pytest.raises(ParameterError, match="two different names"):
        plane(result, across, across)
    with pytest.raises(ParameterError, match="kg"):
        plane(result, Vary("k", 1, 2, 5, "kg"), Vary("v_b", 0.1, 0.6, 5))


def test_boundaries_are_the_same_followed_by_the_assessment_or_for_the_map():
    ranges = (Vary("v_b", 0.1, 0.8, 15), Vary("c", 0.05, 2, 15))
    alone = plane(assess(mass_on_belt.graph()), *ranges)
    result = assess(mass_on_belt.graph(), vary=ranges, planes=[("v_b", "c")])
    given = plane(result, *ranges)
    assert given.boundaries == result.boundaries and len(alone.boundaries) == 1
    for curve in (*given.boundaries, *alone.boundaries):
        speed, damping = curve.values.T
        # N (mu_s - mu_k)/v_s e^(-v_b/v_s) is the damper's c
        assert damping == pytest.approx(10 * 0.15 / 0.1 * np.exp(-speed / 0.1), rel=1e-6)


@pytest.mark.filterwarnings("error::UserWarning")  # matplotlib's, where a plot has no room left
def test_a_long_chain_keeps_a_page_that_can_be_read(tmp_path):
    count = 20
    stiff, heavy = (sympy.symbols(f"{letter}0:{count}", positive=True) for letter in "km")
    bonds, before = [], Zero("z0")
    bonds.append(Sf("ground", 0) >> before)
    for j in range(count):
        body, after = One(f"v{j}"), Zero(f"z{j + 1}")
        bonds.append(before >> C(f"c{j}", stiffness=stiff[j]))
        bonds.append(before >> body >> (I(f"i{j}", heavy[j]), R(f"r{j}", b)))
        if j < count - 1:
            bonds.append(body >> after)
        before = after
    table = {symbol: (1e4 + 10 * j, "N/m") for j, symbol in enumerate(stiff)}
    table |= {symbol: (1 + 0.01 * j, "kg") for j, symbol in enumerate(heavy)}
    graph = assemble("chain", *bonds, parameters={**table, b: (2, "N*s/m")})
    result = assess(graph, vary=["b=0.5:5:20"], span=None)
    path = write_report(result, tmp_path)
    page = Page(path.read_text(encoding="utf-8"))
    assert "The state matrix, 40 x 40, stands in stability.json" in page.text
    assert "The 25 strongest of 41." in page.text
    rows = (tmp_path / "plots" / "sensitivities.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) == 1 + 41
