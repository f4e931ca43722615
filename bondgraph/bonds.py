"""Bonds as values: ``a >> b`` is a half arrow from a to b.

A bond points in the direction of positive power. ``a >> b >> c`` is a chain of
two bonds, and a tuple fans out: ``junction >> (mass, spring, damper)``.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any


class Joinable:
    """Anything that a bond may end on: an element, or a submodel's port."""

    __slots__ = ()

    def __rshift__(self, other: Any) -> Chain:
        return _chain(self, other)

    def __rrshift__(self, other: Any) -> Chain:
        return _chain(other, self)


@dataclass(frozen=True, eq=False, slots=True)
class Bond:
    """A power bond with its half arrow at the head.

    Attributes
    ----------
    tail, head : Joinable
        The ends; power is positive when it goes from tail to head.

    Examples
    --------
    >>> from bondgraph import One, R
    >>> chain = One("v") >> R("damper", 2)
    >>> chain.bonds[0].head.name
    'damper'
    """

    tail: Any
    head: Any


@dataclass(frozen=True, eq=False, slots=True)
class Chain:
    """Bonds written in one line with ``>>``.

    Attributes
    ----------
    bonds : tuple of Bond
        In the order written.
    tails, heads : tuple of Joinable
        What a further ``>>`` on the left or on the right joins to.
    """

    bonds: tuple[Bond, ...]
    tails: tuple[Any, ...]
    heads: tuple[Any, ...]

    def __rshift__(self, other: Any) -> Chain:
        return _chain(self, other)

    def __rrshift__(self, other: Any) -> Chain:
        return _chain(other, self)


def _chain(left: Any, right: Any) -> Chain:
    """Join the heads of ``left`` to the tails of ``right``."""
    if isinstance(left, Joinable) and isinstance(right, Joinable):
        return Chain((Bond(left, right),), (left,), (right,))
    start, end = _as_chain(left), _as_chain(right)
    if len(start.heads) > 1 and len(end.tails) > 1:
        raise TypeError(
            "a tuple cannot be joined to a tuple with >>: which element goes to which is not said; write one bond each"
        )
    joints = tuple(Bond(tail, head) for tail in start.heads for head in end.tails)
    return Chain(start.bonds + joints + end.bonds, start.tails, end.heads)


def _as_chain(part: Any) -> Chain:
    if isinstance(part, Chain):
        return part
    if isinstance(part, Joinable):
        return Chain((), (part,), (part,))
    if isinstance(part, Iterable) and not isinstance(part, str):
        chains = [_as_chain(item) for item in part]
        if chains:
            return Chain(
                tuple(bond for chain in chains for bond in chain.bonds),
                tuple(tail for chain in chains for tail in chain.tails),
                tuple(head for chain in chains for head in chain.heads),
            )
    raise TypeError(
        f"only elements, junctions and ports are joined by >>, not {part!r}; bond them, or name its port"
    )
