"""JSON: the schema as documented, for every model."""

from __future__ import annotations

import json

import pytest

from bondgraph import Se, derive, models, report_causality, text
from bondgraph.causality_report import to_json
from bondgraph.models import LIBRARY

from .. import showcase

GRAPHS = {name: getattr(models, name).graph for name in LIBRARY} | showcase.GRAPHS
WORDS, WORD, MAYBE, YES_NO = "list of str", "str", "str or null", "bool"

SCHEMA = {
    "bonds": {
        "bond": WORD,
        "tail": WORD,
        "head": WORD,
        "effort_out_of": WORD,
        "flow_out_of": WORD,
        "stroke_at": WORD,
        "reason": {"source", "integral", "derivative", "law", "arbitrary", "propagated"},
        "because": WORD,
    },
    "junctions": {
        "junction": WORD,
        "kind": {"0", "1"},
        "shared": {"effort", "flow"},
        "bond": WORD,
        "decided_by": WORD,
        "because": WORD,
        "followers": WORDS,
    },
    "storages": {
        "storage": WORD,
        "kind": {"C", "I"},
        "state": WORD,
        "causality": {"integral", "derivative"},
        "bond": WORD,
        "because": WORD,
        "constraint": MAYBE,
        "expanded": MAYBE,
        "bound_by": WORDS,
        "done": WORD,
        "initial_unused": YES_NO,
    },
    "reductions": {
        "storage": WORD,
        "carried": WORDS,
        "quantity": {"inertance", "capacitance"},
        "value": WORD,
    },
    "loops": {
        "kind": {"algebraic loop", "loop of dependent rates"},
        "variables": WORDS,
        "tearing": WORDS,
        "solved": {"linear", "algebraic"},
        "remedy": WORD,
    },
    "signals": {"from": WORD, "to": WORD},
    "input_rates": {"input": WORD, "rate": WORD},
    "modes": {
        "modes": "object",
        "bound": [{"state": WORD, "value": MAYBE, "bound_by": WORDS, "because": WORD}],
        "algebraic": WORDS,
        "impossible": MAYBE,
    },
}


def check(value, wanted):
    if isinstance(wanted, set):
        assert value in wanted
    elif isinstance(wanted, dict):
        assert list(value) == list(wanted)
        for key, inner in wanted.items():
            check(value[key], inner)
    elif isinstance(wanted, list):
        for item in value:
            check(item, wanted[0])
    elif wanted == WORDS:
        assert isinstance(value, list) and all(isinstance(item, str) for item in value)
    elif wanted == "object":
        assert all(isinstance(item, str) for pair in value.items() for item in pair)
    else:
        kinds = {WORD: str, MAYBE: str | None, YES_NO: bool}
        assert isinstance(value, kinds[wanted])


@pytest.mark.parametrize("name", sorted(GRAPHS))
def test_schema(name):
    graph = GRAPHS[name]()
    found = json.loads(json.dumps(to_json(report_causality(graph)), allow_nan=False))
    assert found.pop("schema") == 1 and found.pop("model") == graph.name
    assert isinstance(found.pop("possible_modes"), int)
    assert all(isinstance(name, str) for part in found.pop("parts") for name in part)
    assert all(isinstance(line, str) for line in found.pop("turned"))
    assert set(found) == set(SCHEMA)
    for key, items in found.items():
        check(items, [SCHEMA[key]])


@pytest.mark.parametrize("name", sorted(GRAPHS))
def test_equations_json_keeps_its_contract_and_adds_beside(name):
    graph = GRAPHS[name]()
    found = json.loads(json.dumps(text.to_json(derive(graph)), allow_nan=False))
    contract = ["states", "algebraic", "inputs", "parameters", "causality", "warnings"]
    assert set(contract) <= set(found)
    for row, bond in zip(found["causality"], graph.bonds, strict=True):
        assert {"bond", "effort_out_of", "reason"} <= set(row) and row["bond"] == bond.name
    for key in ("storages", "reductions", "loops", "signals", "input_rates"):
        check(found[key], [SCHEMA[key]])


def test_names_are_those_of_the_elements():
    shown = to_json(report_causality(showcase.clutch()))
    assert shown["modes"][1]["bound"][0]["value"] == "2*j1.p"
    assert shown["modes"][1]["modes"] == {"plates": "stick"}
    sources = [name for name, _ in showcase.clutch().of(Se)]
    assert [b["effort_out_of"] for b in shown["bonds"] if b["reason"] == "source"] == sources
