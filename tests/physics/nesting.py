"""The same plan as submodels in submodels, joined through ports."""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Iterator
from typing import Any

import bondgraph as bg

from .plans import JUNCTIONS, SIGNALS, Plan, end_of, loose

Path = tuple[str, ...]
PLACES: tuple[Path, ...] = ((), ("sub1",), ("sub1", "sub2"), ("sub3",))


def flat(name: str) -> str:
    """Return a name without the submodels that qualify it."""
    return re.sub(r"^(sub\d\.)+", "", name)


def nested(plan: Plan, seed: int) -> bg.BondGraph:
    """Write the plan with its junctions spread over submodels, and all else where it fits."""
    rng = random.Random(seed)
    places = {name: rng.choice(PLACES) for name in plan.of(*JUNCTIONS)}
    for members, joined in _chains(plan):
        parts = [plan.parts[name] for name in members]
        signals = any(part.heard or part.kind in SIGNALS for part in parts)
        around = [places[name] for name in joined]
        place = () if signals or not around else _common(around)
        places |= dict.fromkeys(members, place)
    made = plan.elements()
    return _level(plan, made, places, ())


def _level(plan: Plan, made: dict[str, Any], places: dict[str, Path], path: Path) -> bg.BondGraph:
    """Assemble what lies at a place, with the submodels below."""
    depth = len(path)
    below = {place[: depth + 1] for place in places.values() if len(place) > depth}
    submodels = {
        place: _level(plan, made, places, place) for place in sorted(below) if place[:depth] == path
    }

    def end(name: str) -> Any:
        place = places[plan.owner(name)]
        return end_of(made, name) if place == path else submodels[place[: depth + 1]].port(name)

    own = {name: made[name] for name, place in places.items() if place == path}
    bonds = [
        end(tail) >> end(head)
        for tail, head in plan.bonds
        if _common([places[plan.owner(tail)], places[plan.owner(head)]]) == path
    ]
    inner = [name for name, place in places.items() if place[:depth] == path]
    ports = {name: end(name) for name in inner if path and plan.parts[name].kind in JUNCTIONS}
    inputs = [symbol for name, symbol in zip(plan.inputs, plan.symbols, strict=True) if name in own]
    name = path[-1] if path else "whole"
    return bg.assemble(name, *loose(own), *submodels.values(), *bonds, ports=ports, inputs=inputs)


def _common(places: list[Path]) -> Path:
    """Return the innermost place that holds all."""
    levels = itertools.takewhile(lambda level: len(set(level)) == 1, zip(*places, strict=False))
    return tuple(level[0] for level in levels)


def _chains(plan: Plan) -> Iterator[tuple[set[str], set[str]]]:
    """Go through parts joined to each other without a junction, and the junctions around."""
    left = {name for name in plan.parts if plan.parts[name].kind not in JUNCTIONS}
    while left:
        stack, members, joined = [left.pop()], set(), set()
        while stack:
            name = stack.pop()
            members.add(name)
            for bond in plan.bonds:
                ends = set(map(plan.owner, bond))
                if name in ends:
                    joined |= ends - members - left
                    stack += ends & left
                    left -= ends
        yield members, {name for name in joined if plan.parts[name].kind in JUNCTIONS}
