"""The causality report against what textbooks say of small graphs, written by hand."""

from __future__ import annotations

import itertools

import pytest
import sympy
from hypothesis import assume, given, settings

from bondgraph import (
    GY,
    TF,
    C,
    CField,
    Friction,
    I,
    One,
    R,
    Se,
    Sf,
    Switch,
    Zero,
    assemble,
    derive,
    models,
    report_causality,
)
from bondgraph.causality_report import to_text
from bondgraph.errors import BondGraphError
from bondgraph.models import LIBRARY

from .. import showcase
from ..strategies import sketches

m1, m2, n, F = sympy.symbols("m1 m2 n F", positive=True)
GRAPHS = {name: getattr(models, name).graph for name in LIBRARY} | showcase.GRAPHS


def rigid_pair():
    v = One("v")
    return assemble("pair", Se("F", 1) >> v >> (I("a", 2), I("b", 3, initial=1), R("r", 1)))


def geared(**extra):
    motor, load = One("motor"), One("load")
    driven = Se("T", F) >> motor >> I("rotor", m1), motor >> TF("gear", n) >> load
    return assemble("geared", driven, load >> I("wheel", m2), **extra)


def resistive_loop():
    one, zero = One("o"), Zero("z")
    return assemble("rs", Se("E", 1) >> one >> R("r1", 2), one >> zero >> (R("r2", 3), R("r3", 4)))


def nonlinear_loop():
    v = One("v")
    odd = R("odd", effort=lambda f: f**3 + f)
    return assemble("nl", Se("E", 2) >> v >> (odd, R("s", 2), C("c", 1)))


def symbol(name):
    return sympy.Symbol(name, real=True)


def dependent(graph):
    (found,) = report_causality(graph).dependent
    return found


class TestText:
    def test_rigid_pair_in_full(self):
        assert to_text(report_causality(rigid_pair())) == "\n".join(
            [
                "pair: causality of 4 bonds; 1 of 2 storages dependent; 1 loop",
                "",
                "Bonds: -> shows where power is positive, | is the causal stroke, at the end that decides the flow",
                "  F ->| v  source: Se 'F' decides its effort",
                "  v ->| a  integral: integral causality of I 'a'",
                "  v |-> b  propagated: through 1 'v', from: integral causality of I 'a'",
                "  v |-> r  propagated: through 1 'v', from: integral causality of I 'a'",
                "",
                "Junctions: the one bond that decides what is shared",
                "  1 v: a decides the flow, by v>a; F, b and r follow",
                "    why: integral causality of I 'a'",
                "",
                "Storage",
                "  a.p: I in integral causality, a state",
                "  b.p: I in derivative causality, no state of its own",
                "    constraint: b.p = 3*v.f = 3*a.p/2, bound by a",
                "    why: through 1 'v', from: integral causality of I 'a'",
                "    done: the rate der(b.p) is worked out from the constraint, and is b.e; "
                "this closes a loop of rates, solved for a.e; "
                "seen from a all together are one inertance of 5",
                "    its initial value is not used",
                "",
                "Loops",
                "  loop of dependent rates: a.e -> der(v.f) -> der(b.p) -> b.e -> a.e",
                "    done: linear, solved symbolically for a.e",
                "    without it: join a and b into one storage, "
                "or put a compliance or resistance between them",
            ]
        )

    def test_diode_and_coil_in_full(self):
        text = to_text(report_causality(showcase.choke()))
        assert text.split("\n\n")[-1].splitlines() == [
            "Modes: states that each binds",
            "  d conducting: all states are free",
            "  d blocking: coil.p = 0, bound by d",
            "    coil.p: through 1 'loop', from: Sf 'd' decides its flow",
        ]

    def test_what_a_model_does_not_have_is_left_out(self):
        text = to_text(report_causality(showcase.pump()))
        assert not any(word in text for word in ("Loops", "Rates", "Disconnected", "Put right"))

    @pytest.mark.parametrize("name", sorted(GRAPHS))
    def test_every_bond_is_told_once(self, name):
        graph = GRAPHS[name]()
        report = report_causality(graph, modes=False)
        assert [item.bond for item in report.bonds] == [bond.name for bond in graph.bonds]
        arrows = [line.split()[:3] for line in to_text(report).splitlines() if "->" in line]
        told = [(tail, head) for tail, arrow, head in arrows if arrow in ("->|", "|->")]
        assert told == [(bond.tail, bond.head) for bond in graph.bonds]


class TestJunctions:
    @pytest.mark.parametrize("name", sorted(GRAPHS))
    def test_one_bond_decides_and_all_others_follow(self, name):
        graph = GRAPHS[name]()
        report = report_causality(graph, modes=False)
        bonds = {item.bond: item for item in report.bonds}
        for item in report.junctions:
            ends = {
                bond.name: bond.tail if bond.head == item.junction else bond.head
                for bond in graph.bonds_of(item.junction)
            }
            # a 0 takes its effort, and a 1 its flow, from where one comes in
            came = [
                end
                for name, end in ends.items()
                if end
                == (bonds[name].effort_out_of if item.kind == "0" else bonds[name].flow_out_of)
            ]
            assert came == [item.decided_by]
            assert sorted([item.decided_by, *item.followers]) == sorted(ends.values())

    def test_the_last_bond_left_is_told(self):
        report = report_causality(resistive_loop())
        first, second = report.junctions
        assert (first.decided_by, second.decided_by) == ("z", "o")
        assert first.because.startswith("all other bonds take it, so this one has to decide; ")
        assert "free choice of R 'r1'" in second.because


class TestDependentStorage:
    def test_two_compliances_on_one_effort(self):
        c1, c2 = sympy.symbols("c1 c2", positive=True)
        graph = assemble(
            "cs",
            Sf("i", 1) >> Zero("z") >> (C("a", c1), C("b", c2), R("r", 1)),
            parameters={c1: 1, c2: 2},
        )
        report = report_causality(graph)
        (found,) = report.dependent
        assert (found.state, found.bound_by) == ("b.q", ("a",))
        assert found.expanded == c2 * symbol("a.q") / c1
        (reduced,) = report.reductions
        assert (reduced.storage, reduced.carried) == ("a", ("b",))
        assert reduced.quantity == "capacitance" and reduced.value == c1 + c2

    def test_gear_with_inertia_on_both_sides(self):
        report = report_causality(geared(parameters={m1: 1, m2: 2, n: 3, F: 1}))
        (found,) = report.dependent
        assert found.expanded == m2 * n * symbol("rotor.p") / m1
        (reduced,) = report.reductions
        assert sympy.expand(reduced.value - (m1 + n**2 * m2)) == 0
        # the force over the acceleration that the equations give
        (rate,) = derive(geared(parameters={m1: 1, m2: 2, n: 3, F: 1})).explicit().values()
        assert sympy.simplify(F / (rate / m1) - reduced.value) == 0

    def test_inertia_behind_a_gyrator_is_a_compliance_seen_from_the_other_side(self):
        r, c = sympy.symbols("r c", positive=True)
        z, w = Zero("z"), One("w")
        graph = assemble(
            "g",
            Sf("i", 1) >> z >> C("cap", c),
            z >> GY("motor", r) >> w >> I("rotor", m1),
            parameters={r: 1, c: 1, m1: 1},
        )
        report = report_causality(graph)
        (reduced,) = report.reductions
        assert reduced.quantity == "capacitance"
        assert sympy.simplify(reduced.value - (c + m1 / r**2)) == 0

    def test_a_crank_has_an_inertance_that_hangs_on_its_angle(self):
        angle, w, v = C("angle", stiffness=0), One("w"), One("v")
        crank = w >> (I("wheel", 2), angle)
        graph = assemble("crank", crank, w >> TF("arm", sympy.sin(angle.q)) >> v >> I("piston", 3))
        (reduced,) = report_causality(graph).reductions
        q = symbol("angle.q")
        assert sympy.simplify(reduced.value - (2 + 3 * sympy.sin(q) ** 2)) == 0

    def test_several_are_carried_by_one(self):
        v = One("v")
        graph = assemble("train", Se("F", 1) >> v >> (I("a", 2), I("b", 3), I("c", 7)))
        (reduced,) = report_causality(graph).reductions
        assert reduced.carried == ("b", "c") and reduced.value == 12

    def test_bound_by_two_states_no_single_inertance_is_claimed(self):
        left, right, middle = One("l"), One("r"), One("m")
        gap = Zero("gap")
        graph = assemble(
            "sum", left >> gap >> right, gap >> middle >> I("c", 5), left >> I("a", 2), right >> I("b", 3),
            Se("F", 1) >> left,
        )  # fmt: skip
        report = report_causality(graph)
        (found,) = report.dependent
        others = {"a", "b", "c"} - {found.storage}
        assert set(found.bound_by) == others and report.reductions == ()

    def test_a_storage_driven_by_a_source(self):
        u = sympy.Symbol("u")
        graph = assemble(
            "d", Se("E", u) >> Zero("z") >> (C("c", 2, initial=5), R("r", 1)), inputs=[u]
        )
        report = report_causality(graph)
        (found,) = report.dependent
        assert found.bound_by == ("E",) and found.expanded == 2 * u and found.idle_initial
        assert found.done == "the rate der(c.q) is worked out from the constraint, and is c.f"
        assert report.input_rates == (("u", "der(u)"),) and report.reductions == ()
        assert "der(u) of u" in to_text(report)

    def test_a_port_of_a_field(self):
        pair = CField("pair", ("a", "b"), stiffness=[[2, 1], [1, 2]])
        w = One("w")
        graph = assemble("g", Se("F", 4) >> pair["a"], w >> (I("m", 1), pair["b"]))
        found = dependent(graph)
        # 4 = 2 q_a + q_b
        assert found.state == "pair.a.q" and found.expanded == 2 - symbol("pair.b.q") / 2
        assert found.bound_by == ("pair.b",) or set(found.bound_by) == {"F", "pair.b"}

    def test_a_law_that_cannot_be_solved(self):
        hard = C("hard", effort=lambda q: q + q**5)
        found = dependent(assemble("g", Se("E", 1) >> Zero("z") >> (hard, R("r", 1))))
        assert found.constraint is None and found.bound_by == ("E",)
        assert "hard.q is kept as an algebraic variable" in found.done

    @settings(max_examples=30, deadline=None)
    @given(sketches())
    def test_constraints_hold_along_the_motion(self, sketch):
        """The rate of what a state is said to be is the variable that its bond carries."""
        try:
            equations = derive(sketch.graph())
        except BondGraphError:
            assume(False)
        report = report_causality(equations, modes=False)
        assume(report.dependent)
        rates = equations.explicit()
        for item in report.dependent:
            if item.expanded is None:
                continue
            conjugate = "f" if item.kind == "C" else "e"
            answer = equations.substituted(equations.ports[f"{item.storage}.{conjugate}"])
            given = {**rates, **equations.input_rates}
            rate = sum(
                sympy.diff(item.expanded, symbol) * given[symbol]
                for symbol in item.expanded.free_symbols
            )
            assert sympy.simplify(rate - answer) == 0


class TestLoops:
    def test_resistive_loop(self):
        (loop,) = report_causality(resistive_loop()).loops
        assert set(loop.variables) == {"z.e", "r2.f", "r3.f", "o.f", "r1.e"}
        assert loop.solved == "linear" and loop.tearing == ("z.e",)
        # with an I at o its flow is known, and still r2 and r3 share it by a loop
        assert loop.remedy == "add a C at 0-junction 'z'"

    def test_the_way_out_is_one(self):
        graph, wider = resistive_loop(), Zero("z")
        one = One("o")
        rest = one >> wider >> (R("r2", 3), R("r3", 4), C("store", 1))
        cured = assemble("rs", Se("E", 1) >> one >> R("r1", 2), rest)
        assert report_causality(graph).loops and report_causality(cured).loops == ()

    def test_nonlinear_loop_is_kept(self):
        report = report_causality(nonlinear_loop())
        (loop,) = report.loops
        assert loop.solved == "algebraic" and set(loop.variables) == {"s.e", "v.f", "odd.e"}
        assert "not linear, s.e kept as algebraic variable" in to_text(report)

    def test_a_law_given_the_wrong_way_round(self):
        v = One("v")
        odd = R("odd", effort=lambda f: f**3 + f)
        graph = assemble("g", Se("E", 2) >> v >> (odd, C("c", 1)))
        (loop,) = report_causality(graph).loops
        assert loop.remedy.startswith("give R 'odd' its law as flow=")


class TestModes:
    def test_table_of_all(self):
        report = report_causality(showcase.rectifier())
        assert report.possible_modes == 4
        found = {
            (item.modes["d"], item.modes["relay"]): [bound.state for bound in item.bound]
            for item in report.modes
        }
        assert found == {
            ("conducting", "closed"): ["c.q"],
            ("conducting", "open"): [],
            ("blocking", "closed"): ["c.q"],
            ("blocking", "open"): [],
        }

    def test_a_locked_clutch_joins_two_inertias(self):
        stick = report_causality(showcase.clutch()).modes[1]
        (bound,) = stick.bound
        assert stick.modes == {"plates": "stick"} and bound.value == 2 * symbol("j1.p")
        assert bound.bound_by == ("j1", "plates")

    def test_a_mode_that_cannot_be_says_why(self):
        loop = One("loop")
        switches = [Switch(name, closed=1) for name in ("s", "t")]
        graph = assemble("g", Se("E", 1) >> loop >> (R("r", 1), *switches))
        rows = report_causality(graph).modes
        wrong = {tuple(row.modes.values()): row.impossible for row in rows if row.impossible}
        assert list(wrong) == [("open", "open")]
        assert "'s'" in wrong["open", "open"] and "'t'" in wrong["open", "open"]
        assert "s open, t open: cannot be: causal conflict" in to_text(report_causality(graph))

    def test_many_modes_are_told_by_single_changes(self):
        parts, names = [], [f"f{k}" for k in range(5)]
        for name in names:
            v = One(f"v_{name}")
            parts.append(
                Se(f"E_{name}", 1) >> v >> (I(f"m_{name}", 1), Friction(name, kinetic=lambda s: 1))
            )
        report = report_causality(assemble("row", parts))
        assert report.possible_modes == 32 and len(report.modes) == 6
        for name, row in zip(names, report.modes[1:], strict=True):
            assert [key for key, mode in row.modes.items() if mode == "stick"] == [name]
            assert [bound.state for bound in row.bound] == [f"m_{name}.p"]
        assert "Modes of a single change, of 32 in all" in to_text(report)

    def test_none_without_switching_elements(self):
        report = report_causality(rigid_pair())
        assert report.modes == () and report.possible_modes == 0


class TestRest:
    def test_disconnected_parts(self):
        graph = assemble(
            "two", Se("E", 1) >> R("r", 1), Se("G", 1) >> One("v") >> (I("m", 1), R("b", 2))
        )
        report = report_causality(graph)
        assert report.parts == (("E", "r"), ("G", "v", "m", "b"))
        assert "  E, r\n  G, v, m, b" in to_text(report)

    def test_signals_join_parts(self):
        z = Zero("z")
        graph = assemble("two", Sf("i", 1) >> z >> C("c", 1), Se("G", z.e) >> R("r", 1))
        report = report_causality(graph)
        assert report.parts == ()
        assert [(s.source, s.variable, s.target) for s in report.signals] == [("z", "e", "G")]

    def test_arrows_turned_round(self):
        v = One("v")
        graph = assemble("g", R("r", 1) >> v, Se("E", 1) >> v)
        told = to_text(report_causality(graph)).split("\n\n")[-1].splitlines()
        assert told[0] == "Put right" and "bond r>v turned round" in told[1]

    def test_from_each_stage_it_is_the_same(self):
        graph = rigid_pair()
        texts = {
            to_text(report_causality(stage))
            for stage in (graph, derive(graph).causal, derive(graph))
        }
        assert len(texts) == 1

    @pytest.mark.parametrize("name", sorted(GRAPHS))
    def test_all_models_are_told(self, name):
        graph = GRAPHS[name]()
        report = report_causality(graph)
        storages = {item.storage for item in report.storages}
        assert storages == {name for name, item in graph.elements.items() if item.kind in "CI"}
        for row, other in itertools.combinations(report.modes, 2):
            assert row.modes != other.modes

    def test_mixtures_of_all_kinds_are_told(self):
        told = 0
        for seed in range(30):
            graph = showcase.mixture(seed)
            try:
                equations = derive(graph)
            except BondGraphError:
                continue  # two sources on one junction, and the like
            report = report_causality(equations)
            told += 1
            assert to_text(report).count("\n") > len(graph.bonds)
            always = {item.state for item in report.dependent}
            for row in report.modes:
                assert not {bound.state for bound in row.bound} & always
                assert all(bound.bound_by for bound in row.bound)
        assert told >= 15
