"""Where everything stands: an own layout on straight lines, in pixels.

The main row stands on one height. What hangs on an element of the row is laid
out for itself, and these pieces are pushed along the row until nothing
overlaps; so are whole parts, one below the other.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from ..causality import CausalGraph
from ..graph import BondGraph, Signal
from .geometry import Box, Point, centred, hull, length, samples, text_width
from .pieces import (
    CLEAR,
    LABEL,
    REACH,
    STEP,
    TAG,
    Drawing,
    Line,
    Node,
    Piece,
    Tag,
    captioned,
    ends_of,
    number_spot,
    tagged,
)
from .plan import DOWN, LEFT, OPPOSITE, RIGHT, UP, Part, Plan, sides_for
from .route import Router
from .scene import Role, Scene, scene_of

BOND = 44.0  # shortest visible bond
PUSHES = 200  # steps outward after which a piece stays where it is
TURNED = 80  # parts with more elements keep their branches as they come
GAP = 14.0  # between what does not belong together
FRAME = 5.0  # between a signal block's label and its box
NOWHERE: frozenset[str] = frozenset()


def layout(graph: BondGraph | CausalGraph) -> Drawing:
    """Find a place for every element, bond and signal.

    Parameters
    ----------
    graph : BondGraph or CausalGraph

    Returns
    -------
    Drawing
        The same for the same graph.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble
    >>> v = One("v")
    >>> drawing = layout(assemble("rc", Se("E", 1) >> v >> (R("r", 1), C("c", 1))))
    >>> drawing.nodes["E"].at[0] < drawing.nodes["v"].at[0] < drawing.nodes["r"].at[0]
    True
    """
    plain = graph.graph if isinstance(graph, CausalGraph) else graph
    scene = scene_of(plain)
    plan = Plan(scene)
    lower = {name: number for number, part in enumerate(plan.parts) for name in part.names}
    lifted = frozenset(
        end
        for signal in scene.signals
        for end, other in ((signal.source, signal.target), (signal.target, signal.source))
        if lower[end] > lower[other]
    )
    placed = Piece()
    for part in plan.parts:
        piece = _Pieces(scene, part, lifted).narrowest()
        piece.move(*_below(placed, piece, scene.signals))
        placed.take(piece)
    return _drawing(scene, plan, placed)


class _Pieces:
    """Lays out one part."""

    def __init__(self, scene: Scene, part: Part, lifted: frozenset[str]) -> None:
        self.figures = scene.figures
        self.roles = {name: figure.role for name, figure in scene.figures.items()}
        self.part = part
        self.lifted = lifted
        self.degree = Counter(end for bond in scene.bonds for end in (bond.tail, bond.head))
        self.mirrored: set[str] = set()
        self.sideways = [RIGHT, LEFT]

    def narrowest(self) -> Piece:
        """Lay out the row, with branches turned to the side where they take less room."""
        best = self.row()
        if len(self.part.names) > TURNED:
            return best
        for name in self.part.row:
            if not any(self.roles[item].is_core for item in self.part.children[name]):
                continue
            self.mirrored.add(name)
            turned = self.row()
            if _width(turned) < _width(best):
                best = turned
            else:
                self.mirrored.remove(name)
        return best

    def row(self) -> Piece:
        """Lay out the main row with everything that hangs on it."""
        row = self.part.row
        whole = Piece()
        x = 0.0
        for number, name in enumerate(row):
            first, last = number == 0, number == len(row) - 1
            outward = [LEFT] * first + [RIGHT] * last
            free = [UP, DOWN, *outward] if self.roles[name].spreads else outward
            self.sideways = [LEFT, RIGHT] if name in self.mirrored else [RIGHT, LEFT]
            piece = self._piece(name, free, outward)
            if not first:
                x = self._next(whole, row[number - 1], piece, name)
            piece.move(x, 0.0)
            whole.take(piece)
            if not first:
                whole.join(self.part.bond_to[row[number - 1], name], row[number - 1], name)
        return whole

    def _next(self, whole: Piece, before: str, piece: Piece, name: str) -> float:
        """Return how far right the next piece of the row must stand."""
        left, right = whole.nodes[before], piece.nodes[name]
        x = left.box.x1 - right.box.x0 + BOND + left.clear + right.clear
        low = min(box.x0 for box in piece.solid)
        ahead = [box for box in whole.solid if box.x1 + GAP - low > x]
        for mine in piece.solid:
            for other in ahead:
                if mine.y0 - GAP < other.y1 and other.y0 < mine.y1 + GAP:
                    x = max(x, other.x1 + GAP - mine.x0)
        return x

    def _piece(
        self, name: str, free: Sequence[str], outward: Sequence[str], back: frozenset[str] = NOWHERE
    ) -> Piece:
        """Lay out an element at the origin with what hangs on it, nothing of which goes back."""
        piece = Piece()
        node = self._node(name)
        piece.nodes[name] = node
        items = self.part.children[name]
        sides = sides_for(self.roles, items, free, outward, self.lifted)
        for side in sorted(sides, key=lambda side: side in outward):
            if sides[side]:
                self._place(piece, name, side, sides[side], back)
        crossed = list(piece.solid)
        piece.solid.append(node.box)
        if self.roles[name].is_core:
            busy = back.union(side for side in sides if sides[side])
            piece.nodes[name] = captioned(node, crossed, busy)
            piece.solid += piece.nodes[name].boxes[1:]
        return piece

    def _node(self, name: str, side: str = "") -> Node:
        figure = self.figures[name]
        boxed = figure.role is Role.BLOCK
        box = centred(text_width(figure.label, LABEL), LABEL)
        if boxed:
            box = Box(box.x0 - FRAME, box.y0 - FRAME, box.x1 + FRAME, box.y1 + FRAME)
        clear = min(CLEAR + 1.5 * max(0, self.degree[name] - 4), 18.0)
        return Node(name, figure.label, (0.0, 0.0), box, None, side, clear, boxed)

    def _hanging(self, name: str, side: str, back: frozenset[str]) -> Piece:
        """Lay out one item that hangs on a side of its parent."""
        if not self.roles[name].is_core:
            piece = Piece()
            piece.nodes[name] = self._node(name, side)
            piece.solid.append(piece.nodes[name].box)
            return piece
        back = back | {OPPOSITE[side]}
        free = [side]
        if self.roles[name].spreads:
            free = [s for s in dict.fromkeys((side, DOWN, UP, *self.sideways)) if s not in back]
        return self._piece(name, free, [side], back)

    def _place(
        self, piece: Piece, name: str, side: str, items: Sequence[str], back: frozenset[str]
    ) -> None:
        """Put items on one side, fanned out where they are several, as near as they may stand."""
        hanging = [(item, self._hanging(item, side, back)) for item in items]
        node, dx = piece.nodes[name], STEP[side][0]
        spread = _spread(hanging, dx != 0, back)
        bond = max(BOND, 0.55 * max(map(abs, spread)))
        for _ in range(PUSHES):
            for (item, part), offset in zip(hanging, spread, strict=True):
                target = _target(node, part.nodes[item], side, bond)
                aim = (target, offset) if dx else (offset, target)
                at = part.nodes[item].at
                part.move(aim[0] - at[0], aim[1] - at[1])
            if any(_collides(piece, node, part, part.nodes[item]) for item, part in hanging):
                bond += GAP
            elif _crossed(node, hanging):
                spread = [1.2 * offset for offset in spread]
            else:
                break
        for item, part in hanging:
            piece.take(part)
            piece.join(self.part.bond_to[name, item], name, item)


def _crossed(node: Node, hanging: Sequence[tuple[str, Piece]]) -> bool:
    """Whether the bond to one item of a fan runs through another item."""
    if len(hanging) < 2:
        return False
    ways = [samples(ends_of(node, part.nodes[item]), REACH) for item, part in hanging]
    return any(
        part.hits([centred(4.0, 4.0, point) for point in way])
        for number, (_, part) in enumerate(hanging)
        for other, way in enumerate(ways)
        if other != number
    )


def _collides(piece: Piece, node: Node, part: Piece, item: Node) -> bool:
    """Whether an item or its bond stands on what its parent has already."""
    way = samples(ends_of(node, item), REACH)
    bond = [
        centred(4.0, 4.0, point) for point in way if length(point, node.at) > 2 * REACH + node.clear
    ]
    return piece.hits([*(box.grown(GAP) for box in part.solid), *bond])


def _target(mine: Node, theirs: Node, side: str, bond: float) -> float:
    """Return the coordinate of an item's centre along its side."""
    distance = bond + mine.clear + theirs.clear
    for box in (mine.box, theirs.box):
        distance += (box.x1 - box.x0 if side in (LEFT, RIGHT) else box.y1 - box.y0) / 2
    return distance * (STEP[side][0] or STEP[side][1])


def _width(piece: Piece) -> float:
    about = hull(piece.solid)
    return about.x1 - about.x0


def _spread(
    hanging: Sequence[tuple[str, Piece]], upright: bool, back: frozenset[str]
) -> list[float]:
    """Return offsets across a side at which pieces stand next to each other.

    About the middle, or from it away from where one may not go back.
    """
    offsets: list[float] = []
    edge = 0.0
    for item, part in hanging:
        about, at = hull(part.solid), part.nodes[item].at
        low, high = about.x0 - at[0], about.x1 - at[0]
        if upright:
            low, high = about.y0 - at[1], about.y1 - at[1]
        offsets.append(edge - low if offsets else 0.0)
        edge = offsets[-1] + high + 2 * GAP
    before, after = (UP, DOWN) if upright else (LEFT, RIGHT)
    middle = (offsets[0] + offsets[-1]) / 2
    if before in back:
        middle = offsets[0]
    elif after in back:
        middle = offsets[-1]
    return [offset - middle for offset in offsets]


def _below(placed: Piece, piece: Piece, signals: Sequence[Signal]) -> Point:
    """Return the shift that puts a part under those that stand, in line with its signals."""
    if not placed.solid:
        return 0.0, 0.0
    about, mine = hull(placed.solid), hull(piece.solid)
    ends = [pair for s in signals for pair in ((s.source, s.target), (s.target, s.source))]
    shifts = [
        placed.nodes[other].at[0] - piece.nodes[end].at[0]
        for end, other in ends
        if end in piece.nodes and other in placed.nodes
    ]
    dx = shifts[0] if shifts else about.x0 - mine.x0
    dy = about.y0 - mine.y0
    for box in piece.solid:
        here = box.moved(dx, 0.0).grown(GAP)
        above = [over.y1 for over in placed.solid if here.x0 < over.x1 and over.x0 < here.x1]
        dy = max([dy, *(low + BOND - box.y0 for low in above)])
    return dx, dy


def _settle_captions(nodes: dict[str, Node], lines: Iterable[Sequence[Point]]) -> None:
    """Move names that slanted bonds turned out to cross."""
    reach = []
    for line in lines:
        reach += [centred(5.0, 5.0, point) for point in samples(line, 5.0)]
        reach += [centred(2 * REACH, 2 * REACH, end) for end in (line[0], line[-1])]
    for name, node in nodes.items():
        if node.caption is None:
            continue
        crossed = reach + [
            box for other in nodes.values() if other is not node for box in other.boxes
        ]
        crossed.append(node.box)
        if any(node.caption.overlaps(box) for box in crossed):
            nodes[name] = captioned(node, crossed)


def _drawing(scene: Scene, plan: Plan, placed: Piece) -> Drawing:
    """Draw the straight bonds, then route what is left over."""
    lines: dict[int, tuple[Point, ...]] = {}
    for index, bond in enumerate(scene.bonds):
        if index in placed.bonds:
            lines[index] = ends_of(placed.nodes[bond.tail], placed.nodes[bond.head])
    nodes = placed.nodes
    router = Router([node.box for node in nodes.values()], lines.values())
    for index in sorted(index for part in plan.parts for index in part.closing):
        tail, head = nodes[scene.bonds[index].tail], nodes[scene.bonds[index].head]
        lines[index] = router.route(tail.box, head.box, max(tail.clear, head.clear))
    _settle_captions(nodes, lines.values())
    tags = _tags(scene, nodes, lines)
    labels = [box for node in nodes.values() for box in node.boxes]
    labels += [tag.box for tag in tags]
    router = Router(labels, lines.values())
    bonds = tuple(Line(bond.name, lines[index]) for index, bond in enumerate(scene.bonds))
    signals = tuple(
        Line(
            f"{signal.source}.{signal.variable}>{signal.target}",
            router.route(nodes[signal.source].box, nodes[signal.target].box, 2.0),
        )
        for signal in scene.signals
    )
    labels += [
        centred(2 * REACH, 2 * REACH, point) for line in (*bonds, *signals) for point in line.points
    ]
    return Drawing(nodes, bonds, signals, hull(labels), tags)


def _tags(
    scene: Scene, nodes: dict[str, Node], lines: dict[int, tuple[Point, ...]]
) -> tuple[Tag, ...]:
    """Name the ports of fields at their bonds."""
    texts = [box for node in nodes.values() for box in node.boxes]
    crossed: list[Box] = []
    for line in lines.values():
        crossed += [centred(2.0, 2.0, point) for point in samples(line, 3.0)]
        crossed += [centred(2 * REACH, 2 * REACH, end) for end in (line[0], line[-1])]
        crossed.append(centred(14.0, 12.0, number_spot(line)))
    found: list[Tag] = []
    for index, ports in enumerate(scene.ports):
        for words, way in zip(ports, (lines[index], lines[index][::-1]), strict=True):
            if words:
                tag = tagged(scene.bonds[index].name, words, way, texts, crossed, TAG)
                found.append(tag)
                texts.append(tag.box)
    return tuple(found)
