"""Ways for lines that do not follow the layout: closing bonds and signals.

A straight line where it is clear, else the cheapest way on a grid, found by
A*: short, with few corners, through no label and along no bond. A way starts
and ends at a dock, a point straight before a side or corner of a label where no
other line comes in.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from .geometry import Box, Point, distance_to, hull, leaving, samples

CELL = 8.0
MARGIN = 4.0  # kept clear about labels
NEAR = 7.0  # closer to a bond than this is on it
ROOM = 22.0  # between a label and its docks, for stroke and half arrow
AROUND = 10  # cells of free space about everything
# What a corner, a step along a bond, a step across one and a dock at a label's corner cost, in cells.
CORNER, ALONG, ACROSS, SLANT = 4.0, 16.0, 4.0, 6.0

_MOVES = ((1, 0), (0, 1), (-1, 0), (0, -1))
Cell = tuple[int, int]


class Dock(NamedTuple):
    """Where a way leaves a label.

    Attributes
    ----------
    inside : (float, float)
        Point of the label that the line aims at.
    point : (float, float)
        The dock itself.
    headings : tuple of int
        Moves that lead on from it: one for a side, two for a corner.
    """

    inside: Point
    point: Point
    headings: tuple[int, ...]


class Router:
    """Finds ways between labels; each way found is in the way of later ones."""

    def __init__(self, labels: Sequence[Box], lines: Iterable[Sequence[Point]]) -> None:
        self.labels = list(labels)
        self.lines: list[tuple[Point, Point]] = []
        for line in lines:
            self.lines += itertools.pairwise(line)

    def route(self, start: Box, end: Box, clear: float) -> tuple[Point, ...]:
        """Return the points of a way from one label to another.

        Parameters
        ----------
        start, end : Box
            Both are among the labels.
        clear : float
            Left free between the line's ends and the labels.
        """
        way = self._straight(start, end) or self._around(start, end)
        way = _trimmed(way, start.grown(clear), end.grown(clear))
        self.lines += itertools.pairwise(way)
        return tuple(way)

    def _straight(self, start: Box, end: Box) -> list[Point] | None:
        """Return a straight line that touches nothing, upright or level where it can be."""
        return next(
            (way for way in _straight_ways(start, end) if self._free(way, start, end)), None
        )

    def _free(self, way: Sequence[Point], start: Box, end: Box) -> bool:
        """Whether a way touches no other label and no line."""
        ends = (start.grown(MARGIN), end.grown(MARGIN))
        inner = [point for point in samples(way, 3.0) if not any(b.contains(point) for b in ends)]
        others = [box.grown(MARGIN) for box in self.labels if box not in (start, end)]
        if any(box.contains(point) for box in others for point in inner):
            return False
        return bool(inner) and not any(
            distance_to(point, *line) < NEAR for line in self.lines for point in inner
        )

    def _around(self, start: Box, end: Box) -> list[Point]:
        """Return the cheapest way on the grid."""
        grid = _Grid(self.labels, self.lines)
        way = grid.way(self._docks(start), self._docks(end))
        return way or [_centre(start), _centre(end)]

    def _docks(self, box: Box) -> list[Dock]:
        """Return the docks that nothing else uses; all where everything is used."""
        docks = _docks(box)
        free = [dock for dock in docks if self._free((dock.inside, dock.point), box, box)]
        return free or docks


def _centre(box: Box) -> Point:
    return (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2


def _straight_ways(start: Box, end: Box) -> list[list[Point]]:
    """Return upright and level lines through what two boxes share, then centre to centre."""
    ways = []
    (x0, y0), (x1, y1) = _centre(start), _centre(end)
    low, high = max(start.x0, end.x0) + 4, min(start.x1, end.x1) - 4
    if low <= high:
        for x in dict.fromkeys((min(max(x0, low), high), (low + high) / 2, low, high)):
            ways.append([(x, y0), (x, y1)])
    low, high = max(start.y0, end.y0) + 2, min(start.y1, end.y1) - 2
    if low <= high:
        ways.append([(x0, (low + high) / 2), (x1, (low + high) / 2)])
    return [*ways, [(x0, y0), (x1, y1)]]


def _docks(box: Box) -> list[Dock]:
    """Return the docks about a label: before its sides, and before the corners of a short one."""
    x, y = _centre(box)
    across, tall = (box.x1 - box.x0) / 2, (box.y1 - box.y0) / 2
    docks = [
        Dock((x, y), (x + dx * (across + ROOM), y + dy * (tall + ROOM)), (heading,))
        for heading, (dx, dy) in enumerate(_MOVES)
    ]
    corners = tuple(itertools.product((1, -1), repeat=2))
    if across > 3 * tall:
        for dx, dy in corners:
            aside = x + dx * across / 2
            docks.append(Dock((aside, y), (aside, y + dy * (tall + ROOM)), (2 - dy,)))
        return docks
    reach = 0.75 * ROOM
    for dx, dy in corners:
        at = (x + dx * (across + reach), y + dy * (tall + reach))
        docks.append(Dock((x, y), at, (1 - dx, 2 - dy)))
    return docks


def _trimmed(way: Sequence[Point], start: Box, end: Box) -> list[Point]:
    """Cut a way where it leaves the first box and where it enters the last."""
    points = list(way)
    while len(points) > 2 and start.contains(points[1]):
        del points[0]
    while len(points) > 2 and end.contains(points[-2]):
        del points[-1]
    first = leaving(start, points[0], points[1]) if start.contains(points[0]) else points[0]
    last = leaving(end, points[-1], points[-2]) if end.contains(points[-1]) else points[-1]
    return [first, *points[1:-1], last]


class _Grid:
    """Cells about everything, with what it costs to pass them."""

    def __init__(self, labels: Sequence[Box], lines: Sequence[tuple[Point, Point]]) -> None:
        frame = hull(labels)
        self.origin = (frame.x0 - AROUND * CELL, frame.y0 - AROUND * CELL)
        self.size = (
            math.ceil((frame.x1 - frame.x0) / CELL) + 2 * AROUND,
            math.ceil((frame.y1 - frame.y0) / CELL) + 2 * AROUND,
        )
        self.blocked = {cell for box in labels for cell in self._cells(box.grown(MARGIN))}
        self.level: set[Cell] = set()
        self.upright: set[Cell] = set()
        for start, end in lines:
            about = [Box(*point, *point).grown(NEAR) for point in samples((start, end), CELL / 2)]
            cells = {cell for box in about for cell in self._cells(box)}
            if start[0] != end[0]:
                self.level |= cells
            if start[1] != end[1]:
                self.upright |= cells

    def _cell(self, point: Point) -> Cell:
        return (
            round((point[0] - self.origin[0]) / CELL),
            round((point[1] - self.origin[1]) / CELL),
        )

    def _cells(self, box: Box) -> set[Cell]:
        low, high = self._cell((box.x0, box.y0)), self._cell((box.x1, box.y1))
        return {(x, y) for x in range(low[0], high[0] + 1) for y in range(low[1], high[1] + 1)}

    def way(self, starts: Sequence[Dock], ends: Sequence[Dock]) -> list[Point]:
        """Return the cheapest way from one of the docks to one of others; empty if there is none."""
        goals = {self._cell(dock.point): dock for dock in reversed(ends)}
        costs: dict[tuple[Cell, int], float] = {}
        before: dict[tuple[Cell, int], tuple[Cell, int]] = {}
        first: dict[tuple[Cell, int], Dock] = {}
        queue: list[tuple[float, tuple[Cell, int], bool]] = []
        for dock in starts:
            for heading in dock.headings:
                state = (self._cell(dock.point), heading)
                first.setdefault(state, dock)
                costs[state] = SLANT * (len(dock.headings) - 1)
                heapq.heappush(queue, (costs[state] + self._left(state[0], goals), state, False))
        while queue:
            _, state, arrived = heapq.heappop(queue)
            if arrived:
                return self._points(before, first, state, goals[state[0]])
            if state[0] in goals:
                entry = costs[state] + _entry(goals[state[0]], state[1])
                heapq.heappush(queue, (entry, state, True))
            for heading, (dx, dy) in enumerate(_MOVES):
                cell = (state[0][0] + dx, state[0][1] + dy)
                following = (cell, heading)
                cost = costs[state] + self._price(cell, state[1], heading)
                if cost < costs.get(following, math.inf):
                    costs[following] = cost
                    before[following] = state
                    heapq.heappush(queue, (cost + self._left(cell, goals), following, False))
        return []

    def _price(self, cell: Cell, before: int, heading: int) -> float:
        inside = 0 <= cell[0] < self.size[0] and 0 <= cell[1] < self.size[1]
        if not inside or cell in self.blocked or before == (heading + 2) % 4:
            return math.inf
        same, other = (self.upright, self.level) if heading % 2 else (self.level, self.upright)
        on_line = ALONG if cell in same else ACROSS if cell in other else 0.0
        return 1.0 + on_line + (CORNER if before != heading else 0.0)

    @staticmethod
    def _left(cell: Cell, goals: Iterable[Cell]) -> float:
        return float(min(abs(cell[0] - goal[0]) + abs(cell[1] - goal[1]) for goal in goals))

    def _points(
        self,
        before: dict[tuple[Cell, int], tuple[Cell, int]],
        first: dict[tuple[Cell, int], Dock],
        state: tuple[Cell, int],
        goal: Dock,
    ) -> list[Point]:
        """Return the corners of a way, its first and last leg in line with the docks."""
        states = [state]
        while states[-1] in before:
            states.append(before[states[-1]])
        states.reverse()
        turns = [states[0]]
        turns += [here for here, after in itertools.pairwise(states[1:]) if here[1] != after[1]]
        points = [self._point(cell) for cell, _ in (*turns, states[-1])]
        dock = first[states[0]]
        if len(points) == 2:
            level = points[0][1] == points[1][1]
            points.insert(1, points[1] if level else points[0])
            points[1] = (goal.point[0], dock.point[1]) if level else (dock.point[0], goal.point[1])
        points = _snapped(_snapped(points, dock.point)[::-1], goal.point)[::-1]
        return _without_straight([dock.inside, dock.point, *points[1:-1], goal.point, goal.inside])

    def _point(self, cell: Cell) -> Point:
        return self.origin[0] + cell[0] * CELL, self.origin[1] + cell[1] * CELL


def _entry(dock: Dock, heading: int) -> float:
    """What it costs to go from a dock into its label."""
    turns = {(heading - out) % 4 for out in dock.headings}
    if 2 in turns:
        return SLANT * (len(dock.headings) - 1)
    return math.inf if 0 in turns else CORNER


def _snapped(way: list[Point], dock: Point) -> list[Point]:
    """Shift the first leg of a way by less than a cell, onto its dock."""
    if len(way) < 3:
        return way
    axis = 1 if way[0][1] == way[1][1] else 0
    second = list(way[1])
    second[axis] = dock[axis]
    return [dock, (second[0], second[1]), *way[2:]]


def _without_straight(points: list[Point]) -> list[Point]:
    """Leave out points that a line goes straight through."""
    kept = points[:1]
    for here, after in itertools.pairwise(points[1:]):
        first = (here[0] - kept[-1][0], here[1] - kept[-1][1])
        second = (after[0] - here[0], after[1] - here[1])
        if abs(first[0] * second[1] - first[1] * second[0]) > 0.5:
            kept.append(here)
    return [*kept, points[-1]]
