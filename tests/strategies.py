"""Random bond graphs for property tests: trees and meshes of junctions, all linear elements."""

from __future__ import annotations

import itertools
from fractions import Fraction

from hypothesis import strategies as st

from .sketches import Sketch

# Moderate and various: nothing stiff, and few graphs whose constants cancel by accident.
VALUES = [
    Fraction(n, d) for n, d in [(1, 1), (2, 1), (3, 1), (1, 2), (2, 3), (5, 3), (5, 4), (7, 5)]
]
RATIOS = [sign * value for value in VALUES for sign in (1, -1)]
PASSIVE = ["R", "C", "I"]


@st.composite
def sketches(
    draw,
    junctions: int = 5,
    loops: int = 2,
    ones: int = 3,
    chain: int = 2,
    sources: bool = True,
    aligned: bool = False,
    signals: bool = False,
) -> Sketch:
    """Draw a graph that is well formed; whether it has a solution is left open.

    Parameters
    ----------
    junctions, loops, ones, chain
        At most so many junctions, bonds that close a loop of junctions, one-ports at a
        junction, and two-ports in a row.
    sources
        Whether to draw Se and Sf.
    aligned
        Whether power runs through two-ports, so that in and out do not hang on the order written.
    signals
        Whether sources may follow variables of other elements.
    """
    kinds = PASSIVE + ["Se", "Sf"] * sources
    sketch = _Pencil(draw, aligned).sketch(junctions, loops, ones, chain, kinds)
    return draw(listening(sketch)) if signals else sketch


@st.composite
def listening(draw, sketch: Sketch) -> Sketch:
    """Let some sources follow a port variable or state of what is no such source."""
    found = {}
    for name in sketch.of("Se", "Sf"):
        others = [other for other in sketch.of("R", "C", "I", "0", "1") if other != name]
        if others and draw(st.booleans()):
            other = draw(st.sampled_from(others))
            ports = {"0": "e", "1": "f", "C": "efq", "I": "efp"}.get(
                sketch.elements[other][0], "ef"
            )
            found[name] = (f"{other}.{draw(st.sampled_from(ports))}", draw(st.sampled_from(RATIOS)))
    return Sketch(sketch.elements, sketch.bonds, found)


class _Pencil:
    """Draws element by element and bond by bond."""

    def __init__(self, draw, aligned: bool) -> None:
        self.draw = draw
        self.aligned = aligned
        self.elements: dict[str, tuple[str, Fraction | None]] = {}
        self.bonds: list[tuple[str, str]] = []

    def sketch(self, junctions, loops, ones, chain, kinds) -> Sketch:
        nodes = [
            self.element(self.draw(st.sampled_from("01"))) for _ in range(self.up_to(junctions, 1))
        ]
        for place, node in enumerate(nodes[1:], start=1):
            self.join(self.draw(st.sampled_from(nodes[:place])), node, chain)
        for _ in range(self.up_to(loops) if len(nodes) > 1 else 0):
            first, second = self.draw(st.permutations(nodes))[:2]
            self.join(first, second, chain)
        for node in nodes:
            for kind in self.draw(st.lists(st.sampled_from(kinds), max_size=ones)):
                self.join(node, self.element(kind), self.up_to(1))
            while sum(node in bond for bond in self.bonds) < 2:
                self.join(node, self.element(self.draw(st.sampled_from(PASSIVE))), 0)
        return Sketch(self.elements, tuple(self.bonds))

    def up_to(self, most: int, least: int = 0) -> int:
        return self.draw(st.integers(least, most))

    def element(self, kind: str) -> str:
        name = f"{kind}{len(self.elements)}"
        value = {"TF": RATIOS, "GY": RATIOS, "R": VALUES, "C": VALUES, "I": VALUES}.get(kind)
        self.elements[name] = (kind, None if value is None else self.draw(st.sampled_from(value)))
        return name

    def join(self, first: str, second: str, chain: int) -> None:
        """Bond two elements, now and then through two-ports, with arrows either way."""
        kinds = self.draw(st.lists(st.sampled_from(["TF", "GY"]), max_size=chain))
        path = [first, *map(self.element, kinds), second]
        outwards = self.aligned and self.elements[second][0] in PASSIVE
        backwards = not outwards and self.draw(st.booleans())
        for tail, head in itertools.pairwise(path):
            self.bonds.append((head, tail) if backwards else (tail, head))
            if not self.aligned:
                backwards = self.draw(st.booleans())
