"""Model files: what is saved loads again as the same model; what is malformed is named."""

from __future__ import annotations

import re
import time
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy
import pytest
import sympy
from hypothesis import HealthCheck, given, settings

from bondgraph import (
    GY,
    RS,
    TF,
    Block,
    C,
    CField,
    CheckValve,
    Clutch,
    De,
    Df,
    Diode,
    EndStop,
    Friction,
    Heat,
    I,
    ICField,
    IField,
    Integrator,
    Lag,
    One,
    R,
    RField,
    Se,
    Sf,
    Switch,
    Zero,
    assemble,
    derive,
    elements,
    in_mode,
    linearize,
    models,
)
from bondgraph.errors import (
    BondGraphError,
    GraphError,
    LawError,
    ModelError,
    ParameterError,
)
from bondgraph.files import FIELDS, KINDS, MAX_BYTES, dumps, load, loads, save
from bondgraph.graph import TIME, GraphBond
from bondgraph.parameters import Parameter

from .strategies import sketches

DOCS = Path(__file__).parents[1] / "docs"
a, b = sympy.symbols("a b", positive=True)
u = sympy.Symbol("u", real=True)


def assert_same(first, second):
    """Two graphs say the same, and give the same equations letter by letter."""
    assert first.name == second.name
    assert list(first.elements) == list(second.elements)
    assert [item.name for item in first.elements.values()] == [
        item.name for item in second.elements.values()
    ]
    assert list(map(type, first.elements.values())) == list(map(type, second.elements.values()))
    for key in ("pseudo", "power"):
        ours, theirs = (
            [str(getattr(e, key, None)) for e in g.elements.values()] for g in (first, second)
        )
        assert ours == theirs
    assert first.bonds == second.bonds
    assert list(first.outputs) == list(second.outputs)
    assert dict(first.ports) == dict(second.ports)
    assert list(first.parameters.items()) == list(second.parameters.items())
    assert list(first.inputs.items()) == list(second.inputs.items())
    assert first.signals == second.signals
    ours, theirs = derive(first), derive(second)
    for key in ("states", "inputs", "parameters", "assignments", "derivatives", "residuals"):
        assert getattr(ours, key) == getattr(theirs, key), key
    for key in ("initial", "outputs", "energies", "supplied", "dissipated", "contacts"):
        assert getattr(ours, key) == getattr(theirs, key), key


def reloaded(graph):
    """The graph after a round trip, whose text does not change on a second one."""
    text = dumps(graph)
    again = loads(text)
    assert dumps(again) == text
    return again


def around(*parts, **options):
    """A small graph about a junction with inertia and compliance beside the parts under test."""
    v = One("v")
    beside = (v >> (I("m", 2), C("k", stiffness=3)),)
    return assemble("g", *beside, *(part(v) for part in parts), **options)


@pytest.mark.parametrize("name", models.LIBRARY)
def test_library_models_survive(name, tmp_path):
    graph = getattr(models, name).graph()
    path = save(graph, tmp_path / f"{name}.toml")
    again = load(str(path))
    assert_same(graph, again)
    assert again.outputs.keys() == graph.outputs.keys()
    for key, output in graph.outputs.items():
        assert (again.outputs[key].unit, again.outputs[key].meaning) == (
            output.unit,
            output.meaning,
        )
    assert numpy.array_equal(linearize(graph).poles(), linearize(again).poles())
    ours, theirs = derive(graph), derive(again)
    for rate, found in zip(ours.derivatives, theirs.derivatives, strict=True):
        assert ours.substituted(rate) == theirs.substituted(found)


LAWS = {
    "R": lambda v: v >> R("r", 0.25),
    "R of one": lambda v: v >> R("r", 1),
    "R of zero": lambda v: v >> R("r", 0),
    "R by symbol": lambda v: v >> R("r", a * b),
    "R by effort": lambda v: v >> R("r", effort=lambda f: a * f * sympy.Abs(f)),
    "R affine": lambda v: v >> R("r", effort=lambda f: a * f + 3),
    "R by flow": lambda v: v >> R("r", flow=lambda e: sympy.sinh(e / a)),
    "R by linear flow": lambda v: v >> R("r", flow=lambda e: e / 4),
    "R by cases": lambda v: (
        v >> R("r", effort=lambda f: sympy.Piecewise((f, f < 1), (f**2, f < b), (b * f, True)))
    ),
    "C": lambda v: v >> C("c", 0.125, initial=a),
    "C of one": lambda v: v >> C("c", 1),
    "C by symbol": lambda v: v >> C("c", a / b),
    "C by stiffness": lambda v: v >> C("c", stiffness=a),
    "C without stiffness": lambda v: v >> C("c", stiffness=0),
    "C by effort": lambda v: v >> C("c", effort=lambda q: a * q + b * q**3),
    "C by sine": lambda v: v >> C("c", effort=lambda q: a * sympy.sin(q)),
    "C by energy": lambda v: v >> C("c", energy=lambda q: a * sympy.cosh(q) - a, initial=-0.1),
    "C by polynomial energy": lambda v: v >> C("c", energy=lambda q: 1 + q**2 / 2 + q**4 / 4),
    "C by energy that bends": lambda v: v >> C("c", energy=lambda q: sympy.Max(q, 0) ** 2 / 2),
    "Friction": lambda v: v >> Friction("c", kinetic=lambda s: a * sympy.exp(-s / b)),
    "Friction with breakaway": lambda v: v >> Friction("c", kinetic=lambda s: a, breakaway=2 * a),
    "Friction, smooth": lambda v: v >> Friction("c", kinetic=lambda s: a + s, smoothing=0.001),
    "Se": lambda v: Se("s", a * sympy.sin(TIME)) >> v,
    "Se by its flow": lambda v: Se("s", effort=lambda f: 3 - a * f) >> v,
    "Se, driven": lambda v: Se("s", u) >> v,
    "Sf behind R": lambda v: Sf("s", a) >> Zero("z") >> (v, R("r", 3)),
    "One, pseudo": lambda v: (
        Zero("z", pseudo=True) >> (C("c", a), One("w", pseudo=True) >> R("r", 1))
    ),
    "De": lambda v: Sf("s", a) >> Zero("z") >> (v, De("gauge")),
    "Df": lambda v: v >> Df("tachometer"),
    "Heat of a law": lambda v: (
        Heat("h", a * v.f**2, pseudo=False) >> Zero("z") >> C("c", effort=sympy.exp)
    ),
    "RS": lambda v: v >> RS("pad", a, pseudo=True) >> Zero("z") >> C("c", b, initial=293),
    "RS by effort": lambda v: (
        v >> RS("r", effort=lambda f: f**3) >> Zero("z") >> C("c", effort=sympy.exp)
    ),
    "RS of Friction": lambda v: (
        v
        >> RS(Friction("rub", kinetic=lambda s: a), pseudo=True)
        >> Zero("z")
        >> (C("c", b), R("loss", 1))
    ),
    "Block": lambda v: (
        y := Block("y", rate=lambda y: a * sympy.sin(y) - y**3 + v.f, initial=b),
        Se("s", y.y) >> v,
    ),
    "Integrator": lambda v: (
        x := Integrator("x", a * v.f + TIME, initial=2),
        v >> R("r", 1 + x.y**2),
    ),
    "Lag": lambda v: (x := Lag("x", v.f, 0.5), v >> R("r", 1 + x.y**2)),
    "Lag by symbols": lambda v: (
        Lag("x", a * v.f + b * TIME + 1, (a + b) / a, initial=a),
        v >> R("r", 1),
    ),
    "TF": lambda v: v >> TF("n", -0.2) >> One("w") >> (R("r", 1), C("c", 2)),
    "GY": lambda v: v >> GY("n", a) >> One("w") >> (R("r", 1), I("i", 2)),
}


@pytest.mark.parametrize("name", LAWS)
def test_each_law_survives(name):
    graph = around(LAWS[name], inputs={u: "V"} if "driven" in name else {})
    assert_same(graph, reloaded(graph))


def switches(v):
    """Every switching element beside a spring, a source and a resistor."""
    height = C("height", stiffness=0, initial=1)
    loop, tank = One("loop"), Zero("tank")
    return (
        Sf("drive", 1) >> Zero("z") >> (v, Clutch("clutch", a * u, static=2 * a)),
        Sf("pump", u) >> Zero("y") >> (Clutch("plain", a), R("leak", 1)),
        v >> (height, EndStop("floor", gap=height.q + b, restitution=0.5, rest=0.01)),
        v >> EndStop("wall", gap=1 - height.q, restitution=0),
        Se("mains", u) >> loop >> (Diode("diode", drop=0.6, resistance=a), R("load", 3), tank),
        tank >> (C("store", b), CheckValve("valve"), Switch("relay", closed=TIME - a)),
    )


def test_switching_elements_survive_with_all_their_numbers():
    graph = around(switches, inputs=[u])
    again = reloaded(graph)
    assert list(again.elements) == list(graph.elements)
    for name, element in graph.elements.items():
        assert str(again[name].laws) == str(element.laws), name
    for modes in (
        {"diode": "blocking", "relay": "open"},
        {"diode": "conducting", "floor": "contact"},
    ):
        rest = {"valve": "closed", "clutch": "slip+", "plain": "slip+", "wall": "free"}
        rest = {"floor": "free", "relay": "open"} | rest | modes
        assert_same(in_mode(graph, rest), in_mode(again, rest))


BEAM = {"stiffness": [[a, -2], [-2, b]]}
FIELD_LAWS = {
    "stiffness": (
        CField("x", ("one", "two"), **BEAM, initial={"two": a}),
        'stiffness = [["a", -2]',
    ),
    "compliance": (
        CField("x", ("one", "two"), compliance=[[a, 1], [1, b]]),
        'compliance = [["a", 1]',
    ),
    "singular": (CField("x", ("one", "two"), stiffness=[[1, -1], [-1, 1]]), "stiffness = [[1, -1]"),
    "no stiffness": (CField("x", ("one", "two"), energy=lambda p, q: 0), "stiffness = [[0, 0]"),
    "potential": (
        CField("x", ("one", "two"), energy=lambda p, q: a * sympy.cosh(p - q) + q**4),
        'energy = "two**4 + a*cosh(one - two)"',
    ),
    "inertance": (IField("x", ("one", "two"), inertance=[[2, b], [b, 3]]), 'inertance = [[2, "b"]'),
    "kinetic": (
        IField("x", ("one", "two"), energy=lambda p, q: sympy.sqrt(1 + p**2 + q**2)),
        'energy = "sqrt(one**2 + two**2 + 1)"',
    ),
    "solenoid": (
        ICField("x", {"one": "I", "two": "C"}, energy=lambda p, q: p**2 * (q + a) / 2),
        'ports = { one = "I", two = "C" }, energy = "one**2*(two + a)/2"',
    ),
    "resistance": (RField("x", ("one", "two"), resistance=[[a, 1], [2, b]]), "resistance = [["),
    "conductance": (
        RField("x", ("one", "two"), conductance=[[a, 0.5], [2, b]]),
        "conductance = [[",
    ),
    "efforts": (
        RField("x", ("one", "two"), effort=lambda f, g: (a * f**3 + g, sympy.Abs(g) * g)),
        'effort = { one = "one**3*a + two", two = "two*abs(two)" }',
    ),
    "flows": (
        RField("x", ("one", "two"), flow=lambda t, s: (a * (t - s) / t, a * (s - t) / s)),
        "flow = { one = ",
    ),
}


def about(field):
    """A graph in which each port of a field stands at a storage that suits it."""
    bonds = []
    for port, element in field.ports.items():
        if isinstance(element, C):
            bonds.append(One(f"at_{port}") >> (I(f"m_{port}", 2), element))
        else:
            store = C(f"c_{port}", effort=lambda q: 300 * sympy.exp(q))
            bonds.append(Zero(f"at_{port}") >> (store, element))
    return assemble("g", *bonds)


@pytest.mark.parametrize("name", FIELD_LAWS)
def test_fields_stay_fields(name):
    field, form = FIELD_LAWS[name]
    graph = about(field)
    assert form in dumps(graph)
    again = reloaded(graph)
    assert_same(graph, again)
    for port in ("x.one", "x.two"):
        for key in ("law", "energy", "inverse", "partners", "effort", "flow", "initial"):
            assert str(getattr(again[port], key, "")) == str(getattr(graph[port], key, "")), key
    if not isinstance(field, RField):
        states = {again["x.one"].state, again["x.two"].state}
        assert {*again["x.one"].partners, again["x.one"].state} == states
        assert "x" in derive(again).energies or graph["x.one"].energy == 0


def test_ports_keep_their_place_among_the_states():
    beam = CField("beam", ("tip", "middle", "root"), stiffness=[[3, 1, 0], [1, 3, 1], [0, 1, 3]])
    v, w, x = One("v"), One("w"), One("x")
    graph = assemble(
        "g",
        w >> (I("n", 1), beam["middle"]),
        x >> (beam["root"], I("o", 1)),
        v >> (beam["tip"], I("m", 1)),
    )
    assert '{ name = "beam.tip", kind = "Port" }' in dumps(graph)
    again = reloaded(graph)
    assert_same(graph, again)
    states = ["n.p", "beam.middle.q", "beam.root.q", "o.p", "beam.tip.q", "m.p"]
    assert [state.name for state in derive(again).states] == states
    assert again["beam.tip"].energy != 0 and again["beam.middle"].energy == 0


def test_fields_and_heat_in_submodels_keep_their_names():
    def axle(name):
        v, w, room = One("v"), One("w"), Zero("room", pseudo=True)
        beam = CField("beam", ("tip", "root"), **BEAM)
        return assemble(
            name,
            v >> (I("m", 1), beam["tip"], Df("speed")),
            w >> (I("n", 2), beam["root"]),
            v >> RS("pad", 20, pseudo=True) >> room >> C("heat", 500),
            ports={"v": v},
        )

    rear, front = axle("rear"), axle("front")
    graph = assemble(
        "car", rear.port("v") >> TF("n", 2) >> front.port("v"), outputs={"t": rear["room"].e}
    )
    again = reloaded(graph)
    assert_same(graph, again)
    assert {"rear.beam", "front.beam"} <= derive(again).energies.keys()
    assert (again["rear.beam.tip"].name, again["rear.pad_heat"].name) == ("beam.tip", "pad_heat")
    parent = assemble("parent", again)
    assert_same(parent, reloaded(parent))


def test_heat_of_a_dissipator_in_another_submodel_survives():
    rub, v = RS("rub", 3, pseudo=True), One("v")
    part = assemble("part", v >> (I("m", 1), rub))
    graph = assemble("whole", part, rub >> Zero("z") >> C("c", 500))
    assert 'kind = "Heat", dissipator = "part.rub", pseudo = true' in dumps(graph)
    assert_same(graph, reloaded(graph))


def test_sensors_outputs_keep_order_unit_and_meaning():
    z, gauge = Zero("z"), De("gauge")
    inner = assemble(
        "tank", Sf("s", 1) >> z >> (C("c", 2), gauge), outputs={"q": z.e**2}, ports={"z": z}
    )
    graph = assemble("g", inner.port("z") >> De("other"), outputs={"last": (z.e, "Pa")})
    assert_same(graph, reloaded(graph))
    named = replace(
        graph,
        outputs=MappingProxyType(
            {
                **graph.outputs,
                "other": replace(graph.outputs["other"], unit="Pa", meaning="pressure"),
            }
        ),
    )
    again = reloaded(named)
    assert again.outputs["other"].unit == "Pa" and again.outputs["other"].meaning == "pressure"
    assert list(again.outputs) == list(named.outputs)


@pytest.mark.parametrize("name", ["t", "pi", "f", "a", "exp", "two words", "lambda"])
def test_ports_may_have_any_name(name):
    field = CField("x", ("one", name), energy=lambda p, q: a * sympy.cosh(p - sympy.pi * q))
    v = One("v")
    graph = assemble("g", v >> (I("m", 1), field["one"]), One("w") >> (I("n", 1), field[name]))
    assert_same(graph, reloaded(graph))


def test_arrows_that_were_turned_round_survive():
    graph = around(lambda v: R("r", 1) >> v, lambda v: C("c", 2) >> v)
    assert_same(graph, reloaded(graph))
    assert graph.notes and not reloaded(graph).notes


@pytest.mark.parametrize(
    ("name", "form"),
    [
        ("R", "resistance = 0.25 "),
        ("R of one", "resistance = 1 "),
        ("R by symbol", 'resistance = "a*b"'),
        ("R by flow", 'flow = "sinh(e/a)"'),
        ("R by cases", 'effort = "where(f < 1, f, f < b, f**2, '),
        ("C of one", "stiffness = 1 "),
        ("C by stiffness", 'stiffness = "a"'),
        ("C by sine", 'effort = "a*sin(q)"'),
        ("C by energy", 'energy = "a*cosh(q) - a", initial = -0.1'),
        ("Friction", 'kinetic = "a*exp(-speed/b)" '),
        ("Friction with breakaway", 'kinetic = "a", breakaway = "2*a" '),
        ("TF", "ratio = -0.2 "),
    ],
)
def test_laws_keep_a_readable_form(name, form):
    assert form in dumps(around(LAWS[name]))


def test_every_kind_of_element_has_a_form():
    def final(kind):
        below = kind.__subclasses__()
        return {item for sub in below for item in final(sub)} if below else {kind}

    assert {kind.build for kind in KINDS.values()} == {
        kind
        for kind in final(elements.Element)
        if kind.__module__.startswith("bondgraph.elements.")
    }
    assert {kind.build for kind in FIELDS.values()} == {CField, IField, ICField, RField}


def test_modulation_by_variables_of_other_elements_survives():
    w, z = One("w"), Zero("z")
    tank, rotor = C("tank", a), I("rotor", b)
    lever = TF("lever", 2 + sympy.cos(tank.q))
    graph = assemble(
        "modulated",
        Se("drive", tank.q * rotor.f) >> w >> rotor,
        w >> lever >> z >> tank,
        z >> R("valve", effort=lambda f: f * (1 + rotor.f**2)),
        w >> R("load", rotor.p**2 + 1),
        w >> Friction("rub", kinetic=lambda speed: sympy.Abs(tank.e) * (1 + speed)),
        outputs={"power": (lever.e_in * lever.f_in, "W"), "slow": tank.q / w.f},
    )
    again = reloaded(graph)
    assert_same(graph, again)
    assert len(again.signals) == 6


def test_submodels_within_submodels_keep_their_names():
    def cell(name):
        v = One("v")
        return assemble(name, v >> (I("m", a), C("k", stiffness=b)), ports={"v": v})

    first, second = cell("first"), cell("second")
    pair = assemble(
        "pair",
        first.port("v") >> (z := Zero("z")) >> second.port("v"),
        z >> R("r", 3),
        ports={"in": first.port("v")},
        outputs={"x": first["k"].q},
    )
    graph = assemble("whole", Se("F", u) >> pair.port("in"), inputs=[u])
    again = reloaded(graph)
    assert_same(graph, again)
    assert [state.name for state in derive(again).states] == [
        "pair.first.m.p",
        "pair.first.k.q",
        "pair.second.m.p",
        "pair.second.k.q",
    ]
    assert list(again.outputs) == ["pair.x"]
    assert again["pair.first.m"].name == "m"
    assert dumps(reloaded(pair).copy("twin")).count("[ports]") == 1


def test_a_loaded_model_is_a_submodel_like_any_other():
    frame = loads(dumps(models.bicycle_brake.graph()))
    parent = assemble("parent", frame)
    assert "bicycle_brake.rear.mass" in parent.elements
    assert_same(parent, reloaded(parent))


def test_a_grafted_element_with_a_spoken_name_survives(tmp_path):
    graph = models.bicycle_brake.graph()
    extra = R("coulomb friction", effort=lambda f: a * sympy.tanh(f / b))
    name = "rear.coulomb friction"
    grafted = replace(
        graph,
        elements=MappingProxyType({**graph.elements, name: extra}),
        bonds=(*graph.bonds, GraphBond(f"rear.caliper>{name}", "rear.caliper", name)),
        parameters=MappingProxyType(
            {**graph.parameters, a: Parameter(3.0, "N"), b: Parameter(0.1)}
        ),
        outputs=MappingProxyType(
            {
                **graph.outputs,
                "lost power": replace(graph.outputs["N"], expression=extra.e * extra.f, unit="W"),
            }
        ),
    )
    again = load(save(grafted, tmp_path / "grafted.toml"))
    assert_same(grafted, again)
    assert "'rear.coulomb friction.e'" in dumps(grafted)


def test_a_graph_in_one_of_its_modes_survives():
    graph = models.mass_on_belt.graph()
    for mode in ("stick", "slip+"):
        part = in_mode(graph, {"contact": mode})
        assert_same(part, reloaded(part))


ODD = ["lambda", "f", "q", "t", "pi", "in", "rear.k", "x y", "e", "µ", "parameters", "exp", "α_1"]


@pytest.mark.parametrize("name", ODD)
def test_parameters_may_have_any_name(name):
    symbol = sympy.Symbol(name, positive=True)
    r = R("r", effort=lambda f: symbol * f**3 + sympy.pi * f)
    graph = around(
        lambda v: v >> r,
        lambda v: v >> C("c", effort=lambda q: symbol * q**3),
        parameters={symbol: Parameter(2.5, "", "odd")},
        outputs={"y": symbol * r.f + sympy.pi},
    )
    assert_same(graph, reloaded(graph))


@pytest.mark.parametrize(
    "name", ["in", "coulomb friction", "f", "t", 'x"y', "a-b", "β", "parameters", "1"]
)
def test_elements_may_have_any_name(name):
    r = R(name, effort=lambda f: a * f**3)
    graph = around(lambda v: v >> r, outputs={f"power of {name}": (r.e * r.f, "W")})
    assert_same(graph, reloaded(graph))


@pytest.mark.parametrize(
    "assumptions",
    [
        {},
        {"real": True},
        {"positive": True},
        {"nonnegative": True},
        {"negative": True},
        {"nonzero": True, "real": True},
        {"integer": True},
        {"integer": True, "positive": True},
        {"even": True, "nonnegative": True},
    ],
    ids=str,
)
def test_assumptions_are_kept(assumptions):
    symbol = sympy.Symbol("n", **assumptions)
    drive = sympy.Symbol("w", **assumptions)
    graph = around(
        lambda v: v >> R("r", symbol), lambda v: Se("s", drive) >> v, inputs={drive: "N"}
    )
    again = reloaded(graph)
    assert next(iter(again.parameters)) == symbol
    assert next(iter(again.inputs)) == drive


def test_assumptions_that_no_word_gives_are_named():
    with pytest.raises(ParameterError, match="'n' assumes what a file cannot say"):
        dumps(around(lambda v: v >> R("r", sympy.Symbol("n", positive=True, integer=False))))


def test_values_keep_their_type_unit_and_words():
    table = {
        a: Parameter(350, "N/mm", 'a "quoted"\nmeaning \x7f', "α"),
        b: Parameter(1e-18, "", "", ""),
        sympy.Symbol("c", real=True): Parameter(a / b**2 + sympy.sqrt(2)),
        sympy.Symbol("d", real=True): Parameter(),
        sympy.Symbol("h", real=True): Parameter(numpy.float64(0.1) + 0.2),
    }
    again = reloaded(around(lambda v: v >> R("r", a), parameters=table))
    rows = list(again.parameters.values())
    assert rows == [*table.values()]
    assert isinstance(rows[0].value, int) and type(rows[4].value) is float


@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(sketches())
def test_random_graphs_survive(sketch):
    graph = sketch.graph(symbolic=True)
    again = reloaded(graph)
    assert graph.bonds == again.bonds and list(graph.elements) == list(again.elements)
    try:
        expected = derive(graph)
    except BondGraphError as error:
        with pytest.raises(type(error), match=re.escape(str(error)[:60])):
            derive(again)
        return
    found = derive(again)
    assert found.assignments == expected.assignments
    assert (found.states, found.inputs) == (expected.states, expected.inputs)


def test_the_page_about_model_files_holds_a_model():
    page = (DOCS / "model_files.md").read_text(encoding="utf-8")
    winch, *others = re.findall(r"^```toml\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    graph = loads(winch)
    equations = derive(graph)
    assert [state.name for state in equations.states] == [
        "winding.p",
        "rotor.p",
        "rope.q",
        "mass.p",
    ]
    assert not equations.algebraic
    assert_same(graph, reloaded(graph))
    for text in others:
        again = loads(text)
        assert_same(again, reloaded(again))
    table = page.partition("| kind |")[2].partition("\n\n")[0]
    assert {*KINDS, *FIELDS, "RS", "Port"} <= set(re.findall(r"`(\w+)`", table))


BY_HAND = """
schema = 1
name = "by_hand"
bonds = ["source>v", "v > m", "v > k", "v > b", "v > slide", "v > n", "n > w", "w > g",
         "g > z", "z > c", "z > leak", "pump > z"]
parameters.k = "2*m**2"       # short for { value = ... }
parameters.m = 0.5
inputs.F = "N"
outputs.x = "k.q"

[[elements]]
name = "source"
kind = "Se"
effort = '''
  F*where(
    t < 1, 0,
    1)'''

[[elements]]
name = "v"
kind = "1"
[[elements]]
name = "m"
kind = "I"
inertance = "parameters.m"
initial = 0.25
[[elements]]
name = "k"
kind = "C"
energy = "parameters.k*q**2/2 + q**4"
[[elements]]
name = "b"
kind = "R"
effort = "sign(f)*f**2"
[[elements]]
name = "slide"
kind = "Friction"
kinetic = "2 + exp(-speed)"
breakaway = 4
[[elements]]
name = "n"
kind = "TF"
ratio = 0.2
[[elements]]
name = "w"
kind = "One"
[[elements]]
name = "g"
kind = "GY"
ratio = "1 + k.q**2"
[[elements]]
name = "z"
kind = "0"
[[elements]]
name = "c"
kind = "C"
capacitance = 2
[[elements]]
name = "leak"
kind = "R"
flow = "max(e, 0)"
[[elements]]
name = "pump"
kind = "Sf"
flow = "0.1*sin(pi*t)"
"""


def test_files_written_by_hand_hold_every_kind():
    made = [*loads(BY_HAND).elements.values(), *loads(SWITCHED_BY_HAND).elements.values()]
    assert {type(element) for element in made} == {kind.build for kind in KINDS.values()}


def test_a_file_written_by_hand():
    graph = loads(BY_HAND)
    k, m = sympy.symbols("k m", real=True)
    assert graph.parameters == {k: Parameter(2 * m**2), m: Parameter(0.5)}
    spring = graph["k"]
    assert spring.law == k * spring.q + 4 * spring.q**3
    assert graph["slide"].breakaway == 4
    assert graph["source"].effort == sympy.Symbol("F", real=True) * sympy.Piecewise(
        (0, TIME < 1), (1, True)
    )
    assert graph["pump"].flow == sympy.sin(sympy.pi * TIME) / 10
    assert [state.name for state in derive(graph).states] == [
        "m.p",
        "k.q",
    ]  # the gyrator turns c into an inertia
    assert_same(graph, reloaded(graph))


SWITCHED_BY_HAND = """
schema = 1
name = "press"
bonds = ["motor > z", "z > plates", "z > v", "v > ram", "v > way", "v > die", "v > speed",
         "v > pad", "pad_heat > steel", "steel > mass", "plates_heat > steel", "steel > thermometer",
         "mains > loop", "loop > d", "loop > relay", "loop > r", "w > s.coil", "v > s.gap", "v > stay.a",
         "w > turn", "turn > loop", "w > stay.b", "w > coils.one", "w > inlet", "loop > coils.two",
         "w > web.one", "loop > web.two", "rub_heat > steel", "v > rub"]

[[elements]]
name = "motor"
kind = "Sf"
flow = "control.y"
[[elements]]
name = "z"
kind = "0"
[[elements]]
name = "plates"
kind = "Clutch"
capacity = "10*(1 + gauge.y**2)"
[[elements]]
name = "plates_heat"
kind = "Heat"
dissipator = "plates"
pseudo = true
[[elements]]
name = "v"
kind = "One"
[[elements]]
name = "ram"
kind = "I"
inertance = 2
[[elements]]
name = "way"
kind = "C"
stiffness = 0
[[elements]]
name = "die"
kind = "EndStop"
gap = "0.5 - way.q"
restitution = 0.2
[[elements]]
name = "speed"
kind = "Df"
[[elements]]
name = "pad"
kind = "RS"
effort = "3*f*abs(f)"
pseudo = true
[[elements]]
name = "steel"
kind = "Zero"
pseudo = true
[[elements]]
name = "mass"
kind = "C"
capacitance = 500
initial = 500
[[elements]]
name = "thermometer"
kind = "De"
[[elements]]
name = "mains"
kind = "Se"
effort = 12
[[elements]]
name = "loop"
kind = "One"
[[elements]]
name = "d"
kind = "Diode"
drop = 0.6
[[elements]]
name = "relay"
kind = "Switch"
closed = "1 - t"
[[elements]]
name = "r"
kind = "R"
resistance = 3
[[elements]]
name = "w"
kind = "1"
[[elements]]
name = "turn"
kind = "TF"
ratio = 2
[[elements]]
name = "inlet"
kind = "CheckValve"
[[elements]]
name = "s"
kind = "ICField"
ports = { coil = "I", gap = "C" }
energy = "coil**2*(1 + gap)/2"
initial.gap = 0.25
[[elements]]
name = "stay"
kind = "CField"
ports = ["a", "b"]
stiffness = [[2, -1], [-1, "1 + t*0"]]
[[elements]]
name = "coils"
kind = "IField"
ports = ["one", "two"]
inertance = [[2, 1], [1, 2]]
[[elements]]
name = "web"
kind = "RField"
ports = ["one", "two"]
effort = { one = "one + two**3", two = "2*two" }
[[elements]]
name = "rub"
kind = "Friction"
kinetic = 3
[[elements]]
name = "rub_heat"
kind = "Heat"
power = "rub.e*rub.f"
pseudo = true
[[elements]]
name = "control"
kind = "Block"
rate = "3 - y - v.f"
[[elements]]
name = "gauge"
kind = "Lag"
signal = "v.f"
time_constant = 0.5
[[elements]]
name = "way_sum"
kind = "Integrator"
signal = "speed.f"
initial = 1
"""


def test_a_hand_written_file_means_what_it_says():
    graph = loads(SWITCHED_BY_HAND)
    coil, gap = graph["s.coil"], graph["s.gap"]
    assert (coil.law, gap.law) == (coil.p * (1 + gap.q), coil.p**2 / 2)
    assert sympy.expand(
        coil.energy - coil.p**2 * (1 + gap.q) / 2
    ) == 0 and gap.initial == sympy.Rational(1, 4)
    one, two = graph["coils.one"], graph["coils.two"]
    assert sympy.expand(one.law - (2 * one.p - two.p) / 3) == 0
    assert graph["web.one"].effort == graph["web.one"].f + graph["web.two"].f ** 3
    assert graph["pad_heat"].flow == graph["pad"].e * graph["pad"].f
    assert graph["steel"].pseudo and not graph["z"].pseudo
    assert graph["die"].gap == sympy.Rational(1, 2) - graph["way"].q
    assert graph["gauge"].rate == 2 * graph["v"].f - 2 * graph["gauge"].y
    assert graph["control"].rate == 3 - graph["control"].y - graph["v"].f
    assert list(graph.outputs) == ["speed", "thermometer"]
    text = dumps(graph)
    assert 'name = "rub_heat", kind = "Heat", dissipator = "rub"' in text
    assert dumps(loads(text)) == text


GOOD = """
schema = 1
name = "msd"
elements = [
  { name = "F", kind = "Se", effort = "u" },
  { name = "v", kind = "One" },
  { name = "m", kind = "I", inertance = "M" },
  { name = "k", kind = "C", stiffness = "K", initial = 0.1 },
  { name = "b", kind = "R", effort = "B*f" },
]
bonds = ["F > v", "v > m", "v > k", "v > b"]
[ports]
v = "v"
[parameters]
M = { value = 2.0, unit = "kg", assume = "positive" }
K = { value = "8*M", meaning = "stiffness", source = "test" }
B = 0.5
[inputs]
u = { unit = "N" }
[outputs]
x = { expression = "k.q", unit = "m" }
"""

MALFORMED = {
    "no TOML": ("schema = 1", "schema = ", ModelError, "no valid TOML"),
    "key twice": ('name = "msd"', 'name = "msd"\nname = "x"', ModelError, "no valid TOML"),
    "no schema": ("schema = 1", "", ModelError, "schema is 'missing'"),
    "later schema": ("schema = 1", "schema = 2", ModelError, "reads schema = 1"),
    "schema true": ("schema = 1", "schema = true", ModelError, "schema is True"),
    "no name": ('name = "msd"', "", ModelError, "name is missing"),
    "number as name": ('name = "msd"', "name = 3", ModelError, "name is 3"),
    "dot in name": ('"msd"', '"m.s"', GraphError, "plain name"),
    "unknown table": ("[ports]", "[extra]\n[ports]", ModelError, "unknown key 'extra'"),
    "misspelt table": ("[outputs]", "[output]", ModelError, "did you mean outputs"),
    "no elements": (r"elements = \[.*?\n\]", "", ModelError, "elements is no list"),
    "elements as table": (
        r"elements = \[.*?\n\]",
        "elements = {}",
        ModelError,
        "elements is no list",
    ),
    "element as text": (r'{ name = "v".*?}', '"v"', ModelError, "entry 2: expected a table"),
    "element without name": ('name = "v", ', "", ModelError, "entry 2, name is missing"),
    "element twice": (
        'name = "k", kind',
        'name = "m", kind',
        GraphError,
        "element 'm' is there twice",
    ),
    "empty name": ('name = "v"', 'name = " "', GraphError, "no empty part"),
    "empty part": ('name = "v"', 'name = "a..v"', GraphError, "no empty part"),
    "arrow in name": ('name = "v"', 'name = "a>v"', GraphError, "no '>'"),
    "no kind": (', kind = "One"', "", ModelError, "element 'v': kind None is not known"),
    "unknown kind": ('"One"', '"Onne"', ModelError, "did you mean One"),
    "kind as list": ('"One"', '["One"]', ModelError, "is not known"),
    "unknown law": (
        "inertance",
        "inertia",
        ModelError,
        "unknown key 'inertia'; did you mean inertance",
    ),
    "law of another kind": (
        "inertance",
        "stiffness",
        ModelError,
        "element 'm' (I): unknown key 'stiffness'",
    ),
    "two laws": ('stiffness = "K"', 'stiffness = "K", capacitance = 1', LawError, "exactly one of"),
    "no law": (', effort = "B*f"', "", LawError, "R 'b' takes exactly one of"),
    "no effort": (', effort = "u"', "", LawError, "element 'F' (Se) needs the key 'effort'"),
    "law as list": ('"B*f"', "[1]", LawError, "element 'b', effort: expected a finite number"),
    "law is true": ('"B*f"', "true", LawError, "got True"),
    "law is nan": ('"B*f"', "nan", LawError, "got nan"),
    "law is infinite": ('"B*f"', "-inf", LawError, "got -inf"),
    "law is a date": ('"B*f"', "2020-01-01", LawError, "expected a finite number"),
    "law is huge": ('"B*f"', "1" + "0" * 400, LawError, "expected a finite number"),
    "unknown parameter": (
        '"B*f"',
        '"BB*f"',
        LawError,
        "element 'b', effort: column 1 of 'BB*f': the name 'BB'",
    ),
    "bare letter of another": ('"B*f"', '"B*q"', LawError, "the name 'q' is not known"),
    "code in a law": ('"B*f"', "\"__import__('os')\"", LawError, "there is no function"),
    "growth in a law": ('"B*f"', '"9**9**9**9*f"', LawError, "the exponent"),
    "zero capacitance": ('stiffness = "K"', "capacitance = 0", LawError, "capacitance is zero"),
    "division by zero": ('stiffness = "K"', 'stiffness = "1/0"', LawError, "divides by zero"),
    "initial by text": ("initial = 0.1", 'initial = "start"', LawError, "element 'k', initial"),
    "bonds as text": (r"bonds = \[.*?\]", 'bonds = "F > v"', ModelError, "bonds is no list"),
    "bond as number": ('"F > v"', "3", ModelError, "bonds, entry 1 is 3"),
    "bond of one": ('"F > v"', '"F"', ModelError, "'F' is no bond"),
    "bond of three": ('"F > v"', '"F > v > m"', ModelError, "is no bond"),
    "bond backwards": ('"F > v"', '"F < v"', ModelError, "power from a to b"),
    "bond to nowhere": ('"F > v"', '"F > vv"', GraphError, "no element 'vv'; did you mean v"),
    "bond twice": ('"F > v"', '"F > v", "v > F"', GraphError, "bonded 2 times"),
    "no bond": ('"F > v", ', "", GraphError, "Se 'F' has no bond"),
    "port of nothing": ('v = "v"', 'v = "w"', GraphError, "ports, 'v': there is no element 'w'"),
    "port of a mass": ('v = "v"', 'v = "m"', GraphError, "port 'v' must be a junction"),
    "port as number": ('v = "v"', "v = 1", ModelError, "ports, 'v' is 1"),
    "unknown word": ("meaning", "meanning", ModelError, "parameters, 'K': unknown key 'meanning'"),
    "dotted key": ("B = 0.5", "B = 0.5\nrear.k = 3", ModelError, "stands in quotes"),
    "value as list": (
        "value = 2.0",
        "value = [2.0]",
        ParameterError,
        "parameters, 'M', value: expected",
    ),
    "value true": ("value = 2.0", "value = true", ParameterError, "got True"),
    "value nan": ("value = 2.0", "value = nan", ParameterError, "got nan"),
    "value unknown": ('"8*M"', '"8*N"', LawError, "parameters, 'K', value: column 3"),
    "value of a state": ('"8*M"', '"8*k.q"', LawError, "the name 'k.q' is not known"),
    "value in time": ('"8*M"', '"8*t"', ParameterError, "a parameter is constant"),
    "unknown unit": ('unit = "kg"', 'unit = "kgg"', ParameterError, "parameters, 'M': unit 'kgg'"),
    "unit that grows": ('unit = "kg"', 'unit = "9**9**9**9"', ParameterError, "cannot be read"),
    "unit that towers": ('unit = "kg"', 'unit = "m**9**9"', ParameterError, "cannot be read"),
    "unit too long": ('unit = "kg"', f'unit = "{"m" * 5000}"', ParameterError, "cannot be read"),
    "unit as number": ('unit = "kg"', "unit = 1", ModelError, "parameters, 'M', unit is 1"),
    "unknown assumption": ('"positive"', '"positiv"', ParameterError, "assume = 'positiv'"),
    "assumption as number": ('"positive"', "1", ParameterError, "assume = 1"),
    "contradiction": (
        '"positive"',
        '["positive", "negative"]',
        ParameterError,
        "contradicts itself",
    ),
    "no name for it": ("B = 0.5", 'B = 0.5\n"" = 1', ParameterError, "the name is empty"),
    "input and parameter": (
        "u = {",
        "B = {}\nu = {",
        ParameterError,
        "inputs, 'B' is a parameter too",
    ),
    "input unit": ('unit = "N"', 'unit = "NN"', ParameterError, "inputs, 'u': unit 'NN'"),
    "input with value": ('unit = "N"', "value = 3", ModelError, "inputs, 'u': unknown key 'value'"),
    "output of nothing": ('"k.q"', '"k.p"', LawError, "outputs, 'x', expression: column 1"),
    "output without expression": (
        'expression = "k.q", ',
        "",
        LawError,
        "outputs, 'x', expression: expected",
    ),
    "output unit": ('unit = "m"', 'unit = "mmm"', ParameterError, "outputs, 'x': unit 'mmm'"),
    "two meanings": ("B = 0.5", "B = 0.5\nf = 1", LawError, "write 'parameters.f'"),
    "long key": ("B = 0.5", "B" + ".b" * 100_000 + " = 1", ModelError, "more than 50 parts"),
    "long quoted key": ("B = 0.5", "B" + '."!" ' * 100_000 + "= 1", ModelError, "more than 50"),
    "nested": ("B = 0.5", "B = " + "[" * 5000 + "]" * 5000, ModelError, "nested too deep"),
}


@pytest.mark.parametrize("name", MALFORMED)
def test_malformed_files_are_named(name, tmp_path):
    old, new, kind, words = MALFORMED[name]
    text = re.sub(
        old if "\\" in old or ".*" in old else re.escape(old),
        lambda _: new,
        GOOD,
        count=1,
        flags=re.DOTALL,
    )
    assert text != GOOD
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    start = time.process_time()
    with pytest.raises(BondGraphError) as caught:
        load(path)
    assert time.process_time() - start < 1.5
    message = str(caught.value)
    assert type(caught.value) is kind, message
    assert message.startswith(f"{path}: ") and words in message
    assert len(message.splitlines()) == 1 and len(message) < 1100


LINK = """
schema = 1
name = "link"
elements = [
  { name = "v", kind = "One" },
  { name = "m", kind = "I", inertance = 1 },
  { name = "w", kind = "One" },
  { name = "n", kind = "I", inertance = 1 },
  { name = "x", kind = "CField", ports = ["one", "two"], stiffness = [["k", -1], [-1, "k"]], initial = { one = 0.1 } },
  { name = "wall", kind = "RField", ports = ["hot", "cold"], effort = { hot = "hot**3", cold = "2*cold" } },
  { name = "s", kind = "ICField", ports = { coil = "I", gap = "C" }, energy = "coil**2*(1 + gap)" },
  { name = "z", kind = "Zero", pseudo = true },
  { name = "pad", kind = "RS", resistance = 3, pseudo = true },
  { name = "rub", kind = "Clutch", capacity = 2 },
  { name = "rub_heat", kind = "Heat", dissipator = "rub", pseudo = true },
  { name = "stop", kind = "EndStop", gap = 1, restitution = 0.5 },
  { name = "relay", kind = "Switch", closed = "t" },
  { name = "lag", kind = "Lag", signal = "v.f", time_constant = 2 },
  { name = "gauge", kind = "De" },
  { name = "s.gap", kind = "Port" },
]
bonds = ["v > m", "w > n", "v > x.one", "w > x.two", "v > wall.hot", "w > wall.cold", "v > s.coil",
         "w > s.gap", "v > pad", "v > rub", "pad_heat > z", "rub_heat > z", "v > stop", "v > relay", "z > gauge"]
parameters.k = 2
"""
MATRIX = '[["k", -1], [-1, "k"]]'
EFFORT = '{ hot = "hot**3", cold = "2*cold" }'
MALFORMED_FIELDS = {
    "row missing": (MATRIX, '[["k", -1]]', ModelError, "'x', stiffness has 1 row; 2 ports need"),
    "row short": (
        MATRIX,
        '[["k", -1], [-1]]',
        ModelError,
        "stiffness, row 2 is [-1]; 2 ports need",
    ),
    "no matrix": (MATRIX, '"k"', ModelError, "stiffness is 'k'; write a matrix"),
    "not symmetric": (
        MATRIX,
        '[["k", -1], [1, "k"]]',
        LawError,
        "'x': the stiffness matrix is not",
    ),
    "singular": (f"stiffness = {MATRIX}", "compliance = [[1, 1], [1, 1]]", LawError, "is singular"),
    "entry": (MATRIX, '[["kk", -1], [-1, 1]]', LawError, "stiffness, row 1, column 1: column 1"),
    "code": (MATRIX, "[[\"exec('1')\", -1], [-1, 1]]", LawError, "there is no function"),
    "no law": (f"stiffness = {MATRIX}, ", "", LawError, "CField 'x' takes exactly one of"),
    "two laws": ("stiffness = ", 'energy = "one", stiffness = ', LawError, "exactly one of"),
    "law of another": ("stiffness = ", "inertance = ", ModelError, "unknown key 'inertance'"),
    "no ports": (
        'ports = ["one", "two"], ',
        "",
        ModelError,
        "'x' (CField): ports is missing; write",
    ),
    "ports as text": ('ports = ["one", "two"]', 'ports = "one"', ModelError, "ports is 'one'"),
    "ports as table": ('["one", "two"]', '{ one = "C" }', ModelError, "write ports = ["),
    "ports as list": ('{ coil = "I", gap = "C" }', '["coil"]', ModelError, "write ports = { coil"),
    "port of no kind": ('gap = "C"', 'gap = "R"', ModelError, "port 'gap' is 'R'; write \"C\""),
    "port twice": ('["one", "two"]', '["one", "one"]', ModelError, "a port is there twice"),
    "port as number": ('["one", "two"]', "[1, 2]", ModelError, "give names in quotes"),
    "one port": (
        '["one", "two"], stiffness = ' + MATRIX,
        '["one"], stiffness = [[1]]',
        GraphError,
        "two ports",
    ),
    "dot in port": ('["one", "two"]', '["one", "t.o"]', GraphError, "'.' and '>' are kept"),
    "bond to no port": ('"w > x.two"', '"w > x.too"', GraphError, "did you mean x.two"),
    "bond to a field": (
        '"w > x.two"',
        '"w > x"',
        GraphError,
        "'x' has ports; name one of x.one, x.two",
    ),
    "port without bond": (', "w > x.two"', "", GraphError, "C 'x.two' has no bond"),
    "initial of no port": (
        "{ one = 0.1 }",
        "{ on = 0.1 }",
        ModelError,
        "no port 'on'; did you mean one",
    ),
    "initial as number": ("{ one = 0.1 }", "0.1", ModelError, "write initial = { one = ..., two"),
    "formula missing": (EFFORT, '{ hot = "hot" }', ModelError, "port 'cold' has no formula"),
    "formula too many": (EFFORT, "{ hot = 1, cold = 2, out = 3 }", ModelError, "no port 'out'"),
    "formula of no name": ("2*cold", "2*cool", LawError, "effort, port 'cold': column 3"),
    "no energy": (', energy = "coil**2*(1 + gap)"', "", LawError, "needs the key 'energy'"),
    "place of no port": (
        '"s.gap", kind',
        '"s.gp", kind',
        ModelError,
        "no field has this port; did you mean s.gap",
    ),
    "place with a law": (
        'kind = "Port"',
        'kind = "Port", stiffness = 1',
        ModelError,
        "'s.gap' (Port): unknown",
    ),
    "field twice": ('name = "wall", kind', 'name = "x", kind', GraphError, "'x' is there twice"),
    "port and element": ('name = "lag"', 'name = "x.one"', GraphError, "'x.one' is there twice"),
    "heat and element": (
        'name = "lag"',
        'name = "pad_heat"',
        GraphError,
        "'pad_heat' is there twice",
    ),
    "RS without a law": (
        "resistance = 3, ",
        "",
        LawError,
        "element 'pad' (RS) has no law; give resistance",
    ),
    "RS by dissipator": (
        "resistance = 3",
        'dissipator = "rub"',
        ModelError,
        "unknown key 'dissipator'",
    ),
    "pseudo as text": (
        "pseudo = true }",
        'pseudo = "yes" }',
        ModelError,
        "pseudo is 'yes'; write true or false",
    ),
    "heat of nothing": (
        'dissipator = "rub", ',
        "",
        LawError,
        "takes exactly one of dissipator, power",
    ),
    "heat of two": (
        'dissipator = "rub"',
        'dissipator = "rub", power = 3',
        LawError,
        "exactly one of",
    ),
    "heat of a mass": (
        'dissipator = "rub"',
        'dissipator = "m"',
        GraphError,
        "there is no dissipator 'm'",
    ),
    "heat of a number": ('dissipator = "rub"', "dissipator = 3", ModelError, "dissipator is 3"),
    "no gap": ("gap = 1, ", "", LawError, "element 'stop' (EndStop) needs the key 'gap'"),
    "restitution": ("restitution = 0.5", "restitution = 2", LawError, "between 0 and 1"),
    "no signal": (', closed = "t"', "", LawError, "needs the key 'closed'"),
    "time constant": ("time_constant = 2", "time_constant = 0", LawError, "must be positive"),
    "sensor with a law": (
        'kind = "De"',
        'kind = "De", flow = 0',
        ModelError,
        "'gauge' (De): unknown key",
    ),
    "output of a sensor's name": (
        "parameters.k = 2",
        'parameters.k = 2\noutputs.gauge = "v.f"',
        GraphError,
        "has the name of a sensor",
    ),
    "too many ports": (
        '["one", "two"]',
        str([f"p{i}" for i in range(50)]),
        ModelError,
        "40 at most",
    ),
}


@pytest.mark.parametrize("name", MALFORMED_FIELDS)
def test_malformed_fields_heat_and_switches_are_named(name):
    old, new, kind, words = MALFORMED_FIELDS[name]
    assert old in LINK
    with pytest.raises(BondGraphError) as caught:
        loads(LINK.replace(old, new, 1))
    message = str(caught.value)
    assert type(caught.value) is kind, message
    assert message.startswith("model: ") and words in message, message
    assert len(message.splitlines()) == 1 and len(message) < 1100


def test_a_matrix_that_would_swell_is_refused_or_quick():
    ports = [f"p{index}" for index in range(6)]
    rows = [[f"a{min(i, j)}{max(i, j)}" for j in range(6)] for i in range(6)]
    row = f'name = "x", kind = "CField", ports = {ports}, compliance = {rows}'
    names = "\n".join(f"parameters.{name} = 1" for name in {entry for row in rows for entry in row})
    text = LINK.replace("elements = [", f"elements = [{{ {row.replace('x', 'y', 1)} }},") + names
    with pytest.raises(
        LawError, match="is inverted in numbers only; give numbers, or stiffness or"
    ):
        loads(text)


def test_the_text_that_the_malformed_fields_come_from_is_good():
    text = dumps(loads(LINK))
    assert dumps(loads(text)) == text


def test_the_text_that_the_malformed_ones_come_from_is_good():
    graph = loads(GOOD)
    assert_same(graph, reloaded(graph))


@pytest.mark.parametrize("table", ["ports", "parameters", "inputs", "outputs"])
def test_what_must_be_a_table_is_named(table):
    head = GOOD.partition("[ports]")[0]
    with pytest.raises(ModelError, match=rf"model: {table}: expected a table, got \[\]"):
        loads(f"{head}\n{table} = []")


def test_an_element_at_fault_is_carried_by_the_error():
    with pytest.raises(LawError) as caught:
        loads(GOOD.replace(', effort = "B*f"', ""))
    assert caught.value.elements == ("b",)


def test_files_that_are_none_are_named(tmp_path):
    with pytest.raises(ModelError, match="no such file"):
        load(tmp_path / "none.toml")
    with pytest.raises(ModelError, match="this is no file"):
        load(tmp_path)
    path = tmp_path / "x.toml"
    path.write_bytes(b"name = '\xff'")
    with pytest.raises(ModelError, match="byte 8 is not UTF-8"):
        load(path)
    path.write_bytes(b"#" * (MAX_BYTES + 1))
    with pytest.raises(ModelError, match="larger than 5 MB"):
        load(path)
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert load(path).name == "msd"


def test_what_cannot_be_saved_leaves_the_old_file_alone(tmp_path):
    path = tmp_path / "model.toml"
    path.write_text("old")
    bad = around(lambda v: v >> R("r", effort=sympy.gamma))
    with pytest.raises(LawError, match="element 'r': gamma in gamma"):
        save(bad, path)
    with pytest.raises(ParameterError, match="would not load again"):
        save(around(lambda v: v >> R("r", a), parameters={a: (1, "blub")}), path)
    assert path.read_text() == "old"
    with pytest.raises(ModelError, match="cannot be written"):
        save(loads(GOOD), tmp_path / "no" / "folder.toml")


def test_an_element_without_a_form_is_named():
    class Memristor(R):
        pass

    with pytest.raises(ModelError, match="a Memristor has no form"):
        dumps(around(lambda v: v >> Memristor("r", 1)))
