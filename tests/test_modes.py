"""Modes: one plain graph for each state of the contacts."""

import itertools

import pytest
import sympy

from bondgraph import Friction, I, One, R, Se, Sf, Zero, assemble, derive, in_mode, smoothed
from bondgraph.errors import BondGraphError, LawError
from bondgraph.modes import CODES, LABELS, SLIP_BACKWARD, SLIP_FORWARD, STICK, contacts

F, m = sympy.symbols("F m", positive=True)


def train(count=2):
    """Masses in a row, each on the floor, pushed at one end through viscous couplings."""
    parts = []
    ahead = None
    for k in range(count):
        v = One(f"v{k}")
        parts.append(v >> (I(f"m{k}", m), Friction(f"floor{k}", kinetic=lambda s: F + s)))
        if ahead is not None:
            gap = Zero(f"gap{k}")
            parts.append(ahead >> gap >> v)
            parts.append(gap >> R(f"damper{k}", 2))
        ahead = v
    return assemble("train", Se("push", 9) >> ahead, *parts)


def test_labels_and_codes_are_each_other_s_inverse():
    assert {LABELS[code]: code for code in LABELS} == CODES
    assert set(CODES) == {STICK, SLIP_FORWARD, SLIP_BACKWARD}


def test_contacts_are_the_elements_with_modes():
    assert contacts(train(3)) == ("floor0", "floor1", "floor2")
    assert contacts(smoothed(train(3), 0.01)) == ()


class TestInMode:
    def test_a_mode_is_an_ordinary_graph(self):
        graph = in_mode(train(1), {"floor0": "slip+"})
        assert isinstance(graph["floor0"], R)
        assert isinstance(in_mode(train(1), {"floor0": "stick"})["floor0"], Sf)

    def test_the_graph_itself_does_not_change(self):
        graph = train(1)
        in_mode(graph, {"floor0": "stick"})
        assert isinstance(graph["floor0"], Friction)

    @pytest.mark.parametrize(("mode", "rate"), [("slip+", "9 - F - v"), ("slip-", "9 + F - v")])
    def test_slipping(self, mode, rate):
        (found,) = derive(in_mode(train(1), {"floor0": mode})).explicit().values()
        momentum = sympy.Symbol("m0.p", real=True)
        v = sympy.Symbol("v")
        assert (
            sympy.expand(found - sympy.sympify(rate, {"F": F, "v": v}).subs(v, momentum / m)) == 0
        )

    def test_sticking_loses_a_state(self):
        assert derive(in_mode(train(1), {"floor0": "stick"})).states == ()

    @pytest.mark.parametrize("modes", list(itertools.product(CODES, repeat=2)))
    def test_every_combination_has_its_own_causality(self, modes):
        graph = in_mode(train(2), dict(zip(("floor0", "floor1"), modes, strict=True)))
        equations = derive(graph)
        assert len(equations.states) == 2 - modes.count("stick")
        assert len(equations.causal.derivative) == modes.count("stick")
        assert equations.contacts == ()

    def test_contacts_not_named_stay_open(self):
        equations = derive(in_mode(train(2), {"floor0": "stick"}))
        assert [contact.name for contact in equations.contacts] == ["floor1"]

    def test_port_variables_are_kept_for_modulation(self):
        v = One("v")
        floor = Friction("floor", kinetic=lambda s: F)
        graph = assemble(
            "g", v >> (I("m", m), floor), Sf("s", 1) >> Zero("z") >> R("r", 1 + floor.e**2),
            outputs={"force": floor.e},
        )  # fmt: skip
        for mode, force in (("slip+", F), ("slip-", -F)):
            equations = derive(in_mode(graph, {"floor": mode}))
            assert equations.substituted(equations.outputs["force"]) == force
            assert equations.substituted(equations.ports["r.e"]) == 1 + F**2

    def test_the_force_in_the_stick_mode_is_that_of_rest(self):
        equations = derive(in_mode(train(1), {"floor0": "stick"}))
        assert equations.substituted(equations.ports["floor0.e"]) == 9

    def test_unknown_names_and_modes(self):
        graph = train(1)
        with pytest.raises(BondGraphError, match=r"'m0' is no element with modes .*it has floor0"):
            in_mode(graph, {"m0": "stick"})
        with pytest.raises(BondGraphError, match=r"no mode 'glide'; use stick, slip\+, slip-"):
            in_mode(graph, {"floor0": "glide"})

    def test_a_smooth_contact_has_no_modes_left(self):
        graph = smoothed(train(1), 0.01)
        with pytest.raises(BondGraphError, match="it has none"):
            in_mode(graph, {"floor0": "stick"})


class TestSmoothed:
    def test_law(self):
        equations = derive(smoothed(train(1), sympy.Rational(1, 100)))
        (rate,) = equations.explicit().values()
        v = sympy.Symbol("m0.p", real=True) / m
        assert sympy.simplify(rate - (9 - (F + sympy.Abs(v)) * sympy.tanh(100 * v))) == 0

    @pytest.mark.parametrize("width", [0, -0.1])
    def test_widths_are_positive(self, width):
        with pytest.raises(LawError, match="positive"):
            smoothed(train(1), width)

    def test_breakaway_and_ports_are_kept(self):
        graph = train(1)
        smooth = smoothed(graph, 0.1)
        assert smooth["floor0"].e == graph["floor0"].e
        assert smooth["floor0"].breakaway == F
