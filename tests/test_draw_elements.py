"""Drawings of fields, RS, sensors, signal blocks and switching elements."""

from __future__ import annotations

import itertools
import math
import xml.etree.ElementTree as ET

import pytest

from bondgraph import CField, I, One, Se, assemble, assign_causality
from bondgraph.draw import layout, to_svg
from bondgraph.draw.geometry import samples

from . import showcase
from .test_draw import SVG, assert_no_labels_overlap, boxes, drawn_bonds, points_of


@pytest.fixture(scope="module", params=sorted(showcase.GRAPHS))
def causal(request):
    return assign_causality(showcase.GRAPHS[request.param]())


@pytest.fixture(scope="module")
def drawing(causal):
    return layout(causal)


def check_places(drawing):
    """Nothing stands on anything else."""
    assert_no_labels_overlap(drawing)
    tags = [tag.box for tag in drawing.tags]
    for first, second in itertools.combinations(tags, 2):
        assert not first.overlaps(second)
    for tag in tags:
        assert not any(tag.overlaps(box) for _, box in boxes(drawing))
    texts = [*(box for _, box in boxes(drawing)), *tags]
    for line in (*drawing.bonds, *drawing.signals):
        for box in texts:
            inner = box.grown(-1)
            assert not any(inner.contains(point) for point in samples(line.points, 3)), line.name


def drawn(graph):
    """Label by node, and the root of the picture."""
    root = ET.fromstring(to_svg(graph))
    labels = {}
    for group in root.iter(f"{SVG}g"):
        if group.get("data-element") is not None:
            texts = {text.get("class"): text.text for text in group.iter(f"{SVG}text")}
            labels[group.get("data-element")] = texts["label"]
    return labels, root


class TestPlaces:
    def test_nothing_stands_on_anything(self, drawing):
        check_places(drawing)

    @pytest.mark.parametrize("seed", range(12))
    def test_nor_where_all_kinds_are_mixed(self, seed):
        graph = showcase.mixture(seed)
        drawing = layout(graph)
        check_places(drawing)
        assert len(drawing.bonds) == len(graph.bonds)
        ports = [name for name in graph.elements if name.startswith("field.")]
        assert sorted(tag.words for tag in drawing.tags) == sorted(
            p.removeprefix("field.") for p in ports
        )

    def test_every_element_and_bond_is_drawn_once(self, causal):
        root = ET.fromstring(to_svg(causal))
        titles = [title.text for title in root.iter(f"{SVG}title")][1:]
        told = [part for title in titles for part in title.split("; ")]
        for name, element in causal.graph.elements.items():
            found = [part for part in told if part.split(":")[0] == f"{element.kind} {name}"]
            assert len(found) == 1, name
        assert list(drawn_bonds(to_svg(causal))) == [bond.name for bond in causal.graph.bonds]

    def test_strokes_are_those_of_the_causal_graph(self, causal):
        parts = drawn_bonds(to_svg(causal))
        for bond, stroke in zip(causal.graph.bonds, causal.strokes, strict=True):
            line = points_of(parts[bond.name]["bond"])
            ends = points_of(parts[bond.name]["stroke"])
            middle = tuple(sum(values) / 2 for values in zip(*ends, strict=True))
            end = line[-1] if stroke.effort_out_of == bond.tail else line[0]
            assert math.dist(middle, end) < 0.2


class TestFields:
    @pytest.mark.parametrize(
        ("name", "node", "letters", "ports"),
        [
            ("cfield", "beam", "C", ["tip", "middle"]),
            ("ifield", "coils", "I", ["primary", "secondary"]),
            ("icfield", "solenoid", "IC", ["coil", "gap"]),
            ("rfield", "wall", "R", ["hot", "cold"]),
            ("three_ports", "frame", "C", ["a", "b", "c"]),
        ],
    )
    def test_one_node_with_a_bond_and_a_name_a_port(self, name, node, letters, ports):
        graph = showcase.GRAPHS[name]()
        labels, root = drawn(graph)
        assert labels[node] == letters
        assert not any(label.startswith(f"{node}.") for label in labels)
        said = [text.text for text in root.iter(f"{SVG}text") if text.get("class") == "port"]
        assert sorted(said) == sorted(ports)
        assert not [group for group in root.iter(f"{SVG}g") if group.get("data-signal")]

    def test_port_names_stand_nearest_to_their_own_bond(self):
        drawing = layout(showcase.three_ports())
        lines = {line.name: line.points for line in drawing.bonds}
        for tag in drawing.tags:
            middle = ((tag.box.x0 + tag.box.x1) / 2, (tag.box.y0 + tag.box.y1) / 2)
            near = {
                name: min(math.dist(middle, point) for point in samples(points, 2))
                for name, points in lines.items()
            }
            assert min(near, key=near.__getitem__) == tag.bond

    def test_a_dependent_port_marks_its_field(self):
        pair = CField("pair", ("a", "b"), stiffness=[[2, 1], [1, 2]])
        v, w = One("v"), One("w")
        graph = assemble(
            "g",
            Se("F", 1) >> pair["a"],
            w >> (I("m", 1), pair["b"], Se("G", 1)),
            v >> (Se("H", 1), I("n", 1)),
        )
        root = ET.fromstring(to_svg(assign_causality(graph)))
        texts = {text.text: text.get("fill") for text in root.iter(f"{SVG}text")}
        assert texts["derivative causality: pair.a"] == "#b3261e"
        frames = [
            g.get("data-element") for g in root.iter(f"{SVG}g") if g.find(f"{SVG}rect") is not None
        ]
        assert frames == ["pair"]

    def test_in_a_submodel(self):
        pair = CField("pair", ("a", "b"), stiffness=[[2, 1], [1, 2]])
        v = One("v")
        inner = assemble(
            "inner", v >> (I("m", 1), pair["a"]), One("w") >> (I("n", 1), pair["b"]), ports={"v": v}
        )
        labels, _ = drawn(assemble("outer", Se("F", 1) >> inner.port("v")))
        assert labels["inner.pair"] == "C" and labels["inner.m"] == "I : inner.m"


class TestTwoSided:
    @pytest.mark.parametrize("name", ["warm", "warm_friction"])
    def test_rs_has_a_bond_in_and_a_bond_out(self, name):
        graph = showcase.GRAPHS[name]()
        labels, _ = drawn(graph)
        assert labels["pad"] == "RS" and "pad_heat" not in labels
        nodes = layout(graph).nodes
        lines = {line.name: line.points for line in layout(graph).bonds}
        assert nodes["pad"].box.grown(9).contains(lines["v>pad"][-1])
        assert nodes["pad"].box.grown(9).contains(lines["pad_heat>rotor"][0])

    def test_pseudo_bonds_differ_and_are_told(self):
        root = ET.fromstring(to_svg(showcase.warm()))
        coloured = {
            group.get("data-bond"): group.get("stroke")
            for group in root.iter(f"{SVG}g")
            if group.get("data-bond")
        }
        thermal = {name for name, colour in coloured.items() if colour}
        assert thermal == {"pad_heat>rotor", "rotor>heat", "rotor>air"}
        assert "pseudo-bonds: temperature and heat flow" in [
            t.text for t in root.iter(f"{SVG}text")
        ]
        assert "pseudo" not in to_svg(showcase.sensed())


class TestSignals:
    def test_blocks_are_boxes_with_dashed_arrows_in_and_out(self):
        labels, root = drawn(showcase.controlled())
        assert labels["gauge"] == "Lag : gauge" and labels["error"] == "∫ : error"
        boxed = {
            g.get("data-element") for g in root.iter(f"{SVG}g") if g.find(f"{SVG}rect") is not None
        }
        assert boxed == {"gauge", "error", "gate"}
        signals = [g for g in root.iter(f"{SVG}g") if g.get("data-signal")]
        assert {g.get("data-signal") for g in signals} == {
            "gauge.y>pump",
            "gate.y>pump",
            "tank.e>gauge",
            "gauge.y>error",
            "error.y>gate",
        }
        for group in signals:
            assert group.find(f"{SVG}polyline").get("stroke-dasharray")
            head = points_of(group.find(f"{SVG}polygon"))
            assert len(head) == 3

    def test_what_a_block_modulates_is_marked(self):
        assert drawn(showcase.controlled())[0]["pump"] == "MSf : pump"


class TestLetters:
    def test_switching_elements_and_sensors(self):
        found = {}
        for graph in ("choke", "rectifier", "ball", "clutch", "pump", "sensed"):
            found |= drawn(showcase.GRAPHS[graph]())[0]
        assert found["d"] == "D : d" and found["relay"] == "Sw : relay"
        assert found["floor"] == "Stop : floor" and found["plates"] == "Cl : plates"
        assert found["outlet"] == "Cv : outlet"
        assert found["tacho"] == "Df : tacho" and found["gauge"] == "De : gauge"
