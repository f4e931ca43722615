"""What goes where, before any length is known.

Each connected part has a main row, its longest way through junctions and
two-ports; everything else hangs on it as a tree. Bonds that close a ring are
left over and drawn last.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from .scene import Role, Scene

UP, DOWN, LEFT, RIGHT = "up", "down", "left", "right"
OPPOSITE = {UP: DOWN, DOWN: UP, LEFT: RIGHT, RIGHT: LEFT}
# Junctions up to this number have all ways between them measured for the longest.
ALL_WAYS = 150


@dataclass
class Part:
    """A connected part of a graph.

    Attributes
    ----------
    names : list of str
    row : list of str
        Elements of the main row, left to right.
    children : dict of str to list of str
        What hangs on each element: one-ports and further junctions.
    bond_to : dict of (str, str) to int
        Bond between neighbours in the row, or parent and child.
    closing : list of int
        Bonds that close rings.
    """

    names: list[str]
    row: list[str]
    children: dict[str, list[str]] = field(default_factory=dict)
    bond_to: dict[tuple[str, str], int] = field(default_factory=dict)
    closing: list[int] = field(default_factory=list)


class Plan:
    """The parts of a graph, the one with the longest row first."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.bonds_at: dict[str, list[int]] = {name: [] for name in scene.figures}
        for index, bond in enumerate(scene.bonds):
            self.bonds_at[bond.tail].append(index)
            self.bonds_at[bond.head].append(index)
        self.parts = [self._part(names) for names in self._connected()]
        self.parts.sort(key=lambda part: -len(part.row))

    def is_core(self, name: str) -> bool:
        """Whether bonds go on from a node."""
        return self.scene.figures[name].role.is_core

    def other(self, index: int, name: str) -> str:
        """Return the other end of a bond."""
        bond = self.scene.bonds[index]
        return bond.head if bond.tail == name else bond.tail

    def _connected(self) -> list[list[str]]:
        seen: set[str] = set()
        found = []
        for start in self.scene.figures:
            if start not in seen:
                reached = set(self._distances(start, self.scene.figures))
                seen |= reached
                found.append([name for name in self.scene.figures if name in reached])
        return found

    def _distances(self, start: str, within: Iterable[str]) -> dict[str, tuple[int, str]]:
        """Return distance and the element before, by breadth first search."""
        allowed = set(within)
        found = {start: (0, "")}
        queue = deque([start])
        while queue:
            name = queue.popleft()
            for index in self.bonds_at[name]:
                other = self.other(index, name)
                if other in allowed and other not in found:
                    found[other] = (found[name][0] + 1, name)
                    queue.append(other)
        return found

    def _part(self, names: list[str]) -> Part:
        core = [name for name in names if self.is_core(name)]
        row = self._row(core) if core else self._pair(names)
        part = Part(names, row)
        self._hang(part)
        return part

    def _pair(self, names: list[str]) -> list[str]:
        """Put two one-ports that share a bond in the direction of power."""
        bonds = self.bonds_at[names[0]]
        return (
            [self.scene.bonds[bonds[0]].tail, self.scene.bonds[bonds[0]].head] if bonds else names
        )

    def _row(self, core: list[str]) -> list[str]:
        """Return the longest way, with sources at its ends where it has the choice."""
        starts = core
        if len(core) > ALL_WAYS:
            far = self._distances(core[0], core)
            starts = [max(core, key=lambda name: far[name][0])]
        bonus = {name: self._source_at(name) for name in core}
        best: tuple[int, list[str]] = (-1, [])
        for start in starts:
            reached = self._distances(start, core)
            end = max(core, key=lambda name: 4 * reached[name][0] + bonus[name])
            score = 4 * reached[end][0] + bonus[end] + bonus[start]
            if score > best[0]:
                best = (score, self._way(reached, end))
        return self._oriented(best[1])

    def _way(self, reached: Mapping[str, tuple[int, str]], end: str) -> list[str]:
        way = [end]
        while reached[way[-1]][1]:
            way.append(reached[way[-1]][1])
        return way[::-1]

    def _source_at(self, name: str) -> int:
        ends = [self.scene.figures[self.other(index, name)] for index in self.bonds_at[name]]
        return 3 * any(end.role is Role.SOURCE for end in ends)

    def _oriented(self, row: list[str]) -> list[str]:
        """Turn a row so that power comes from a source at the left."""
        feeds = [self._feeds(row[0]), self._feeds(row[-1])]
        forward = 0
        for first, second in itertools.pairwise(row):
            bond = self.scene.bonds[self._joint(first, second)]
            forward += 1 if bond.tail == first else -1
        if feeds[0] != feeds[1]:
            return row if feeds[0] else row[::-1]
        return row if forward >= 0 else row[::-1]

    def _feeds(self, name: str) -> bool:
        """Whether a source sends power into an element."""
        bonds = [self.scene.bonds[index] for index in self.bonds_at[name]]
        return any(
            bond.head == name and self.scene.figures[bond.tail].role is Role.SOURCE
            for bond in bonds
        )

    def _joint(self, first: str, second: str) -> int:
        return next(index for index in self.bonds_at[first] if self.other(index, first) == second)

    def _hang(self, part: Part) -> None:
        """Hang everything beside the row on it, breadth first."""
        used = set()
        for first, second in itertools.pairwise(part.row):
            part.bond_to[first, second] = part.bond_to[second, first] = self._joint(first, second)
            used.add(part.bond_to[first, second])
        seen = set(part.row)
        queue = deque(part.row)
        while queue:
            name = queue.popleft()
            part.children[name] = []
            for index in self.bonds_at[name]:
                other = self.other(index, name)
                if other not in seen:
                    seen.add(other)
                    used.add(index)
                    part.children[name].append(other)
                    part.bond_to[name, other] = part.bond_to[other, name] = index
                    queue.append(other)
        part.closing = sorted(
            {index for name in part.names for index in self.bonds_at[name]} - used
        )


def sides_for(
    roles: Mapping[str, Role],
    items: Sequence[str],
    free: Sequence[str],
    outward: Sequence[str],
    lifted: frozenset[str] = frozenset(),
) -> dict[str, list[str]]:
    """Share the free sides of an element among what hangs on it.

    Parameters
    ----------
    roles : mapping of str to Role
    items : sequence of str
        What hangs on the element.
    free : sequence of str
        Sides that are not taken, such as ``up``.
    outward : sequence of str
        The free sides that go on in the direction one came from.
    lifted : frozenset of str
        Items that want to go up, to be near what they modulate.

    Returns
    -------
    dict of str to list of str
        Items by side. I goes up, C and R go down, sources and further
        junctions go outward, and no side is crowded while another is empty.

    Examples
    --------
    >>> parts = {"m": Role.INERTIA, "k": Role.COMPLIANCE, "b": Role.OTHER, "F": Role.SOURCE}
    >>> sides_for(parts, list(parts), [UP, DOWN, LEFT, RIGHT], [LEFT, RIGHT])
    {'up': ['m'], 'down': ['k'], 'left': ['F'], 'right': ['b']}
    """
    if len(items) == 1 and outward and not lifted.intersection(items):
        return {side: list(items) if side == outward[0] else [] for side in free}
    taken: dict[str, list[str]] = {side: [] for side in free}
    place = {name: number for number, name in enumerate(items)}
    for name in sorted(items, key=lambda item: (_rank(roles[item]), place[item])):
        wishes = _wishes(roles[name], outward)
        if name in lifted:
            wishes = {UP: -9.0}
        side = min(free, key=lambda option: wishes.get(option, 2.0) + 4.0 * len(taken[option]))
        taken[side].append(name)
    return {side: sorted(names, key=place.__getitem__) for side, names in taken.items()}


def _rank(role: Role) -> int:
    """Order of choice: what is largest or most particular first."""
    if role.is_core:
        return 0
    order = (Role.SOURCE, Role.INERTIA, Role.COMPLIANCE)
    return 1 + order.index(role) if role in order else 4


def _wishes(role: Role, outward: Sequence[str]) -> dict[str, float]:
    """Return how unwelcome each side is; 2 where not named."""
    if role.is_core:
        return {DOWN: 0.5, UP: 1.0} | dict.fromkeys(outward, 0.0)
    if role is Role.SOURCE:
        return {DOWN: 2.2, UP: 2.5} | dict.fromkeys(outward, 0.0)
    if role is Role.INERTIA:
        return {UP: 0.0, DOWN: 3.0}
    if role is Role.COMPLIANCE:
        return {DOWN: 0.0, UP: 3.0}
    return {DOWN: 0.3} | {side: 0.0 for side in outward if side != DOWN}
