"""Boxes, text widths and lines of the drawing, in pixels, y downwards."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

Point = tuple[float, float]

_NARROW = frozenset("iljtfrI.,:;|!'()[] ")
_WIDE = frozenset("mwMW@%")


class Box(NamedTuple):
    """An upright rectangle.

    Examples
    --------
    >>> Box(0, 0, 4, 2).overlaps(Box(3, 1, 5, 5)), Box(0, 0, 4, 2).overlaps(Box(4, 0, 5, 2))
    (True, False)
    """

    x0: float
    y0: float
    x1: float
    y1: float

    def moved(self, dx: float, dy: float) -> Box:
        """Return the box shifted."""
        return Box(self.x0 + dx, self.y0 + dy, self.x1 + dx, self.y1 + dy)

    def grown(self, margin: float) -> Box:
        """Return the box with a margin on all sides."""
        return Box(self.x0 - margin, self.y0 - margin, self.x1 + margin, self.y1 + margin)

    def overlaps(self, other: Box) -> bool:
        """Whether two boxes have an area in common."""
        return (
            self.x0 < other.x1 and other.x0 < self.x1 and self.y0 < other.y1 and other.y0 < self.y1
        )

    def contains(self, point: Point) -> bool:
        """Whether a point lies in the box."""
        return self.x0 <= point[0] <= self.x1 and self.y0 <= point[1] <= self.y1


def centred(width: float, height: float, at: Point = (0.0, 0.0)) -> Box:
    """Return a box about a point."""
    return Box(at[0] - width / 2, at[1] - height / 2, at[0] + width / 2, at[1] + height / 2)


def hull(boxes: Iterable[Box]) -> Box:
    """Return the box about boxes.

    Examples
    --------
    >>> hull([Box(0, 0, 1, 1), Box(4, -2, 5, 0)])
    Box(x0=0, y0=-2, x1=5, y1=1)
    """
    found = list(boxes)
    return Box(
        min(box.x0 for box in found),
        min(box.y0 for box in found),
        max(box.x1 for box in found),
        max(box.y1 for box in found),
    )


def text_width(text: str, size: float) -> float:
    """Estimate the width of a text in a serif font, on the wide side.

    Examples
    --------
    >>> text_width("mass", 10) > text_width("ill", 10)
    True
    """
    return size * sum(_letter_width(letter) for letter in text)


def _letter_width(letter: str) -> float:
    if letter in _NARROW:
        return 0.38
    if letter in _WIDE:
        return 0.94
    if not letter.isascii():
        return 1.0
    return 0.76 if letter.isupper() else 0.6


def length(first: Point, second: Point) -> float:
    """Return the distance of two points."""
    return math.hypot(second[0] - first[0], second[1] - first[1])


def towards(start: Point, end: Point, distance: float) -> Point:
    """Return the point at a distance from ``start`` on the way to ``end``.

    Examples
    --------
    >>> towards((0, 0), (10, 0), 3)
    (3.0, 0.0)
    """
    whole = length(start, end)
    if whole == 0:
        return start
    share = distance / whole
    return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])


def leaving(box: Box, start: Point, end: Point) -> Point:
    """Return where the way from ``start``, inside a box, to ``end`` leaves the box.

    Examples
    --------
    >>> leaving(Box(-2, -1, 2, 1), (0, 0), (10, 0))
    (2.0, 0.0)
    """
    if box.contains(end):
        return end
    share = 1.0
    for axis, low, high in ((0, box.x0, box.x1), (1, box.y0, box.y1)):
        step = end[axis] - start[axis]
        if step:
            share = min(share, ((high if step > 0 else low) - start[axis]) / step)
    return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])


def samples(points: Sequence[Point], step: float = 6.0) -> list[Point]:
    """Return points along a polyline, both ends included.

    Examples
    --------
    >>> samples([(0, 0), (10, 0)], step=5)
    [(0.0, 0.0), (5.0, 0.0), (10.0, 0.0)]
    """
    found: list[Point] = []
    for start, end in itertools.pairwise(points):
        count = max(1, math.ceil(length(start, end) / step))
        found += [
            (
                start[0] + (end[0] - start[0]) * index / count,
                start[1] + (end[1] - start[1]) * index / count,
            )
            for index in range(count + 1)
        ]
    return found


def distance_to(point: Point, start: Point, end: Point) -> float:
    """Return the distance of a point from a line between two points.

    Examples
    --------
    >>> distance_to((5, 3), (0, 0), (10, 0))
    3.0
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    square = dx * dx + dy * dy
    if square == 0:
        return length(point, start)
    share = ((point[0] - start[0]) * dx + (point[1] - start[1]) * dy) / square
    share = min(1.0, max(0.0, share))
    return length(point, (start[0] + share * dx, start[1] + share * dy))
