"""The report's chapter on causality: every bond with its number, beside the drawing."""

from __future__ import annotations

import re

import pytest

from bondgraph import C, I, One, R, Se, Sf, Zero, assemble, models
from bondgraph.report import write_report
from bondgraph.stability import assess

from .. import showcase


def pair():
    v = One("v")
    return assemble("pair", Se("F", 1) >> v >> (I("a", 2), I("b", 3, initial=1), R("r", 1)))


GRAPHS = {
    "pair": pair,
    "quarter_car": models.quarter_car.graph,
    "cfield": showcase.cfield,
    "warm": showcase.warm,
    "sensed": showcase.sensed,
    "controlled": showcase.controlled,
    "mass_on_belt": models.mass_on_belt.graph,
}


def chapter(graph, folder):
    page = write_report(assess(graph), folder).read_text(encoding="utf-8")
    return page, re.search(r'<section id="causality">(.*?)</section>', page, re.DOTALL)[1]


def rows(text, caption=None):
    """Return the cells of each row of the table with a caption."""
    tables = re.findall(r"<table>(.*?)</table>", text, re.DOTALL)
    chosen = next(
        table
        for table in tables
        if (f"<caption><span>{caption}" in table if caption else "<caption>" not in table)
    )
    body = chosen.partition("<tbody>")[2]
    cells = [
        re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row) for row in re.findall(r"<tr>(.*?)</tr>", body)
    ]
    return [[re.sub("<.*?>", "", cell) for cell in row] for row in cells]


@pytest.mark.parametrize("name", sorted(GRAPHS))
def test_every_bond_has_its_row_and_its_number_in_the_drawing(name, tmp_path):
    graph = GRAPHS[name]()
    page, text = chapter(graph, tmp_path)
    table = rows(text)
    told = [(row[0], row[1].replace("&gt;", ">")) for row in table]
    assert told == [(str(k), bond.name) for k, bond in enumerate(graph.bonds, start=1)]
    numbers = re.findall(r'<text class="number"[^>]*>(\d+)</text>', text)
    assert sorted(map(int, numbers)) == list(range(1, len(graph.bonds) + 1))
    ids = re.findall(r'\bid="([^"]*)"', page)
    assert len(ids) == len(set(ids))


def test_dependent_storage_and_its_loop(tmp_path):
    _, text = chapter(pair(), tmp_path)
    assert "<p>Causality of 4 bonds; 1 of 2 storages dependent; 1 loop.</p>" in text
    (storage,) = rows(text, "Derivative causality")
    assert storage[:3] == ["b.p", "b.p = 3*v.f = 3*a.p/2", "a"]
    assert "one inertance of 5" in storage[4] and "initial value is not used" in storage[4]
    (loop,) = rows(text, "Variables that depend")
    assert loop[0] == "loop of dependent rates" and loop[2] == "linear, solved symbolically for a.e"


def test_junctions_say_who_decides(tmp_path):
    _, text = chapter(pair(), tmp_path)
    assert [row[:3] for row in rows(text, "The one bond")] == [["1\u00a0v", "flow", "a"]]


def test_modes(tmp_path):
    _, text = chapter(models.mass_on_belt.graph(), tmp_path)
    table = rows(text, "Modes")
    assert [row[0] for row in table] == ["slip", "stick"]
    assert table[0][1] == "all states are free" and "bound by" in table[1][1]


def test_disconnected_parts_are_listed(tmp_path):
    parts = [Sf(f"s{k}", 1) >> Zero(f"z{k}") >> (C(f"c{k}", 1), R(f"r{k}", 1)) for k in range(2)]
    _, text = chapter(assemble("two", parts), tmp_path)
    assert "<li>s0, z0, c0, r0</li><li>s1, z1, c1, r1</li>" in text
