"""Drawings: strokes and half arrows where they belong, nothing on top of anything."""

from __future__ import annotations

import itertools
import math
import xml.etree.ElementTree as ET

import pytest
import sympy
from hypothesis import given, settings

from bondgraph import GY, TF, C, I, One, R, Se, Sf, Zero, assemble, assign_causality, models
from bondgraph.draw import layout, to_svg
from bondgraph.draw.geometry import samples
from bondgraph.draw.svg import STROKE
from bondgraph.models import LIBRARY

from .strategies import sketches

SVG = "{http://www.w3.org/2000/svg}"


def ladder(cells, inductive=False):
    parts, before = [], Se("E", 1)
    for number in range(cells):
        one, zero = One(f"i{number}"), Zero(f"u{number}")
        series = I(f"l{number}", 1) if inductive else R(f"r{number}", 1)
        parts += [before >> one >> zero >> C(f"c{number}", 1), one >> series]
        before = zero
    return assemble("ladder", parts)


def mass_spring_damper():
    v = One("v")
    return assemble("msd", Se("F", 1) >> v >> (I("m", 2), C("k", 1), R("b", 1)))


def motor():
    i, w = One("i"), One("w")
    armature = Se("battery", 12) >> i >> (R("winding", 1), I("coil", 1))
    return assemble("motor", armature, i >> GY("k_m", 0.05) >> w >> (I("rotor", 1), R("drag", 1)))


def pendulum():
    angle, w = C("angle", effort=lambda q: 0 * q), One("w")
    weight = Se("weight", 9.81) >> One("drop") >> TF("arm", sympy.sin(angle.q)) >> w
    return assemble("pendulum", weight, w >> (I("inertia", 1), angle))


def bridge():
    """Five resistors and a source: a graph with a ring."""
    top, left, right = Zero("top"), Zero("left"), Zero("right")
    parts = [Se("E", 1) >> One("supply") >> top, left >> R("r3", 1), right >> C("c4", 1)]
    for name, (a, b) in {"r1": (top, left), "r2": (top, right), "r5": (left, right)}.items():
        branch = One(f"o_{name}")
        parts += [a >> branch >> b, branch >> R(name, 1)]
    return assemble("bridge", parts)


def twice_joined():
    x, y = One("x"), Zero("y")
    return assemble("g", Se("E", 1) >> x >> y >> C("c", 1), x >> TF("t", 2) >> y)


def star():
    kinds = [I, I, C, C, C, R, R, R]
    ones = [kind(f"part{number}", 1) for number, kind in enumerate(kinds)]
    return assemble("star", Se("F", 1) >> One("hub") >> ones)


def branched():
    row = [One("a"), Zero("b"), One("c"), Zero("d")]
    parts = [Sf("in", 1) >> row[0] >> row[1] >> row[2] >> row[3] >> R("load", 1)]
    for number, at in enumerate(row):
        node, far = One(f"node{number}"), Zero(f"far{number}")
        parts += [at >> TF(f"gear{number}", 2) >> node >> (C(f"spring{number}", 1), far)]
        parts += [
            node >> R(f"damper{number}", 1),
            far >> (C(f"end{number}", 1), I(f"m{number}", 2)),
        ]
    return assemble("branched", parts)


GRAPHS = {name: getattr(models, name).graph for name in LIBRARY} | {
    "ladder": lambda: ladder(10),
    "inductive ladder": lambda: ladder(10, inductive=True),
    "mass, spring, damper": mass_spring_damper,
    "motor": motor,
    "pendulum": pendulum,
    "bridge": bridge,
    "joined twice": twice_joined,
    "star": star,
    "branched": branched,
    "two one-ports": lambda: assemble("g", Se("E", 1) >> C("c", 1)),
    "two-port alone": lambda: assemble("g", Se("E", 1) >> TF("n", 2) >> R("r", 1)),
}


@pytest.fixture(scope="module", params=sorted(GRAPHS))
def causal(request):
    return assign_causality(GRAPHS[request.param]())


@pytest.fixture(scope="module")
def drawing(causal):
    return layout(causal)


def boxes(drawing):
    """Every label and caption with its owner."""
    return [(name, box) for name, node in drawing.nodes.items() for box in node.boxes]


def assert_no_labels_overlap(drawing):
    for (first, a), (second, b) in itertools.combinations(boxes(drawing), 2):
        assert not a.overlaps(b), (first, second)


def points_of(element):
    return [tuple(map(float, pair.split(","))) for pair in element.get("points").split()]


def drawn_bonds(svg):
    """Bond name to its parts by class."""
    found = {}
    for group in ET.fromstring(svg).iter(f"{SVG}g"):
        if group.get("data-bond") is not None:
            parts = {part.get("class"): part for part in group}
            assert len(parts) == len(list(group))
            found[group.get("data-bond")] = parts
    return found


class TestPlaces:
    def test_no_labels_overlap(self, drawing):
        assert_no_labels_overlap(drawing)

    def test_no_bond_crosses_a_label(self, causal, drawing):
        for line in (*drawing.bonds, *drawing.signals):
            for name, box in boxes(drawing):
                inner = box.grown(-1)
                assert not any(inner.contains(point) for point in samples(line.points, 3)), (
                    line.name,
                    name,
                )

    def test_bonds_end_near_their_elements(self, causal, drawing):
        for bond, line in zip(causal.graph.bonds, drawing.bonds, strict=True):
            ends = ((bond.tail, line.points[0]), (bond.head, line.points[-1]))
            for name, point in ends:
                assert drawing.nodes[name].box.grown(20).contains(point)
            assert math.dist(*line.points[-2:]) > 15 and math.dist(*line.points[:2]) > 15

    def test_everything_lies_in_the_frame(self, drawing):
        frame = drawing.frame
        for _, box in boxes(drawing):
            assert frame.x0 <= box.x0 and box.x1 <= frame.x1
            assert frame.y0 <= box.y0 and box.y1 <= frame.y1
        for line in (*drawing.bonds, *drawing.signals):
            assert all(frame.contains(point) for point in line.points)

    @settings(max_examples=25, deadline=None)
    @given(sketches())
    def test_random_graphs(self, sketch):
        graph = sketch.graph()
        drawing = layout(graph)
        assert set(drawing.nodes) == set(graph.elements)
        assert len(drawing.bonds) == len(graph.bonds)
        assert_no_labels_overlap(drawing)


class TestTextbook:
    """The conventions of textbooks: rows, I up, C and R down, sources at the ends."""

    def test_cross(self):
        nodes = layout(mass_spring_damper()).nodes
        v = nodes["v"].at
        assert nodes["m"].at[0] == nodes["k"].at[0] == v[0]
        assert nodes["m"].at[1] < v[1] < nodes["k"].at[1]
        assert nodes["F"].at[0] < v[0] < nodes["b"].at[0]
        assert nodes["F"].at[1] == nodes["b"].at[1] == v[1]

    def test_brake_has_its_chain_in_one_row_from_the_road_on(self):
        drawing = layout(models.bicycle_brake.graph())
        chain = ["wheel.road", "wheel.rim", "wheel.torque", "wheel.hub", "rotor_radius", "pads"]
        chain += ["rear.caliper", "rear.damping"]
        places = [drawing.nodes[name].at for name in chain]
        assert {y for _, y in places} == {places[0][1]}
        assert [x for x, _ in places] == sorted(x for x, _ in places)

    def test_modulation_comes_straight_from_below(self):
        drawing = layout(models.bicycle_brake.graph())
        (signal,) = drawing.signals
        assert signal.name == "line.fluid.e>friction"
        (x0, y0), (x1, y1) = signal.points
        assert x0 == x1 and y0 > y1

    def test_ladder(self):
        nodes = layout(ladder(10, inductive=True)).nodes
        row = nodes["i0"].at[1]
        assert all(nodes[f"{kind}{n}"].at[1] == row for kind in "iu" for n in range(10))
        assert all(nodes[f"l{n}"].at[1] < row for n in range(10))
        assert all(nodes[f"c{n}"].at[1] > row for n in range(9))

    def test_modulated_elements_are_marked(self):
        assert layout(pendulum()).nodes["arm"].label == "MTF"
        assert layout(models.bicycle_brake.graph()).nodes["friction"].label == "MR : friction"
        assert layout(models.mass_on_belt.graph()).nodes["contact"].label == "R : contact"


class TestSvg:
    def test_well_formed(self, causal):
        root = ET.fromstring(to_svg(causal))
        assert root.tag == f"{SVG}svg" and root.get("role") == "img"
        assert causal.graph.name in root.find(f"{SVG}title").text
        assert all(bond.tail in root.find(f"{SVG}desc").text for bond in causal.graph.bonds)
        low = [float(number) for number in root.get("viewBox").split()]
        assert low[:2] == [0, 0] and min(low[2:]) > 0

    def test_every_bond_has_one_stroke_at_the_right_end(self, causal):
        drawn = drawn_bonds(to_svg(causal))
        assert list(drawn) == [bond.name for bond in causal.graph.bonds]
        for bond, stroke in zip(causal.graph.bonds, causal.strokes, strict=True):
            line = points_of(drawn[bond.name]["bond"])
            ends = points_of(drawn[bond.name]["stroke"])
            middle = tuple(sum(values) / 2 for values in zip(*ends, strict=True))
            end = line[-1] if stroke.effort_out_of == bond.tail else line[0]
            assert math.dist(middle, end) < 0.2
            assert math.dist(*ends) == pytest.approx(2 * STROKE, abs=0.3)

    def test_strokes_stand_across_their_bonds(self, causal):
        drawn = drawn_bonds(to_svg(causal))
        for bond, stroke in zip(causal.graph.bonds, causal.strokes, strict=True):
            line = points_of(drawn[bond.name]["bond"])
            first, second = line[-2:] if stroke.flow_out_of == bond.head else line[:2]
            a, b = points_of(drawn[bond.name]["stroke"])
            along = (second[0] - first[0], second[1] - first[1])
            product = along[0] * (b[0] - a[0]) + along[1] * (b[1] - a[1])
            assert abs(product) < 0.02 * math.hypot(*along) * math.dist(a, b)

    def test_half_arrows_end_at_the_head_on_one_side(self, causal):
        for parts in drawn_bonds(to_svg(causal)).values():
            line, (barb, tip) = points_of(parts["bond"]), points_of(parts["half-arrow"])
            assert tip == line[-1]
            back = (line[-2][0] - tip[0], line[-2][1] - tip[1])
            wing = (barb[0] - tip[0], barb[1] - tip[1])
            cosine = (back[0] * wing[0] + back[1] * wing[1]) / math.hypot(*back) / math.hypot(*wing)
            assert 0.7 < cosine < 0.95
            if abs(back[1]) < 1e-6:
                assert wing[1] > 0  # below a level bond
            elif abs(back[0]) < 1e-6:
                assert wing[0] > 0  # to the right of an upright one

    def test_strokes_of_the_textbook_cross(self):
        drawn = drawn_bonds(to_svg(assign_causality(mass_spring_damper())))

        def stroke_at_tip(name):
            stroke = points_of(drawn[name]["stroke"])
            tip = points_of(drawn[name]["bond"])[-1]
            return math.dist(tip, stroke[0]) < 2 * STROKE

        assert [stroke_at_tip(name) for name in ("F>v", "v>m", "v>k", "v>b")] == [
            True,
            True,
            False,
            False,
        ]

    def test_no_strokes_without_causality(self):
        assert "stroke" not in drawn_bonds(to_svg(mass_spring_damper()))["v>m"]

    def test_a_conflict_can_still_be_drawn(self):
        v = One("v")
        graph = assemble("g", Sf("a", 1) >> v, Sf("b", 1) >> v >> R("r", 1))
        assert len(drawn_bonds(to_svg(graph))) == 3

    def test_a_submodel_with_an_open_port_can_be_drawn(self):
        v = One("v")
        assert "R : r" in to_svg(assemble("g", v >> R("r", 1), ports={"v": v}))

    def test_derivative_causality_is_marked_and_noted(self):
        root = ET.fromstring(to_svg(assign_causality(models.bicycle_brake.graph())))
        texts = {text.text: text for text in root.iter(f"{SVG}text")}
        assert "derivative causality: wheel.tyre" in texts
        marked = {text for text, node in texts.items() if node.get("fill") != "#000000"}
        assert marked == {"derivative causality: wheel.tyre", "I : wheel.tyre"}
        frames = [group for group in root.iter(f"{SVG}g") if group.find(f"{SVG}rect") is not None]
        assert [group.get("data-element") for group in frames] == ["wheel.tyre"]

    def test_nothing_is_marked_without_it(self):
        assert "derivative" not in to_svg(assign_causality(mass_spring_damper()))

    def test_modulation_is_dashed_with_a_full_head(self):
        root = ET.fromstring(to_svg(pendulum()))
        (signal,) = [g for g in root.iter(f"{SVG}g") if g.get("data-signal") is not None]
        assert signal.get("data-signal") == "angle.q>arm"
        assert signal.find(f"{SVG}polyline").get("stroke-dasharray")
        assert signal.find(f"{SVG}polygon") is not None

    def test_numbers(self):
        root = ET.fromstring(to_svg(mass_spring_damper(), numbers=True))
        numbers = [text.text for text in root.iter(f"{SVG}text") if text.get("class") == "number"]
        assert numbers == ["1", "2", "3", "4"]
        assert 'class="number"' not in to_svg(mass_spring_damper())

    def test_names_are_escaped(self):
        svg = to_svg(assemble("a & b", Se("<E", 1) >> R('r"&', 2)))
        texts = [text.text for text in ET.fromstring(svg).iter(f"{SVG}text")]
        assert texts == ["Se : <E", 'R : r"&']

    def test_nothing_is_fetched(self, causal):
        svg = to_svg(causal).replace("http://www.w3.org/2000/svg", "")
        assert not any(word in svg for word in ("http", "href", "url(", "@import", "<style"))

    @pytest.mark.parametrize("name", ["bicycle_brake", "bridge", "branched", "star"])
    def test_the_same_graph_gives_the_same_drawing(self, name):
        first, second = (to_svg(assign_causality(GRAPHS[name]())) for _ in range(2))
        assert first == second

    def test_laws_are_told_in_plain_names(self):
        titles = [
            t.text for t in ET.fromstring(to_svg(models.frame_brake.graph())).iter(f"{SVG}title")
        ]
        assert "C rear.bending: law = k_f*q" in titles
