"""What a drawing is made of: nodes with their labels, lines, and pieces that are laid out together."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace

from .geometry import Box, Point, centred, leaving, length, samples, text_width, towards
from .plan import DOWN, LEFT, RIGHT, UP

LABEL, CAPTION, TAG = 17.0, 12.0, 11.0  # font sizes
CLEAR = 6.0  # between a bond's end and a label
REACH = 9.0  # how far a half arrow or stroke stands off its bond
STEP = {UP: (0, -1), DOWN: (0, 1), LEFT: (-1, 0), RIGHT: (1, 0)}


@dataclass(frozen=True)
class Node:
    """An element in the drawing.

    Attributes
    ----------
    name : str
        Qualified name.
    label : str
        ``I : mass`` for a one-port; ``0``, ``TF``, ``RS``, or ``C`` of a field.
    at : (float, float)
        Centre of the label.
    box : Box
        About the label.
    caption : Box or None
        About the name, which junctions and two-ports have beside them.
    side : str
        Side of its neighbour that a one-port stands on; empty for others.
    clear : float
        Space left between the label and the bonds' ends.
    boxed : bool
        Whether the box is drawn: a signal block.
    """

    name: str
    label: str
    at: Point
    box: Box
    caption: Box | None = None
    side: str = ""
    clear: float = CLEAR
    boxed: bool = False

    def moved(self, dx: float, dy: float) -> Node:
        """Return the node shifted."""
        caption = None if self.caption is None else self.caption.moved(dx, dy)
        at = (self.at[0] + dx, self.at[1] + dy)
        return replace(self, at=at, box=self.box.moved(dx, dy), caption=caption)

    @property
    def anchor(self) -> Point:
        """Where a bond aims at: the centre, or the near edge of a one-port."""
        if not self.side:
            return self.at
        dx, dy = STEP[self.side]
        half = ((self.box.x1 - self.box.x0) / 2, (self.box.y1 - self.box.y0) / 2)
        return self.at[0] - dx * half[0], self.at[1] - dy * half[1]

    @property
    def boxes(self) -> list[Box]:
        """Label and caption."""
        return [self.box] if self.caption is None else [self.box, self.caption]


@dataclass(frozen=True)
class Line:
    """A bond or signal in the drawing.

    Attributes
    ----------
    name : str
        The bond's name; for a signal ``source.variable>target``.
    points : tuple of (float, float)
        From tail to head.
    """

    name: str
    points: tuple[Point, ...]


@dataclass(frozen=True)
class Tag:
    """A short text at a bond: the name of a field's port.

    Attributes
    ----------
    bond : str
    words : str
    box : Box
    """

    bond: str
    words: str
    box: Box


@dataclass(frozen=True)
class Drawing:
    """A graph with a place for everything.

    Attributes
    ----------
    nodes : dict of str to Node
    bonds : tuple of Line
        In the order of the graph's bonds.
    signals : tuple of Line
    frame : Box
        About everything.
    tags : tuple of Tag
        Names of the ports of fields.
    """

    nodes: dict[str, Node]
    bonds: tuple[Line, ...]
    signals: tuple[Line, ...]
    frame: Box
    tags: tuple[Tag, ...] = ()


class Piece:
    """Nodes and bonds laid out together, and the boxes that others must keep clear of."""

    def __init__(self) -> None:
        self.nodes: dict[str, Node] = {}
        self.bonds: dict[int, tuple[str, str]] = {}
        self.solid: list[Box] = []

    def move(self, dx: float, dy: float) -> None:
        """Shift everything."""
        self.nodes = {name: node.moved(dx, dy) for name, node in self.nodes.items()}
        self.solid = [box.moved(dx, dy) for box in self.solid]

    def take(self, other: Piece) -> None:
        """Take in another piece where it stands."""
        self.nodes |= other.nodes
        self.bonds |= other.bonds
        self.solid += other.solid

    def join(self, index: int, first: str, second: str) -> None:
        """Bond two nodes, and keep the bond clear."""
        self.bonds[index] = (first, second)
        ends = ends_of(self.nodes[first], self.nodes[second])
        self.solid += [centred(2 * REACH, 2 * REACH, point) for point in samples(ends, 2 * REACH)]

    def hits(self, boxes: Iterable[Box]) -> bool:
        """Whether any box stands on this piece."""
        return any(box.overlaps(other) for box in boxes for other in self.solid)


def ends_of(first: Node, second: Node) -> tuple[Point, Point]:
    """Return the visible ends of a straight bond between two nodes."""
    return _end_at(first, second.anchor), _end_at(second, first.anchor)


def _end_at(node: Node, far: Point) -> Point:
    if node.side:
        return towards(node.anchor, far, node.clear)
    return leaving(node.box.grown(node.clear), node.at, far)


def captioned(node: Node, crossed: Sequence[Box], busy: Collection[str] = ()) -> Node:
    """Put a junction's or two-port's name where nothing stands.

    Parameters
    ----------
    node : Node
    crossed : sequence of Box
        What the name must not stand on.
    busy : collection of str
        Sides that bonds leave from.

    Returns
    -------
    Node
        Where no place is free, the name covers as little as possible.
    """
    width, height = text_width(node.name, CAPTION), CAPTION + 2
    across, tall = (node.box.x1 - node.box.x0) / 2, (node.box.y1 - node.box.y0) / 2
    off, beside = tall + 5 + height / 2, across + 6 + width / 2
    spots = [(0.0, sign * off) for sign, side in ((-1, UP), (1, DOWN)) if side not in busy]
    spots += [(sign * beside, rise) for rise in (-off, off) for sign in (1, -1)]
    spots += [(sign * beside, rise * 1.7) for rise in (-off, off) for sign in (1, -1)]
    spots += [(sign * (beside + 14), rise) for rise in (-off, off) for sign in (1, -1)]
    for far in range(1, 8):
        spots += [(0.0, sign * (off + 9 * far)) for sign in (-1, 1)]
        spots += [
            (sx * (beside + 6 * far), sy * (off + 7 * far)) for sy in (-1, 1) for sx in (1, -1)
        ]
    boxes = [centred(width, height, (node.at[0] + x, node.at[1] + y)) for x, y in spots]
    covers = [sum(box.overlaps(other) for other in crossed) for box in boxes]
    return replace(node, caption=boxes[covers.index(min(covers))])


def across_of(start: Point, end: Point) -> Point:
    """Return the unit vector across a line.

    Examples
    --------
    >>> across_of((0, 0), (4, 0))
    (0.0, 1.0)
    """
    whole = length(start, end) or 1.0
    return (start[1] - end[1]) / whole, (end[0] - start[0]) / whole


def number_spot(points: Sequence[Point]) -> Point:
    """Return where a bond's number stands: beside its middle, away from the barb."""
    first, second = max(itertools.pairwise(points), key=lambda pair: length(*pair))
    across = across_of(first, second)
    if across[1] > 0 or (abs(across[1]) < 1e-9 and across[0] > 0):
        across = (-across[0], -across[1])
    middle = ((first[0] + second[0]) / 2, (first[1] + second[1]) / 2)
    return middle[0] + 9 * across[0], middle[1] + 9 * across[1]


def tagged(
    bond: str,
    words: str,
    way: Sequence[Point],
    texts: Sequence[Box],
    lines: Sequence[Box],
    size: float,
) -> Tag:
    """Put a port's name beside the bond, near the field at the way's start, where nothing stands.

    Where no place is free it stands on a line sooner than on another text.
    """
    width, height = text_width(words, size), size + 1
    start, end = way[0], way[1]
    whole = length(start, end)
    across = across_of(start, end)
    off = (abs(across[0]) * width + abs(across[1]) * height) / 2
    spots = [
        (x + sign * (off + gap) * across[0], y + sign * (off + gap) * across[1])
        for gap in (4.0, 8.0, 12.0, 18.0, 26.0)
        for x, y in (towards(start, end, share * whole) for share in (0.4, 0.5, 0.3, 0.6, 0.7, 0.8))
        for sign in (-1, 1)
    ]
    # in a crowd: as near as there is room
    x, y = towards(start, end, 0.4 * whole)
    turns = [math.tau * turn / 16 for turn in range(16)]
    spots += [
        (x + (far + width / 2) * math.cos(turn), y + far * math.sin(turn))
        for far in range(10, 90, 8)
        for turn in turns
    ]
    boxes = [centred(width, height, spot) for spot in spots]
    covers = [
        (sum(box.overlaps(text) for text in texts), sum(box.overlaps(line) for line in lines))
        for box in boxes
    ]
    return Tag(bond, words, boxes[covers.index(min(covers))])
