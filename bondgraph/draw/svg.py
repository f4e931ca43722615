"""SVG of a drawing: half arrows, causal strokes, labels."""

from __future__ import annotations

from collections.abc import Iterable
from xml.sax.saxutils import escape, quoteattr

import sympy

from ..causality import CausalGraph
from ..elements import Element
from ..equations.accounts import pseudo_elements
from ..errors import GraphError
from ..graph import BondGraph
from .geometry import Point, text_width, towards
from .layout import layout
from .pieces import CAPTION, LABEL, TAG, Drawing, Line, Node, Tag, across_of, number_spot
from .scene import Scene, scene_of

FONT = "STIX Two Text, STIXGeneral, Times New Roman, Times, serif"
INK, MARK, PSEUDO, ACCENT = "#000000", "#b3261e", "#8a5a00", "#0b57d0"
BARB = (10.0, 5.5)  # of a half arrow: along the bond, and off it
STROKE = 8.0  # half the length of a causal stroke
PAD = 14.0


def to_svg(
    graph: BondGraph | CausalGraph, *, numbers: bool = False, accented: Iterable[str] = ()
) -> str:
    """Draw a graph as SVG, the way textbooks do.

    Parameters
    ----------
    graph : BondGraph or CausalGraph
        Causal strokes are drawn where causality is assigned.
    numbers : bool
        Whether to number the bonds, from one, in the order of ``graph.bonds``.
    accented : iterable of str
        Qualified names of elements to be drawn in blue with their bonds, such as those that an
        effect added.

    Returns
    -------
    str
        A document of its own, which can also stand inside a page of HTML. The
        same graph gives the same text. Storages in derivative causality are
        framed, in red, and named in a note. Dashed arrows are signals, boxes the
        blocks that they pass. The ports of a field lead to one node. Pseudo-bonds
        are brown.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble, assign_causality
    >>> v = One("v")
    >>> rc = assemble("rc", Se("E", 1) >> v >> (R("r", 1), C("c", 1)))
    >>> to_svg(assign_causality(rc)).count('class="stroke"')
    3
    """
    causal = graph if isinstance(graph, CausalGraph) else None
    plain = graph if isinstance(graph, BondGraph) else graph.graph
    scene, drawing = scene_of(plain), layout(plain)
    derivative = frozenset(causal.derivative if causal else ())
    pseudo, stressed = _pseudo_bonds(plain), frozenset(accented)
    notes = [
        (f"derivative causality: {', '.join(causal.derivative if causal else ())}", MARK)
    ] * bool(derivative)
    notes += [("pseudo-bonds: temperature and heat flow", PSEUDO)] * bool(pseudo)
    body = [
        *_bonds(plain, drawing, causal, derivative, pseudo, stressed, numbers),
        *(_signal(line) for line in drawing.signals),
        *(_tag(tag) for tag in drawing.tags),
        *(_node(node, plain, scene, derivative, stressed) for node in drawing.nodes.values()),
    ]
    width, height, shift = _extent(drawing, [words for words, _ in notes])
    for number, (words, colour) in enumerate(notes):
        at = (drawing.frame.x0, drawing.frame.y1 + (2 + 1.2 * number) * PAD)
        body.append(_text(words, at, CAPTION, "note", anchor="start", fill=colour))
    return "\n".join([*_head(plain, causal, width, height, shift), *body, "</g>", "</svg>", ""])


def _pseudo_bonds(graph: BondGraph) -> frozenset[str]:
    """Return the bonds whose flow is heat; none where the graph uses them wrongly."""
    try:
        pseudo = pseudo_elements(graph)
    except GraphError:
        return frozenset()
    return frozenset(bond.name for bond in graph.bonds if {bond.tail, bond.head} <= pseudo)


def _extent(drawing: Drawing, notes: list[str]) -> tuple[float, float, Point]:
    """Return width and height of the picture, and the shift that puts its corner at zero."""
    frame = drawing.frame
    width = max([frame.x1 - frame.x0, *(text_width(note, CAPTION) for note in notes)]) + 2 * PAD
    height = frame.y1 - frame.y0 + 2 * PAD + (0.8 + 1.2 * len(notes)) * PAD * bool(notes)
    return width, height, (PAD - frame.x0, PAD - frame.y0)


def _head(
    graph: BondGraph, causal: CausalGraph | None, width: float, height: float, shift: Point
) -> Iterable[str]:
    size = f'width="{_n(width)}" height="{_n(height)}" viewBox="0 0 {_n(width)} {_n(height)}"'
    yield f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" font-family={quoteattr(FONT)}>'
    yield f"<title>{escape(f'Bond graph of {graph.name}')}</title>"
    yield f"<desc>{escape(_description(graph, causal))}</desc>"
    yield f'<rect width="{_n(width)}" height="{_n(height)}" fill="#ffffff"/>'
    yield f'<g transform="translate({_n(shift[0])} {_n(shift[1])})" fill="none" stroke="{INK}">'


def _description(graph: BondGraph, causal: CausalGraph | None) -> str:
    bonds = ", ".join(f"{bond.tail} to {bond.head}" for bond in graph.bonds)
    words = [f"{len(graph.elements)} elements. Bonds in the direction of power: {bonds}."]
    if graph.signals:
        signals = ", ".join(f"{s.source}.{s.variable} to {s.target}" for s in graph.signals)
        words.append(f"Modulations: {signals}.")
    if causal and causal.derivative:
        words.append(f"In derivative causality: {', '.join(causal.derivative)}.")
    return " ".join(words)


def _bonds(
    graph: BondGraph,
    drawing: Drawing,
    causal: CausalGraph | None,
    derivative: frozenset[str],
    pseudo: frozenset[str],
    stressed: frozenset[str],
    numbers: bool,
) -> Iterable[str]:
    for index, (bond, line) in enumerate(zip(graph.bonds, drawing.bonds, strict=True)):
        colour = ""
        if {bond.tail, bond.head} & derivative:
            colour = f' stroke="{MARK}"'
        elif {bond.tail, bond.head} & stressed:
            colour = f' stroke="{ACCENT}"'
        elif bond.name in pseudo:
            colour = f' stroke="{PSEUDO}"'
        parts = [_polyline("bond", line.points), _half_arrow(line.points)]
        if causal is not None:
            at_head = causal.strokes[index].flow_out_of == bond.head
            parts.append(_stroke(line.points if at_head else line.points[::-1]))
        if numbers:
            parts.append(_number(index + 1, line.points))
        name = quoteattr(bond.name)
        yield f'<g data-bond={name}{colour} stroke-width="1.4">{"".join(parts)}</g>'


def _polyline(kind: str, points: Iterable[Point], extra: str = "") -> str:
    path = " ".join(f"{_n(x)},{_n(y)}" for x, y in points)
    return f'<polyline class="{kind}" points="{path}"{extra}/>'


def _half_arrow(points: tuple[Point, ...]) -> str:
    """Draw the barb at the head, below a level bond and to the right of an upright one."""
    tip, before = points[-1], points[-2]
    back = towards(tip, before, BARB[0])
    across = across_of(before, tip)
    if across[1] < 0 or (abs(across[1]) < 1e-9 and across[0] < 0):
        across = (-across[0], -across[1])
    barb = (back[0] + BARB[1] * across[0], back[1] + BARB[1] * across[1])
    return _polyline("half-arrow", (barb, tip))


def _stroke(points: tuple[Point, ...]) -> str:
    """Draw the causal stroke across the last point."""
    tip = points[-1]
    across = across_of(points[-2], tip)
    ends = [
        (tip[0] + sign * STROKE * across[0], tip[1] + sign * STROKE * across[1]) for sign in (-1, 1)
    ]
    return _polyline("stroke", ends, ' stroke-width="2.2"')


def _number(number: int, points: tuple[Point, ...]) -> str:
    """Write a bond's number beside its middle, away from the barb."""
    at = number_spot(points)
    return _text(str(number), at, CAPTION - 2, "number")


def _signal(line: Line) -> str:
    """Draw a modulation: thin, dashed, with a full arrow head."""
    tip, before = line.points[-1], line.points[-2]
    back, across = towards(tip, before, 8.0), across_of(before, tip)
    wings = [
        (back[0] + sign * 3.2 * across[0], back[1] + sign * 3.2 * across[1]) for sign in (-1, 1)
    ]
    path = " ".join(f"{_n(x)},{_n(y)}" for x, y in (wings[0], tip, wings[1]))
    dashes = ' stroke-dasharray="4 3"'
    return (
        f'<g data-signal={quoteattr(line.name)} stroke-width="0.9">'
        f"{_polyline('signal', (*line.points[:-1], back), dashes)}"
        f'<polygon points="{path}" fill="{INK}" stroke="none"/></g>'
    )


def _tag(tag: Tag) -> str:
    middle = ((tag.box.x0 + tag.box.x1) / 2, (tag.box.y0 + tag.box.y1) / 2)
    return _text(tag.words, middle, TAG, "port", style="italic")


def _node(
    node: Node,
    graph: BondGraph,
    scene: Scene,
    derivative: frozenset[str],
    stressed: frozenset[str],
) -> str:
    elements = scene.figures[node.name].elements
    marked = bool(derivative.intersection(elements))
    colour = MARK if marked else ACCENT if stressed.intersection(elements) else INK
    told = "; ".join(_tooltip(name, graph.elements[name]) for name in elements)
    parts = [f"<title>{escape(told)}</title>"]
    if marked or node.boxed:
        box = node.box.grown(0.0 if node.boxed else 2.0)
        size = f'width="{_n(box.x1 - box.x0)}" height="{_n(box.y1 - box.y0)}"'
        parts.append(
            f'<rect x="{_n(box.x0)}" y="{_n(box.y0)}" {size} stroke="{colour}" stroke-width="0.9"/>'
        )
    parts.append(_text(node.label, node.at, LABEL, "label", fill=colour))
    if node.caption is not None:
        box = node.caption
        middle = ((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2)
        fill = ACCENT if stressed.intersection(elements) else INK
        parts.append(_text(node.name, middle, CAPTION, "caption", style="italic", fill=fill))
    return f"<g data-element={quoteattr(node.name)}>{''.join(parts)}</g>"


def _tooltip(name: str, element: Element) -> str:
    """Say what an element is, with its law in plain names."""
    own = {symbol: sympy.Symbol(key) for key, symbol in element.symbols.items()}
    laws = []
    for key, law in element.laws.items():
        if key in _SHOWN:
            plain = {dummy: sympy.Symbol(dummy.name) for dummy in law.atoms(sympy.Dummy)} | own
            laws.append(f"{key} = {law.xreplace(plain)}")
    return f"{element.kind} {name}" + (f": {'; '.join(laws)}" if laws else "")


_SHOWN = ("effort", "flow", "law", "kinetic", "ratio", "rate", "closed", "gap", "drop")


def _text(
    text: str,
    at: Point,
    size: float,
    kind: str,
    *,
    anchor: str = "middle",
    fill: str = INK,
    style: str = "",
) -> str:
    """Write a text whose capitals are centred on a height."""
    slant = f' font-style="{style}"' if style else ""
    return (
        f'<text class="{kind}" x="{_n(at[0])}" y="{_n(at[1] + 0.34 * size)}" font-size="{_n(size)}" '
        f'text-anchor="{anchor}" fill="{fill}" stroke="none"{slant}>{escape(text)}</text>'
    )


def _n(value: float) -> str:
    """Write a number with at most one decimal."""
    text = f"{value:.1f}".removesuffix(".0")
    return "0" if text == "-0" else text
