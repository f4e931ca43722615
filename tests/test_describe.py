"""Switching elements, blocks and fields in words, by hand."""

from __future__ import annotations

import json

import pytest
import sympy

from bondgraph import TIME, C, Diode, EndStop, Friction, Switch, derive, text
from bondgraph.describe import mode_words, switch_cases, switch_lines

from . import showcase

e, f = sympy.symbols("e f")


def words(element, **others):
    return mode_words(element, {element.e: e, element.f: f})


@pytest.mark.parametrize(
    ("element", "said"),
    [
        (Diode("d"), "conducting while f > 0 with e = 0; blocking while e < 0 with f = 0"),
        (
            Diode("d", drop=2, resistance=3),
            "conducting while f > 0 with e = 3*f + 2; blocking while e < 2 with f = 0",
        ),
        (
            Switch("s", closed=TIME - 1),
            "closed while t > 1 with e = 0; open while t < 1 with f = 0",
        ),
        (
            Friction("c", kinetic=lambda speed: 3, breakaway=5),
            "slip+ while f > 0 with e = 3; slip- while f < 0 with e = -3; "
            "stick while Abs(e) < 5 with f = 0",
        ),
    ],
    ids=["diode", "drop", "switch", "friction"],
)
def test_modes_with_their_margins(element, said):
    assert words(element) == said


def test_an_impact_is_told():
    height = C("height", stiffness=0)
    stop = EndStop("floor", gap=height.q, restitution=0.8)
    names = {stop.e: e, stop.f: f, height.q: sympy.Symbol("q")}
    assert mode_words(stop, names) == (
        "free while q > 0 with e = 0; contact while e > 0 with f = 0; an impact turns f to -4*f/5"
    )


def test_diode_and_coil():
    equations = derive(showcase.choke())
    assert switch_lines(equations) == [
        "d: conducting while d.f > 0 with d.e = 0; blocking while d.e < 0 with d.f = 0",
        "  in these equations d.f is loop.f, and d.e waits for the mode",
    ]
    assert "\nSwitching elements\n  d: conducting" in text.to_text(equations)


def test_cases_are_zero_in_their_mode_and_cover_all():
    equations = derive(showcase.choke())
    (case,) = switch_cases(equations)
    values = {str(symbol): symbol for symbol in case.free_symbols}
    conducting = case.xreplace({values["loop.f"]: sympy.Integer(2)})
    assert conducting == values["d.e"]
    blocking = case.xreplace({values["loop.f"]: sympy.Integer(0), values["d.e"]: sympy.Integer(-3)})
    assert blocking == 0


def test_latex_gives_cases():
    written = text.to_latex(derive(showcase.choke()))
    assert written.count(r"\begin{cases}") == 1 and r"e_{\mathrm{d}} < 0" in written


def test_blocks_and_fields():
    said = text.to_text(derive(showcase.controlled()))
    assert "\n  gauge: Lag, der(gauge.y) = -2*gauge.y + 2*tank.e\n" in said
    energy = text.to_json(derive(showcase.cfield()))["energies"]
    q1, q2 = (sympy.Symbol(f"beam.{port}.q") for port in ("tip", "middle"))
    shown = sympy.sympify(energy["beam"].replace("beam.tip.q", "x").replace("beam.middle.q", "y"))
    x, y = sympy.symbols("x y")
    by_hand = (2 * q1**2 - 10 * q1 * q2 + 16 * q2**2) / 2
    assert sympy.expand(shown - by_hand.subs({q1: x, q2: y})) == 0


def test_json_tells_the_modes():
    (relay, d) = sorted(
        text.to_json(derive(showcase.rectifier()))["switches"],
        key=lambda item: item["kind"] != "Switch",
    )
    assert relay["open"] == "relay.f" and d["open"] == "d.e"
    assert d["modes"][0] == {
        "mode": "conducting",
        "variable": "d.e",
        "value": "3/5",
        "margin": "d.f",
    }


@pytest.mark.parametrize("name", sorted(showcase.GRAPHS))
def test_every_element_can_be_written(name):
    equations = derive(showcase.GRAPHS[name]())
    said = text.to_text(equations)
    for state in equations.states:
        assert f"der({state}) = " in said
    assert text.to_latex(equations).count(r"\dot{") >= len(equations.states)
    json.dumps(text.to_json(equations), allow_nan=False)
