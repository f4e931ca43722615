"""Causality: the strokes of textbook graphs, their reasons, and conflicts told in full."""

import itertools

import pytest
from hypothesis import assume, given, settings

from bondgraph import (
    GY,
    TF,
    C,
    Friction,
    I,
    One,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    assign_causality,
)
from bondgraph.causality import Reason
from bondgraph.causality.scap import preferred
from bondgraph.elements import Junction, TwoPort
from bondgraph.errors import CausalConflictError, GraphError

from .strategies import sketches

HOME = {C: Zero, I: One}


def causal(*parts):
    return assign_causality(assemble("g", *parts))


def efforts(result):
    """Which element decides the effort of each bond."""
    return {stroke.bond: stroke.effort_out_of for stroke in result.strokes}


def check_the_rules(result):
    """Every element has a causality that it allows."""
    graph = result.graph
    for name, element in graph.elements.items():
        out = [result.decides_effort(name, bond.name) for bond in graph.bonds_of(name)]
        if isinstance(element, Junction):
            assert out.count(isinstance(element, One)) == 1, name
        elif isinstance(element, TwoPort):
            assert (out[0] == out[1]) == isinstance(element, GY), name
        elif isinstance(element, Se | Sf | Friction):
            assert out == [preferred(element)], name
        elif name in (*result.integral, *result.derivative):
            assert (out == [preferred(element)]) == (name in result.integral), name
    for stroke, bond in zip(result.strokes, graph.bonds, strict=True):
        assert {stroke.effort_out_of, stroke.flow_out_of} == {bond.tail, bond.head}


class TestTextbook:
    """The strokes one draws by hand (Karnopp, Margolis, Rosenberg, ch. 3)."""

    def test_rc(self):
        loop = One("loop")
        result = causal(Se("E", 1) >> loop >> (R("r", 1), C("c", 1)))
        assert efforts(result) == {"E>loop": "E", "loop>r": "loop", "loop>c": "c"}
        reasons = [stroke.reason for stroke in result.strokes]
        assert reasons == [Reason.SOURCE, Reason.PROPAGATED, Reason.INTEGRAL]
        assert result.integral == ("c",)
        check_the_rules(result)

    def test_mass_spring_damper(self):
        v = One("v")
        result = causal(Se("F", 1) >> v >> (I("m", 1), C("k", 1), R("b", 1)))
        assert efforts(result) == {"F>v": "F", "v>m": "v", "v>k": "k", "v>b": "b"}
        assert result.integral == ("m", "k")
        assert result.derivative == result.warnings == ()

    def test_parallel_circuit(self):
        node = Zero("node")
        result = causal(Sf("i", 1) >> node >> (R("r", 1), C("c", 1), I("l", 1)))
        assert efforts(result) == {
            "i>node": "node",
            "node>r": "node",
            "node>c": "c",
            "node>l": "node",
        }

    def test_resistive_loop_needs_one_free_choice(self):
        one, zero = One("one"), Zero("zero")
        result = causal(Se("E", 1) >> one >> (R("r1", 1), zero), zero >> (R("r2", 1), R("r3", 1)))
        free = [stroke.bond for stroke in result.strokes if stroke.reason is Reason.ARBITRARY]
        assert free == ["one>r1"]
        check_the_rules(result)

    def test_motor_with_gear_and_load(self):
        circuit, shaft, load = One("circuit"), One("shaft"), One("load")
        result = causal(
            Se("V", 1) >> circuit >> (I("L", 1), R("Ra", 1)),
            circuit >> GY("motor", 2) >> shaft >> (I("J", 1), R("b", 1)),
            shaft >> TF("gear", 3) >> load >> (C("k", 1), R("c", 1)),
        )
        found = efforts(result)
        assert result.derivative == ()
        assert found["circuit>motor"] == found["motor>shaft"] == "motor"
        assert (found["shaft>gear"], found["gear>load"]) == ("gear", "load")
        check_the_rules(result)

    def test_storages_keep_integral_causality_through_a_wheatstone_mesh(self):
        a, b = Zero("a"), Zero("b")
        top, bottom = Zero("top"), Zero("bottom")
        arms = [One(f"arm{k}") for k in range(4)]
        bridge = One("bridge")
        result = causal(
            Se("E", 1) >> top >> (arms[0] >> a, arms[1] >> b),
            a >> arms[2] >> bottom,
            b >> arms[3] >> bottom,
            a >> bridge >> b,
            *(arm >> R(f"r{k}", 1) for k, arm in enumerate(arms)),
            bridge >> I("l", 1),
            Se("ground", 0) >> bottom,
        )
        assert result.integral == ("l",)
        check_the_rules(result)


@pytest.mark.parametrize("first", [C, I])
@pytest.mark.parametrize("second", [C, I])
@pytest.mark.parametrize("make", [TF, GY])
def test_two_ports_carry_dependence(make, first, second):
    """A TF ties likes together; a GY turns causality round, so it ties C and I together."""
    left, right = HOME[first]("left"), HOME[second]("right")
    result = causal(
        left >> (first("x", 1), R("rx", 1)),
        right >> (second("y", 1), R("ry", 1)),
        left >> make("two", 2) >> right,
    )
    tied = (first is second) == (make is TF)
    assert result.integral == (("x",) if tied else ("x", "y"))
    assert result.derivative == (("y",) if tied else ())
    check_the_rules(result)


@pytest.mark.parametrize(
    ("source", "storage", "derivative"),
    [(Se, C, True), (Se, I, False), (Sf, C, False), (Sf, I, True)],
)
def test_source_straight_on_a_storage(source, storage, derivative):
    result = causal(source("s", 1) >> storage("x", 1))
    assert result.derivative == (("x",) if derivative else ())


class TestGyratorCausalities:
    def ring(self, source):
        v, w = (One("v"), One("w")) if source is Sf else (Zero("v"), Zero("w"))
        return causal(source("s", 1) >> v >> GY("gy", 2) >> w >> R("r", 1), v >> R("x", 1))

    def test_flows_in_efforts_out(self):
        found = efforts(self.ring(Sf))
        assert found["v>gy"] == found["gy>w"] == "gy"

    def test_efforts_in_flows_out(self):
        found = efforts(self.ring(Se))
        assert (found["v>gy"], found["gy>w"]) == ("v", "w")


class TestReasons:
    def test_each_stroke_says_why(self):
        v, w = One("v"), One("w")
        result = causal(
            Sf("s", 1) >> v >> R("r", 1), v >> TF("gear", 2) >> w >> (I("m", 1), R("b", 1))
        )
        because = {stroke.bond: stroke.because for stroke in result.strokes}
        assert because["s>v"] == "Sf 's' decides its flow"
        assert because["v>r"] == "through 1 'v', from: Sf 's' decides its flow"
        assert because["gear>w"] == "through TF 'gear', from: Sf 's' decides its flow"
        assert because["w>m"] == "through 1 'w', from: Sf 's' decides its flow"

    def test_one_way_laws_have_their_way_where_they_can(self):
        node = Zero("node")
        result = causal(
            Sf("s", 1) >> node >> (R("r", 1), R("diode", flow=lambda e: e + e**3)),
        )
        assert result.stroke("node>diode").reason is not Reason.ARBITRARY
        assert result.stroke("node>diode").flow_out_of == "diode"
        assert "gives its flow by its law" in result.stroke("node>diode").because
        turned = causal(Sf("s", 1) >> Zero("n") >> (R("r", 1), R("pad", effort=lambda f: f + f**3)))
        assert turned.stroke("n>pad").effort_out_of == "pad"

    def test_dry_friction_takes_its_slip(self):
        v = One("v")
        result = causal(v >> (I("m", 1), Friction("f", kinetic=lambda s: 3)))
        assert efforts(result)["v>f"] == "f"

    def test_explain_has_a_line_for_each_bond(self):
        v = One("v")
        result = causal(Se("F", 1) >> v >> (I("m", 1), I("n", 2)))
        lines = result.explain().splitlines()
        assert lines[0] == "F>v: effort out of F (Se 'F' decides its effort)"
        assert len(lines) == 4
        assert lines[3] == result.warnings[0]

    def test_strokes_are_found_by_bond(self):
        result = causal(Se("F", 1) >> One("v") >> I("m", 1))
        assert result.stroke("v>m").effort_out_of == "v"
        with pytest.raises(KeyError):
            result.stroke("m>v")

    def test_assigning_twice_gives_the_same(self):
        v = One("v")
        graph = assemble("g", Se("F", 1) >> v >> (I("m", 1), I("n", 2), R("r", 1)))
        assert assign_causality(graph).strokes == assign_causality(graph).strokes


class TestDerivativeCausality:
    def test_the_later_of_two_masses_is_dependent_and_both_are_named(self):
        v = One("v")
        result = causal(Se("F", 1) >> v >> (I("a", 1), I("b", 2), R("r", 1)))
        assert (result.integral, result.derivative) == (("a",), ("b",))
        (warning,) = result.warnings
        assert warning == (
            "I 'b' is in derivative causality (through 1 'v', from: integral causality of I 'a'): "
            "it adds no state of its own"
        )

    def test_behind_a_source(self):
        result = causal(Sf("road", 1) >> One("rim") >> (I("tyre", 1), R("r", 1)))
        assert result.derivative == ("tyre",)
        assert "from: Sf 'road' decides its flow" in result.warnings[0]

    def test_found_only_when_tried(self):
        """Here nothing is forced before the storage is tried: its reason tells the clash."""
        a, b = Zero("a"), Zero("b")
        link = One("link")
        result = causal(
            a >> C("x", 1), b >> C("y", 1), a >> link >> b, link >> C("z", 1), a >> R("r", 1)
        )
        assert (result.integral, result.derivative) == (("x", "y"), ("z",))
        check_the_rules(result)


def two_sf_on_one():
    v = One("v")
    return "v", "two bonds decide its flow", [Sf("s", 1) >> v, Sf("z", 2) >> v, v >> R("r", 1)]


def two_se_on_zero():
    u = Zero("u")
    return "u", "two bonds decide its effort", [Se("s", 1) >> u, Se("z", 2) >> u, u >> R("r", 1)]


def only_se_on_one():
    v = One("v")
    return "v", "no bond decides its flow", [Se("s", 1) >> v, v >> Se("z", 2)]


def only_sf_on_zero():
    u = Zero("u")
    return "u", "no bond decides its effort", [Sf("s", 1) >> u, u >> Sf("z", 2)]


def through_tf():
    v, w = One("v"), One("w")
    parts = [Sf("s", 1) >> v >> TF("gear", 2) >> w, Sf("z", 1) >> w, w >> R("r", 1)]
    return "w", "two bonds decide its flow", parts


def through_gy():
    v, u = One("v"), Zero("u")
    parts = [Sf("s", 1) >> v >> GY("gy", 2) >> u, Se("z", 1) >> u, u >> R("r", 1)]
    return "u", "two bonds decide its effort", parts


def through_a_chain_of_junctions():
    ones = [One(f"v{k}") for k in range(4)]
    parts = [a >> b for a, b in itertools.pairwise(ones)]
    parts += [Sf("s", 1) >> ones[0], Sf("z", 1) >> ones[-1]]
    return "v3", "two bonds decide its flow", parts


def through_zero_and_one():
    u, v = Zero("u"), One("v")
    parts = [Se("s", 1) >> u >> v >> Se("z", 1), u >> R("r", 1)]
    return "v", "no bond decides its flow", parts


@pytest.mark.parametrize(
    "make",
    [
        two_sf_on_one,
        two_se_on_zero,
        only_se_on_one,
        only_sf_on_zero,
        through_tf,
        through_gy,
        through_a_chain_of_junctions,
        through_zero_and_one,
    ],
)
def test_conflicts_name_the_junction_and_both_causes(make):
    junction, said, parts = make()
    with pytest.raises(CausalConflictError) as caught:
        causal(*parts)
    message = str(caught.value)
    assert f"-junction {junction!r}: {said}" in message
    assert "'s' decides its" in message and "'z' decides its" in message
    assert "put an R, C or I between" in message
    assert {junction, "s", "z"} <= set(caught.value.elements)
    assert caught.value.bonds


def test_a_two_port_between_contradicting_sources_is_named():
    with pytest.raises(CausalConflictError) as caught:
        causal(Sf("s", 1) >> TF("gear", 2) >> Sf("z", 1))
    assert "at TF 'gear'" in str(caught.value)
    assert set(caught.value.elements) == {"gear", "s", "z"}


def test_friction_beside_a_spring_on_one_force_decides_its_flow():
    """The spring keeps its state; what the slider does is a matter of its mode."""
    node = Zero("node")
    found = causal(Sf("s", 1) >> node >> (C("k", 1), Friction("f", kinetic=lambda v: 3)))
    assert found.integral == ("k",)
    assert found.stroke("node>f").effort_out_of == "node"


def test_junctions_that_contradict_each_other_alone():
    """Three 0-junctions have one shared effort each, but their ring has bonds for only one."""
    a, b = Zero("a"), Zero("b")
    with pytest.raises(CausalConflictError, match="the junctions alone contradict each other"):
        causal(a >> b, a >> b, a >> b, a >> R("r", 1), b >> R("s", 1))


def test_open_junctions_are_refused():
    v = One("v")
    part = assemble("part", v >> R("r", 1), ports={"v": v})
    with pytest.raises(GraphError, match="dangling"):
        assign_causality(part)


class TestSearch:
    def test_choices_are_taken_back(self):
        """Propagation accepts the storage as integral; only the last bonds show that it cannot be."""
        a, b, u = One("a"), One("b"), Zero("u")
        result = causal(b >> TF("tf", 3) >> a, u >> a, u >> GY("gy", 2) >> b, a >> C("c", 1))
        assert result.derivative == ("c",)
        assert "not integral causality of C 'c'" in result.warnings[0]
        check_the_rules(result)

    def test_a_long_chain_of_dependent_masses_is_no_trouble(self):
        ones = [One(f"v{k}") for k in range(300)]
        gears = [a >> TF(f"tf{k}", 2) >> b for k, (a, b) in enumerate(itertools.pairwise(ones))]
        result = causal(*gears, *(one >> I(f"m{k}", 1) for k, one in enumerate(ones)))
        assert result.integral == ("m0",)
        assert len(result.derivative) == 299
        assert all(len(warning) < 200 for warning in result.warnings)


def is_valid(sketch, out):
    """Whether strokes (True: effort out of the tail) are allowed; written without the framework."""
    bonds = list(enumerate(sketch.bonds))
    for name, (kind, _) in sketch.elements.items():
        gives = [out[k] == (tail == name) for k, (tail, head) in bonds if name in (tail, head)]
        allowed = {
            "Se": gives == [True],
            "Sf": gives == [False],
            "TF": gives.count(True) == 1,
            "GY": gives.count(True) != 1,
            "0": gives.count(False) == 1,
            "1": gives.count(True) == 1,
        }
        if not allowed.get(kind, True):
            return False
    return True


def storage_strokes(sketch, out):
    """Which storages are in integral causality, in order."""
    found = []
    for name, (kind, _) in sketch.elements.items():
        if kind in "CI":
            ((k, tail),) = [(k, bond[0]) for k, bond in enumerate(sketch.bonds) if name in bond]
            found.append((out[k] == (tail == name)) == (kind == "C"))
    return found


@settings(max_examples=80, deadline=None)
@given(sketches(junctions=3, loops=2, ones=2, chain=1))
def test_the_result_is_the_best_of_all_assignments(sketch):
    """Tried against every assignment there is: earlier storages are integral where any can be."""
    assume(len(sketch.bonds) <= 11)
    valid = [
        out
        for out in itertools.product([True, False], repeat=len(sketch.bonds))
        if is_valid(sketch, out)
    ]
    graph = sketch.graph()
    if not valid:
        with pytest.raises(CausalConflictError):
            assign_causality(graph)
        return
    result = assign_causality(graph)
    check_the_rules(result)
    best = max(storage_strokes(sketch, out) for out in valid)
    assert [name in result.integral for name in sketch.of("C", "I")] == best
