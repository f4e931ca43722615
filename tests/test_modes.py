"""Modes: one plain graph for each state of the contacts."""

import itertools

import pytest
import sympy

from bondgraph import (
    C,
    Diode,
    EndStop,
    Friction,
    I,
    Integrator,
    One,
    R,
    Se,
    Sf,
    Switch,
    Zero,
    assemble,
    derive,
    in_mode,
    smoothed,
)
from bondgraph.errors import BondGraphError, LawError
from bondgraph.modes import (
    CODES,
    LABELS,
    SLIP_BACKWARD,
    SLIP_FORWARD,
    STICK,
    contacts,
    mode_equations,
)

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


def expanded(mode, expression):
    return sympy.simplify(mode.equations.substituted(expression))


class TestModeEquations:
    """What binds states, and the jump that entering a mode takes, by mechanics and circuit theory."""

    def pair(self):
        m1, m2 = sympy.symbols("m1 m2", positive=True)
        left, right, between = One("left"), One("right"), Zero("between")
        gap = Integrator("gap", right.f - left.f, initial=1)
        graph = assemble(
            "pair",
            left >> I("a", m1),
            right >> I("b", m2),
            left >> between >> right >> R("drag", 2),
            between >> EndStop("stop", gap=gap.y, restitution=0),
            gap,
        )
        return derive(graph), m1, m2

    def test_free_nothing_is_bound(self):
        base, *_ = self.pair()
        free = mode_equations(base, [])
        assert free.bound == () and free.states == base.states
        assert free.answers.keys() == free.margins.keys() == {"stop"}

    def test_in_contact_the_masses_are_one(self):
        base, m1, m2 = self.pair()
        mode = mode_equations(base, ["stop"])
        assert [state.name for state in mode.bound] == ["b.p"]
        follows = expanded(mode, mode.equations.ports["b.p"]).subs(mode.imposed["stop"], 0)
        assert sympy.simplify(follows - m2 * sympy.Symbol("a.p", real=True) / m1) == 0

    def test_the_jump_is_that_of_the_reduced_mass(self):
        """A closing speed that goes by du moves each momentum by m1 m2 / (m1 + m2) du."""
        base, m1, m2 = self.pair()
        mode = mode_equations(base, ["stop"])
        rate = mode.imposed_rates["stop"]
        pushes = {
            state.name: sympy.simplify(sympy.diff(expanded(mode, change), rate))
            for state, change in zip(mode.states, mode.derivatives, strict=True)
        }
        reduced = m1 * m2 / (m1 + m2)
        assert sympy.simplify(pushes["a.p"] - reduced) == 0
        assert sympy.simplify(pushes["a.p"] + pushes["b.p"]) == 0
        assert pushes["gap.y"] == 0

    def test_a_closed_switch_makes_two_capacitors_one(self):
        way, a, b = One("way"), Zero("a"), Zero("b")
        graph = assemble(
            "share", a >> C("c1", 2), b >> C("c2", 3), a >> way >> b, way >> Switch("s", closed=1)
        )
        base = derive(graph)
        assert mode_equations(base, ["s"]).bound == ()
        closed = mode_equations(base, [])
        assert [state.name for state in closed.bound] == ["c2.q"]
        rate = closed.imposed_rates["s"]
        pushes = [sympy.diff(expanded(closed, change), rate) for change in closed.derivatives]
        assert pushes == [sympy.Rational(6, 5), -sympy.Rational(6, 5)]

    def test_friction_of_one_force_is_a_source_in_its_direction(self):
        v = One("v")
        graph = assemble("g", v >> (I("m", 1), Friction("f", kinetic=lambda speed: 3)))
        mode = mode_equations(derive(graph), [])
        (change,) = mode.derivatives
        at_rest = {mode.imposed["f"]: 0}
        assert expanded(mode, change).subs(at_rest) == -3 * mode.directions["f"]

    def test_two_diodes_cannot_both_hold_one_loop(self):
        loop = One("loop")
        base = derive(assemble("g", Se("E", 1) >> loop >> (Diode("a"), Diode("b"), I("L", 1))))
        with pytest.raises(BondGraphError, match=r"'a'.*'b'") as caught:
            mode_equations(base, ["a", "b"])
        assert {"a", "b"} <= set(caught.value.elements)
