"""Equations as text, LaTeX and JSON: complete, right, and readable."""

from __future__ import annotations

import json
import random
import re

import pytest
import sympy
from matplotlib.mathtext import MathTextParser

from bondgraph import (
    C,
    I,
    One,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    assign_causality,
    derive,
    models,
    text,
)
from bondgraph.models import LIBRARY
from bondgraph.resolver import resolve

MODELS = sorted(LIBRARY)


@pytest.fixture(scope="module", params=MODELS)
def equations(request):
    return derive(getattr(models, request.param).graph())


@pytest.fixture(scope="module")
def brake():
    return derive(models.bicycle_brake.graph())


def ladder(cells):
    parts, before = [], Se("E", 1)
    for number in range(cells):
        one, zero = One(f"i{number}"), Zero(f"u{number}")
        parts += [before >> one >> zero >> C(f"c{number}", 1), one >> R(f"r{number}", 1)]
        before = zero
    return derive(assemble("ladder", parts))


@pytest.fixture
def large(monkeypatch):
    """A model that counts as large, without its size."""
    monkeypatch.setattr(text, "EXPANDED_STATES", 3)
    return ladder(4)


def implicit():
    """A resistor whose law cannot be inverted, in a loop: it stays an algebraic variable."""
    v = One("v")
    law = R("odd", effort=lambda f: f**3 + f)
    return derive(assemble("implicit", Se("E", 2) >> v >> (law, C("c", 1))))


def stand_in(symbols):
    """Plain names for dotted ones, so that text can be read back."""
    return {symbol.name: sympy.Symbol(f"v{number}") for number, symbol in enumerate(symbols)}


def read(expression, names):
    """Turn an expression in text back into sympy."""
    for name in sorted(names, key=len, reverse=True):
        pattern = rf"(?<![\w.>]){re.escape(name)}(?![\w.>(])"
        expression = re.sub(pattern, str(names[name]), expression)
    return sympy.sympify(expression, locals={str(s): s for s in names.values()})


class TestExpanded:
    def test_rates_hold_states_inputs_and_parameters_only(self, equations):
        for rate in text.expanded(equations).values():
            assert rate.free_symbols <= equations.arguments

    def test_rates_are_those_of_the_equations(self, equations):
        numbers = random.Random(3)
        for state, rate in text.expanded(equations).items():
            exact = equations.substituted(equations.derivatives[equations.states.index(state)])
            symbols = sorted((exact - rate).free_symbols, key=str)
            values = {symbol: numbers.uniform(0.5, 1.5) for symbol in symbols}
            assert abs((exact - rate).subs(values).evalf()) < 1e-9

    def test_what_cancels_is_cancelled(self):
        v = One("v")
        pair = derive(assemble("pair", Se("F", 1) >> v >> (I("a", 2), I("b", 3), R("r", 0.5))))
        assert [str(rate) for rate in text.expanded(pair).values()] == ["2/5 - a.p/10"]

    def test_large_models_are_not_expanded(self):
        assert text.expanded(ladder(40)) is not None
        assert text.expanded(ladder(41)) is None


class TestText:
    def test_every_state_has_its_rate(self, equations):
        written = text.to_text(equations)
        for state in equations.states:
            assert written.count(f"\n  der({state.name}) = ") == 2

    def test_assignments_stand_in_order_and_are_all_needed(self, equations):
        lines = text.to_text(equations).split("\n\n")
        body = next(block for block in lines if block.startswith("Intermediate variables"))
        shown = [line.split(" = ")[0].strip() for line in body.splitlines()[1:]]
        order = [symbol.name for symbol, _ in equations.assignments]
        assert shown == [name for name in order if name in shown]
        everything = text.to_text(equations)
        assert all(everything.count(name) >= 2 for name in shown)

    def test_brake(self, brake):
        written = text.to_text(brake)
        assert written.startswith("bicycle_brake: 5 states\n")
        assert "  rear.mass.p [N*s]\n" in written
        assert (
            "  der(rear.mass.p) = -b_f*rear.mass.p/m_f - k_f*rear.bending.q + pads.e\n" in written
        )
        assert "  friction.f = -rear.mass.p/m_f + r_r*wheel.rotor.p/J_r\n" in written
        assert "friction.direction is the sign of friction.f" in written
        assert "Dependent storage, no states of their own\n  wheel.tyre.p = " in written
        assert "I 'wheel.tyre' is in derivative causality" in written
        assert "  slip = friction.f [m/s]  slip of the pads" in written
        assert "wheel.road.e" not in written  # what nothing shown rests on

    def test_powers_are_written_with_a_caret(self):
        written = text.to_text(implicit())
        assert "odd.f^3" in written or "v.f^3" in written
        assert "**" not in written

    def test_algebraic_variables(self):
        written = text.to_text(implicit())
        assert written.startswith("implicit: 1 state, 1 algebraic variable\n")
        assert "Algebraic equations\n  0 = " in written
        assert "Algebraic loops\n  " in written

    def test_inputs_and_their_rates_have_units(self):
        force = sympy.Symbol("force")
        c = C("c", 2)
        graph = assemble("driven", Se("F", force) >> c, inputs={force: "N"})
        written = text.to_text(derive(graph))
        assert "Inputs\n  force [N]\n  der(force) [N/s]" in written

    def test_large_models_are_left_as_assignments(self, large):
        written = text.to_text(large)
        assert "expanded" not in written
        assert "\n  der(c3.q) = " in written


def latex_rows(written):
    body = re.fullmatch(r"\\begin\{align\*\}\n(.*)\n\\end\{align\*\}", written, re.DOTALL)[1]
    return body.split(" \\\\\n")


class TestLatex:
    def check(self, written):
        parser = MathTextParser("path")
        for row in latex_rows(written):
            assert row.count("&") == 1
            parser.parse(f"${row.replace('&', ' ')}$")

    def test_library(self, equations):
        written = text.to_latex(equations)
        self.check(written)
        lefts = [row.split("&=")[0] for row in latex_rows(written) if "&=" in row]
        assert sum(left.startswith(r"\dot{") for left in lefts) == len(equations.states)

    def test_brake(self, brake):
        written = text.to_latex(brake)
        assert (
            r"\dot{p}_{\mathrm{rear,mass}} &= - \frac{b_{f} \, p_{\mathrm{rear,mass}}}{m_{f}}"
            in (written)
        )
        assert r"\sigma_{\mathrm{friction}}" in written
        assert r"p_{\mathrm{wheel,tyre}} &= J_{t} \, \omega_{t}" in written

    def test_large_models(self, large):
        written = text.to_latex(large)
        self.check(written)
        assert len(latex_rows(written)) == len(text.to_json(large)["assignments"]) + 4

    def test_algebraic_variables(self):
        written = text.to_latex(implicit())
        self.check(written)
        assert any(row.startswith("0 &=") for row in latex_rows(written))


class TestJson:
    def test_shape(self, equations):
        values = resolve(equations.graph.parameters, partial=True)
        found = json.loads(json.dumps(text.to_json(equations, values)))
        assert found["schema"] == 1
        assert [row["name"] for row in found["states"]] == [s.name for s in equations.states]
        assert found["inputs"] == [symbol.name for symbol in equations.inputs]
        assert found["algebraic"] == [] and found["assignments"] == []
        assert found["warnings"] == list(equations.warnings)
        assert [row["bond"] for row in found["causality"]] == [
            bond.name for bond in equations.graph.bonds
        ]

    def test_derivatives_read_back(self, equations):
        found = text.to_json(equations)
        names = stand_in(sorted(equations.arguments, key=str))
        back = {names[symbol.name]: symbol for symbol in equations.arguments}
        for row, rate in zip(found["states"], text.expanded(equations).values(), strict=True):
            assert sympy.expand(read(row["derivative"], names).xreplace(back) - rate) == 0

    def test_values_and_units_are_si(self, brake):
        values = resolve(brake.graph.parameters)
        found = text.to_json(brake, values)["parameters"]
        assert found["k_f"] == {"value": 350e3, "unit": "N/m"}
        assert found["zeta_f"] == {"value": 0.05, "unit": ""}
        assert found["omega_t"]["unit"] == "rad/s"
        assert set(found) == {symbol.name for symbol in brake.graph.parameters}

    def test_values_may_be_missing(self, brake):
        assert text.to_json(brake)["parameters"]["k_f"]["value"] is None

    def test_a_unit_that_does_not_exist_is_passed_on(self):
        a = sympy.Symbol("a")
        graph = assemble("g", Se("E", a) >> R("r", 2), parameters={a: (1, "Vv")})
        assert text.to_json(derive(graph))["parameters"]["a"]["unit"] == "Vv"

    def test_causality(self, brake):
        rows = {row["bond"]: row for row in text.to_json(brake)["causality"]}
        road = rows["wheel.road>wheel.rim"]
        assert (road["effort_out_of"], road["reason"]) == ("wheel.rim", "source")
        rotor = rows["wheel.hub>wheel.rotor"]
        assert rotor["reason"] == "integral"
        assert rotor["because"] == "integral causality of I 'wheel.rotor'"

    def test_large_models_have_assignments(self, large):
        found = text.to_json(large)
        known = {symbol.name for symbol in large.states}
        for row in found["assignments"]:
            words = set(re.findall(r"[\w.>]*[a-z][\w.>]*", row["expression"]))
            assert words <= known
            known.add(row["name"])
        assert all(row["derivative"] in known for row in found["states"])

    def test_algebraic_variables(self):
        (row,) = text.to_json(implicit())["algebraic"]
        assert set(row) == {"name", "residual"}
        assert row["name"] in row["residual"]


def test_causal_graphs_are_derived_too():
    causal = assign_causality(assemble("g", Sf("v", 1) >> C("c", 2)))
    assert "der(c.q) = 1" in text.to_text(derive(causal))
