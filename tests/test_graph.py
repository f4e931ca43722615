"""Assembly: names, arrows, submodels, symbols; and every structural fault by name."""

import dataclasses
from collections.abc import Mapping

import pytest
import sympy

from bondgraph import (
    GY,
    TF,
    TIME,
    C,
    Friction,
    I,
    One,
    Output,
    Parameter,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    derive,
    linearize,
)
from bondgraph.errors import GraphError, ParameterError
from bondgraph.graph import GraphBond, Signal

a, b, m, u = sympy.symbols("a b m u", real=True)


def loop(name="loop", *extra, **laws):
    """A driven mass with a damper, and whatever else hangs on its junction."""
    v = One("v")
    return assemble(name, Se("force", 1) >> v >> (I("mass", 2), R("damper", 3), *extra), **laws)


def cell(name="cell", **laws):
    """A submodel with one open junction."""
    v = One("v")
    return assemble(name, v >> (I("mass", 2), R("damper", 3)), ports={"v": v}, **laws)


class TestAssembled:
    def test_elements_and_bonds_in_the_order_written(self):
        graph = loop()
        assert list(graph.elements) == ["force", "v", "mass", "damper"]
        assert [bond.name for bond in graph.bonds] == ["force>v", "v>mass", "v>damper"]

    def test_is_frozen_all_through(self):
        graph = loop("g", parameters={a: 1}, inputs=[u], outputs={"y": a * u})
        with pytest.raises(dataclasses.FrozenInstanceError):
            graph.name = "other"
        for mapping in (graph.elements, graph.ports, graph.parameters, graph.inputs, graph.outputs):
            assert isinstance(mapping, Mapping)
            with pytest.raises(TypeError):
                mapping["x"] = 1

    def test_assembling_twice_gives_equal_graphs(self):
        v = One("v")
        chain = Se("force", 1) >> v >> (I("mass", 2), R("damper", 3))
        assert assemble("g", chain).bonds == assemble("g", chain).bonds

    def test_elements_are_found_by_name(self):
        graph = loop()
        assert graph["mass"].law == graph["mass"].p / 2
        with pytest.raises(GraphError, match="no element 'mas'; did you mean mass"):
            graph["mas"]
        with pytest.raises(GraphError, match="there is force, v, mass"):
            graph["xyz"]

    def test_bonds_of_an_element(self):
        assert [bond.head for bond in loop().bonds_of("v")] == ["v", "mass", "damper"]

    def test_elements_of_a_class(self):
        assert [name for name, _ in loop().of(R)] == ["damper"]
        assert [name for name, _ in loop().of((R, I))] == ["mass", "damper"]

    def test_parallel_bonds_get_names_of_their_own(self):
        x, y = Zero("x"), One("y")
        graph = assemble("g", x >> y, x >> y, x >> R("r", 1), y >> R("s", 1))
        assert [bond.name for bond in graph.bonds[:2]] == ["x>y", "x>y (2)"]

    def test_a_part_may_be_an_iterable_or_a_bond(self):
        v = One("v")
        chains = [Se("force", 1) >> v, (v >> R(f"r{k}", 1) for k in range(3))]
        assert len(assemble("g", chains).bonds) == 4
        assert len(assemble("g", *(Se("force", 1) >> v >> R("r", 1)).bonds).bonds) == 2


class TestArrows:
    @pytest.mark.parametrize("make", [R, C, I])
    def test_passive_one_ports_are_turned_round(self, make):
        v = One("v")
        graph = assemble("g", make("x", 2) >> v >> R("r", 1))
        assert graph.bonds[0] == GraphBond("v>x", "v", "x")
        assert graph.notes == (f"bond x>v turned round: {make.__name__}('x') takes power",)

    def test_against_a_source_too(self):
        graph = assemble("g", C("c", 2) >> Sf("s", 1))
        assert graph.bonds[0] == GraphBond("s>c", "s", "c")
        assert list(derive(graph).explicit().values()) == [1]

    def test_sources_keep_their_arrow(self):
        v = One("v")
        graph = assemble("g", v >> Se("weight", 3), v >> I("m", 1))
        assert graph.bonds[0].head == "weight"
        assert list(derive(graph).explicit().values()) == [-3]

    def test_eigenvalues_do_not_change(self):
        def oscillator(*, backwards):
            v = One("v")
            parts = I("m", 2), C("k", 0.125), R("b", 0.5)
            chains = [part >> v if backwards else v >> part for part in parts]
            return assemble("osc", Se("force", 1) >> v, *chains)

        plain = linearize(oscillator(backwards=False)).poles()
        turned = linearize(oscillator(backwards=True)).poles()
        assert turned == pytest.approx(plain, abs=1e-14)
        assert plain[0] == pytest.approx(complex(-0.125, 1.9960899278339139), abs=1e-12)


def one_port_twice():
    v, r = One("v"), R("r", 1)
    return v >> r, v >> r, Se("s", 1) >> v


def one_port_without_bond():
    v = One("v")
    return Se("s", 1) >> v >> R("r", 1), C("lost", 1)


def dangling_junction():
    v = One("v")
    return Se("s", 1) >> v >> R("r", 1), v >> Zero("end")


def lonely_junction():
    v = One("v")
    return Se("s", 1) >> v >> R("r", 1), Zero("alone")


def two_port_with_one_bond(make):
    v = One("v")
    return Se("s", 1) >> v >> R("r", 1), v >> make("gear", 2)


def two_port_with_three_bonds(make):
    v, w, gear = One("v"), One("w"), make("gear", 2)
    return Se("s", 1) >> v >> gear >> w >> R("r", 1), gear >> R("x", 1)


def self_bond():
    v = One("v")
    return Se("s", 1) >> v >> R("r", 1), v >> v


FAULTS = {
    "one-port bonded twice": (one_port_twice, "R 'r' is bonded 2 times", ["r"]),
    "one-port without bond": (one_port_without_bond, "C 'lost' has no bond", ["lost"]),
    "dangling": (dangling_junction, "0 'end' is dangling: it has one bond", ["end"]),
    "lonely": (lonely_junction, "0 'alone' is dangling: it has no bond", ["alone"]),
    "TF one bond": (lambda: two_port_with_one_bond(TF), "TF 'gear' has 1 bond;", ["gear"]),
    "GY one bond": (lambda: two_port_with_one_bond(GY), "GY 'gear' has 1 bond;", ["gear"]),
    "TF three bonds": (lambda: two_port_with_three_bonds(TF), "TF 'gear' has 3 bonds", ["gear"]),
    "GY three bonds": (lambda: two_port_with_three_bonds(GY), "GY 'gear' has 3 bonds", ["gear"]),
    "self bond": (self_bond, "'v' is bonded to itself", ["v"]),
    "two passive": (lambda: [R("r", 1) >> C("c", 1)], "two passive", ["c", "r"]),
    "two storages": (lambda: [I("i", 1) >> I("j", 1)], "two passive", ["i", "j"]),
    "two Se": (lambda: [Se("s", 1) >> Se("t", 1)], "two Se decide the same", ["s", "t"]),
    "two Sf": (lambda: [Sf("s", 1) >> Sf("t", 1)], "two Sf decide the same", ["s", "t"]),
    "two sources": (lambda: [Se("s", 1) >> Sf("t", 1)], "two sources", ["s", "t"]),
    "two of a name": (
        lambda: [Se("x", 1) >> One("v") >> R("x", 1)],
        "two elements named 'x'",
        ["x"],
    ),
    "empty": (list, "is empty", []),
    "not a part": (lambda: [3], "3 is no bond", []),
    "text": (lambda: ["v >> r"], "'v >> r' is no bond", []),
    "mapping": (lambda: [{"v": 1}], "is no bond", []),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_malformed_structure_is_named(fault):
    make, said, culprits = FAULTS[fault]
    with pytest.raises(GraphError) as caught:
        assemble("machine", *make())
    assert said in str(caught.value)
    assert "'machine'" in str(caught.value)
    assert sorted(caught.value.elements) == culprits


@pytest.mark.parametrize("name", ["", "a.b", "a>b", None, 3])
def test_a_graph_needs_a_plain_name(name):
    with pytest.raises(GraphError, match="plain name"):
        assemble(name, Se("s", 1) >> R("r", 1))


class TestOnePortPairs:
    def test_source_on_passive_makes_sense(self):
        assert derive(assemble("g", Sf("s", 2) >> C("c", 1))).explicit()
        assert not derive(assemble("g", Se("s", 2) >> R("r", 1))).states


class TestParts:
    def two(self, *, signal):
        mass = I("m", 1)
        force = 2 * mass.f if signal else 1
        return assemble(
            "two",
            One("v") >> (mass, R("b", 1)),
            Se("f", force) >> One("w") >> I("n", 1),
        )

    def test_disconnected_parts_are_a_warning(self):
        (warning,) = self.two(signal=False).warnings
        assert "2 disconnected parts" in warning
        assert "v, m, b; f, w, n" in warning

    def test_each_is_still_solved(self):
        rates = derive(self.two(signal=False)).explicit()
        assert [str(rate) for rate in rates.values()] == ["-m.p", "1"]

    def test_a_signal_joins_them(self):
        graph = self.two(signal=True)
        assert graph.warnings == ()
        assert graph.signals == (Signal("m", "f", "f"),)

    def test_a_bare_symbol_is_a_signal(self):
        mass = I("m", 1)
        follower = Sf("follower", mass.f) >> C("c", 1)
        graph = assemble("g", Se("s", 1) >> One("v") >> (mass, R("b", 1)), follower)
        assert graph.signals == (Signal("m", "f", "follower"),)
        assert graph.warnings == ()

    def test_warnings_of_the_graph_reach_the_equations(self):
        assert any("disconnected" in warning for warning in derive(self.two(signal=False)).warnings)


class TestForeignElements:
    def test_law_using_an_element_not_in_the_graph(self):
        lost = I("lost", 1)
        for law in (2 * lost.f, lost.f):
            with pytest.raises(GraphError, match=r"R 'damper' uses lost\.f.*not in the graph"):
                assemble("g", Se("s", 1) >> One("v") >> (I("m", 1), R("damper", law)))

    def test_ratio_using_an_element_not_in_the_graph(self):
        lost = C("lost", 1)
        with pytest.raises(GraphError, match=r"TF 'lever' uses lost\.q"):
            assemble("g", Se("s", 1) >> One("v") >> TF("lever", lost.q) >> One("w") >> R("r", 1))

    def test_output_using_an_element_not_in_the_graph(self):
        with pytest.raises(GraphError, match=r"output 'y' uses lost\.q"):
            loop("g", outputs={"y": C("lost", 1).q})


class TestSubmodels:
    def test_names_are_qualified_at_any_depth(self):
        inner = cell("inner")
        w = One("w")
        middle = assemble("middle", w >> inner.port("v"), w >> C("c", 1), ports={"w": w})
        outer = assemble("outer", Se("s", 1) >> middle.port("w"))
        assert "middle.inner.mass" in outer.elements
        names = [bond.name for bond in outer.bonds]
        assert "middle.w>middle.inner.v" in names
        assert "s>middle.w" in names
        assert [str(state) for state in derive(outer).states] == [
            "middle.inner.mass.p",
            "middle.c.q",
        ]

    def test_nested_and_flat_graphs_have_the_same_equations(self):
        inner = cell("inner")
        w = One("w")
        middle = assemble("middle", w >> inner.port("v"), w >> C("c", 4), ports={"w": w})
        nested = linearize(assemble("outer", Se("s", 1) >> middle.port("w")))
        flat = linearize(loop("flat", C("c", 4)))
        assert nested.A.tolist() == flat.A.tolist()

    def test_twice_is_refused_and_a_copy_works(self):
        part = cell()
        w = Zero("w")
        with pytest.raises(GraphError, match="two submodels named 'cell'"):
            assemble("g", w >> part.port("v"), w >> cell().port("v"))
        graph = assemble(
            "g", Se("s", 1) >> w, w >> part.port("v"), w >> part.copy("second").port("v")
        )
        assert {"cell.mass", "second.mass"} <= set(graph.elements)
        rates = derive(graph).explicit()
        assert sorted(map(str, rates.values())) == ["1 - 3*cell.mass.p/2", "1 - 3*second.mass.p/2"]

    def test_the_same_graph_under_two_parents(self):
        part = cell()
        first = assemble("first", Se("s", 1) >> part.port("v"))
        second = assemble("second", Se("s", 1) >> part.port("v"))
        assert derive(first).explicit() == derive(second).explicit()

    def test_the_same_graph_twice_by_different_ways_is_refused(self):
        part = cell()
        w = One("w")
        middle = assemble("middle", w >> part.port("v"), w >> C("c", 1), ports={"w": w})
        with pytest.raises(GraphError, match="copy a submodel that is used twice"):
            assemble("outer", Se("s", 1) >> middle.port("w"), part.port("v") >> R("r", 1))

    def test_a_copy_has_elements_of_its_own(self):
        part = cell(outputs={"speed": (2 * a, "m/s")})
        twin = part.copy("twin")
        assert twin.name == "twin"
        assert twin.ports == part.ports
        for name in part.elements:
            assert not set(part[name].symbols.values()) & set(twin[name].symbols.values())
        assert derive(assemble("g", twin, Se("s", 1) >> twin.port("v")))

    def test_a_copy_keeps_its_inner_signals_inside(self):
        v = One("v")
        mass = I("mass", 1)
        part = assemble(
            "part",
            v >> (mass, R("drag", effort=lambda f: f * mass.p)),
            ports={"v": v},
            outputs={"momentum": mass.p},
        )
        twin = part.copy("twin")
        graph = assemble("g", Se("s", 1) >> part.port("v"), Se("z", 2) >> twin.port("v"))
        rates = {str(key): str(value) for key, value in derive(graph).explicit().items()}
        assert rates == {"part.mass.p": "1 - part.mass.p**2", "twin.mass.p": "2 - twin.mass.p**2"}
        assert str(graph.outputs["twin.momentum"].expression) == "_mass.p"
        assert derive(graph).outputs["twin.momentum"] == derive(graph).states[1]

    def test_a_copy_of_a_bare_modulation(self):
        v, angle = One("v"), C("angle", 1)
        part = assemble(
            "part", v >> angle, v >> TF("lever", angle.q) >> One("w") >> R("r", 1), ports={"v": v}
        )
        twin = part.copy("twin")
        assert twin["lever"].ratio == twin["angle"].q

    def test_unknown_ports_are_refused(self):
        with pytest.raises(GraphError, match="no port 'w'; there is v"):
            cell().port("w")

    def test_only_junctions_of_the_graph_are_ports(self):
        v = One("v")
        chain = Se("s", 1) >> v >> R("r", 1)
        with pytest.raises(GraphError, match="must be a junction"):
            assemble("g", chain, ports={"p": R("x", 1)})
        with pytest.raises(GraphError, match="not in the graph"):
            assemble("g", chain, ports={"p": One("w")})

    def test_open_junctions_must_be_bonded_or_passed_on(self):
        w = One("w")
        open_part = assemble("part", w >> R("r", 1), ports={"w": w})
        with pytest.raises(GraphError, match=r"'part\.w' is dangling"):
            assemble("g", open_part)
        passed = assemble("g", open_part, ports={"p": open_part.port("w")})
        assert passed.ports == {"p": "part.w"}
        with pytest.raises(GraphError, match=r"'part\.w' is dangling"):
            derive(passed)

    def test_outputs_are_passed_on_with_their_names(self):
        v = One("v")
        mass = I("mass", 2)
        part = assemble(
            "part", v >> mass, v >> R("r", 1), ports={"v": v}, outputs={"s": (mass.f, "m/s")}
        )
        graph = assemble("g", Se("f", 1) >> part.port("v"), outputs={"twice": 2 * mass.f})
        assert list(graph.outputs) == ["part.s", "twice"]
        assert graph.outputs["part.s"].unit == "m/s"


class TestSymbols:
    def test_symbols_of_one_name_are_one_parameter(self):
        loose, strict = sympy.Symbol("b"), sympy.Symbol("b", positive=True)
        v = One("v")
        graph = assemble("g", Se("s", 1) >> v >> (R("x", loose), R("y", strict), I("m", 1)))
        assert len(graph.parameters) == 1
        assert len(derive(graph).parameters) == 1

    def test_of_submodels_too(self):
        first, second = cell("first"), cell("second")
        v = One("v")
        part = assemble("part", v >> R("r", sympy.Symbol("k", positive=True)), ports={"v": v})
        w = One("w")
        other = assemble("other", w >> R("r", sympy.Symbol("k")), ports={"w": w})
        z = Zero("z")
        graph = assemble(
            "g",
            Sf("s", 1) >> z >> (part.port("v"), other.port("w")),
            first,
            second,
            z >> first.port("v"),
            z >> second.port("v"),
        )
        assert [symbol.name for symbol in graph.parameters] == ["k"]

    def test_t_is_time_unless_it_is_declared(self):
        v = One("v")
        chain = Se("s", sympy.sin(sympy.Symbol("t"))) >> v >> I("m", 1)
        assert assemble("g", chain).parameters == {}
        assert derive(assemble("g", chain)).explicit().popitem()[1] == sympy.sin(TIME)
        declared = assemble("g", chain, parameters={"t": 3})
        assert [symbol.name for symbol in declared.parameters] == ["t"]

    def test_undeclared_symbols_are_parameters_without_value(self):
        v = One("v")
        graph = assemble("g", Se("s", a) >> v >> I("m", m), outputs={"y": b * v.f})
        assert {symbol.name: row.value for symbol, row in graph.parameters.items()} == {
            "a": None,
            "m": None,
            "b": None,
        }

    def test_input_and_parameter_clash(self):
        with pytest.raises(ParameterError, match="u cannot be both"):
            loop("g", parameters={u: 1}, inputs=[u])

    def test_submodel_s_parameter_as_parent_s_input_clashes(self):
        v = One("v")
        part = assemble("part", v >> R("r", u), ports={"v": v}, parameters={u: 2})
        with pytest.raises(ParameterError, match="u cannot be both"):
            assemble("g", Se("s", 1) >> part.port("v"), inputs=[u])

    def test_inputs_with_units(self):
        assert loop("g", inputs={u: "m/s"}).inputs == {u: "m/s"}
        assert loop("g", inputs=(u,)).inputs == {u: ""}
        for inputs in (["u"], {u: 3}, {"u": "m/s"}):
            with pytest.raises(ParameterError, match="inputs are sympy symbols"):
                loop("g", inputs=inputs)


class TestParameterTable:
    def part(self, value, name="part"):
        v = One("v")
        return assemble(name, v >> R("r", a), ports={"v": v}, parameters={a: value})

    def test_forms(self):
        graph = loop(
            "g", parameters={a: (3, "N/m", "stiffness", "a book"), "b": 2 * a, m: Parameter(1.0)}
        )
        rows = {symbol.name: row for symbol, row in graph.parameters.items()}
        assert rows["a"] == Parameter(3, "N/m", "stiffness", "a book")
        assert rows["b"].value == 2 * a and rows["b"].derived
        assert rows["m"].value == 1.0

    def test_a_name_and_a_symbol_are_the_same_parameter(self):
        graph = loop("g", parameters={"a": 3, b: 2 * a})
        assert [symbol.name for symbol in graph.parameters] == ["a", "b"]
        with pytest.raises(ParameterError, match="'a' twice"):
            loop("g", parameters={"a": 3, a: 4})

    def test_symbols_in_expressions_become_parameters(self):
        graph = loop("g", parameters={a: 2 * b})
        assert {symbol.name: row.value for symbol, row in graph.parameters.items()} == {
            "a": 2 * b,
            "b": None,
        }

    @pytest.mark.parametrize("law", [lambda v: 2 * v.f, lambda v: sympy.sin(TIME)])
    def test_a_parameter_is_constant(self, law):
        v = One("v")
        with pytest.raises(ParameterError, match="a parameter is constant"):
            assemble("g", Se("s", 1) >> v >> R("r", a), parameters={a: law(v)})

    def test_a_submodel_s_value_is_taken(self):
        graph = assemble("g", Se("s", 1) >> self.part(3).port("v"))
        assert graph.parameters[a].value == 3

    def test_a_parent_s_value_wins(self):
        graph = assemble("g", Se("s", 1) >> self.part(3).port("v"), parameters={a: 4})
        assert graph.parameters[a].value == 4

    def test_two_submodels_must_agree(self):
        z = Sf("s", 1) >> Zero("z")
        parts = [self.part(3, "x"), self.part(3, "y"), self.part(4, "z_")]
        same = assemble("g", z >> (parts[0].port("v"), parts[1].port("v")))
        assert same.parameters[a].value == 3
        with pytest.raises(ParameterError, match=r"different values \(3 and 4\)"):
            assemble("g", z >> (parts[0].port("v"), parts[2].port("v")))
        settled = assemble("g", z >> (parts[0].port("v"), parts[2].port("v")), parameters={a: 5})
        assert settled.parameters[a].value == 5

    def test_a_value_beats_a_gap(self):
        v = One("v")
        gap = assemble("gap", v >> R("r", a), ports={"v": v})
        z = Sf("s", 1) >> Zero("z")
        graph = assemble("g", z >> (gap.port("v"), self.part(3).port("v")))
        assert graph.parameters[a].value == 3


class TestOutputs:
    def test_forms(self):
        v = One("v")
        mass = I("mass", 2)
        graph = assemble(
            "g",
            Se("s", 1) >> v >> mass,
            outputs={
                "x": mass.p,
                "y": (mass.f, "m/s"),
                "z": (v.f, "m/s", "speed"),
                "o": Output(mass.e, "N"),
            },
        )
        units = {name: output.unit for name, output in graph.outputs.items()}
        assert units == {"x": "", "y": "m/s", "z": "m/s", "o": "N"}
        assert graph.outputs["z"].meaning == "speed"

    @pytest.mark.parametrize("value", ["speed", None, (a, 3), (a, "m", "x", "y"), [a]])
    def test_what_is_no_signal_is_refused(self, value):
        with pytest.raises(GraphError, match="output 'y'"):
            loop("g", outputs={"y": value})

    def test_symbols_are_merged_in_outputs(self):
        v = One("v")
        graph = assemble(
            "g",
            Se("s", sympy.Symbol("b", positive=True)) >> v >> I("m", 1),
            outputs={"y": sympy.Symbol("b") * v.f},
        )
        assert len(graph.parameters) == 1
        assert set(derive(graph).outputs["y"].free_symbols) & set(graph.parameters)


def test_a_parameter_named_like_time_is_told():
    t = sympy.Symbol("t", positive=True)
    z = Zero("z")
    parts = Sf("s", 1) >> z >> R("wall", t)
    (note,) = assemble("g", parts).notes
    assert "'t' of R 'wall' is taken for time" in note
    assert assemble("g", parts, parameters={t: 2}).notes == ()
    assert assemble("g", Sf("s", sympy.Symbol("t")) >> Zero("z") >> R("r", 1)).notes == ()


def test_the_slip_speed_of_a_friction_is_no_variable_of_the_graph():
    """Once an internal error of the derivation."""
    floor = Friction("floor", kinetic=lambda speed: 1 + speed)
    v = One("v")
    with pytest.raises(GraphError, match=r"use its flow floor\.f") as caught:
        assemble("sled", v >> (I("m", 1), floor), Se("wrong", floor.speed) >> v)
    assert caught.value.elements == ("floor",)
