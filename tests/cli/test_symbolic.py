"""``bondgraph symbolic``: the three forms, and one line for what goes wrong."""

from __future__ import annotations

import json
import re

import pytest
import sympy
from click.testing import CliRunner

from bondgraph.cli import main

SLIDING = ["mass_on_belt", "--mode", "contact=slip+", "--at", "mass.p=0"]


def call(*words, code=0):
    done = CliRunner().invoke(main, ["symbolic", *words], prog_name="bondgraph")
    assert done.exit_code == code, done.output + done.stderr
    return done


def test_text():
    shown = call("quarter_car", "--routh", "--transfer", "v_body:v_road").stdout
    for heading in ("State equations", "A, of rates", "Characteristic polynomial", "Poles"):
        assert heading in shown
    assert "m_s*m_u*s^4" in shown and "at s = 0: 1" in shown
    assert shown.rstrip().endswith("b_s > 0")


def test_json_holds_the_contract():
    found = json.loads(call(*SLIDING, "--routh", "--transfer", "mass.f:v_b", "--json").stdout)
    assert found["schema"] == 1 and found["model"] == "mass_on_belt"
    assert [row["name"] for row in found["states"]] == ["mass.p", "spring.q"]
    assert len(found["A"]) == 2 and len(found["B"]) == 2 and found["inputs"] == ["v_b"]
    m, k = sympy.symbols("m k")
    names = {"m": m, "k": k, "N": sympy.Symbol("N")}
    monic = [sympy.sympify(item, names) for item in found["characteristic_polynomial"]]
    assert monic[0] == 1 and sympy.simplify(monic[2] - k / m) == 0
    assert found["routh_hurwitz"]["status"] == "conditional"
    assert len(found["routh_hurwitz"]["conditions"]) == 1 and len(found["poles"]) == 2
    (transfer,) = found["transfer"]
    assert transfer["output"] == "mass.f" and transfer["dcgain"] == "0"


def test_latex():
    shown = call(*SLIDING, "--routh", "--transfer", "x:v_b", "--format", "latex").stdout
    assert shown.count(r"\begin{align*}") == shown.count(r"\end{align*}") == 2
    assert r"\dot{p}_{\mathrm{mass}}" in shown and r"\mu_{k}" in shown


def test_numbers_and_expressions_for_symbols():
    words = ["--at", "spring.q=N*mu_k/k", "--set", "mu_s=0.25", "--set", "mu_k=0.25", "--routh"]
    found = json.loads(call(*SLIDING, *words, "--json").stdout)
    assert found["at"]["spring.q"] == "N*mu_k/k" or found["at"]["spring.q"] == "N/(4*k)"
    assert found["routh_hurwitz"]["conditions"] == ["c"]


def test_what_has_no_closed_form_is_told():
    found = json.loads(call("quarter_car", "--json").stdout)
    assert found["poles"] is None and len(found["characteristic_polynomial"]) == 5
    assert found["routh_hurwitz"] is None and found["warnings"] == []


LARGE = """
import sympy
from bondgraph import C, One, R, Se, Zero, assemble

def ladder(cells=10):
    parts, before = [], Se("supply", 1)
    for place in range(cells):
        one, zero = One(f"one{place}"), Zero(f"zero{place}")
        symbols = sympy.symbols(f"R{place} C{place}", positive=True)
        parts.append(before >> one >> zero >> C(f"c{place}", symbols[1]))
        parts.append(one >> R(f"r{place}", symbols[0]))
        before = zero
    return assemble("ladder", parts)
"""


def test_a_large_model(tmp_path):
    path = tmp_path / "large.py"
    path.write_text(LARGE)
    found = json.loads(call(f"{path}:ladder", "--json").stdout)
    assert found["characteristic_polynomial"] is None and "too large" in found["warnings"][0]
    done = call(f"{path}:ladder", "--routh", code=1)
    assert done.stdout == "" and len(done.stderr.splitlines()) == 1
    assert "linearize" in done.stderr


BAD = [
    (["mass_on_belt"], "contact.*slip"),
    (["mass_on_belt", "--mode", "contact"], "NAME=stick"),
    (["mass_on_belt", "--mode", "contact=fly"], "no mode"),
    ([*SLIDING, "--at", "z=1"], "'z' is not known"),
    ([*SLIDING, "--at", "spring.q"], "NAME=EXPR"),
    ([*SLIDING, "--at", "spring.q=("], "--at spring.q"),
    ([*SLIDING, "--at", "spring.q=foo"], "foo"),
    (["quarter_car", "--transfer", "v_body"], "OUT:IN"),
    (["quarter_car", "--transfer", "v_bod:v_road"], "did you mean v_body"),
    (["quarter_car", "--transfer", "v_body:road"], "did you mean v_road"),
    (["quarter_car", "--set", "k_s=2[kg]"], "k_s.*kg"),
    (["quarter_car", "--set", "m_s=-2"], "m_s.*positive"),
    (["quarter_carr"], "did you mean quarter_car"),
]


@pytest.mark.parametrize(("words", "match"), BAD, ids=lambda value: str(value)[-40:])
def test_bad_input_is_one_line_and_exit_two(words, match):
    for extra in ([], ["--json"]):
        done = call(*words, *extra, code=2)
        assert done.stdout == "" and len(done.stderr.splitlines()) == 1
        assert re.search(match, done.stderr), done.stderr
