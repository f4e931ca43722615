"""One answer beside one truth."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

MEMBERS = 4  # an ambiguity class of more says too little
Z95 = 1.96


@dataclass(frozen=True)
class Judged:
    """What an answer got right.

    Attributes
    ----------
    truth, answer : as sealed, and as told
    named : right effects by name, no other, whatever the site
    placed : a right site among what was said
    classed : named with the right site, or a class of few with the right one in it
    false : something is named, or a class is, that is not there
    removed : share of the held-out gap above the noise floor that is gone; NaN where there is none
    errors : relative errors of coefficients
    covered : whether each is within its 95 % band
    """

    truth: Mapping[str, Any]
    answer: Mapping[str, Any]
    named: bool
    placed: bool
    classed: bool
    false: bool
    removed: float
    errors: tuple[float, ...] = ()
    covered: tuple[bool, ...] = ()

    @property
    def verdict(self) -> str:
        return str(self.answer.get("verdict", "error"))

    @property
    def seconds(self) -> float:
        return float(self.answer.get("wall", self.answer.get("seconds", math.nan)))


def judged(truth: Mapping[str, Any], answer: Mapping[str, Any]) -> Judged:
    """Judge one answer.

    Parameters
    ----------
    truth : one of the sealed file
    answer : with ``verdict``, ``effects``, ``gap``; or ``error``
    """
    verdict = answer.get("verdict", "error")
    said = [(effect["name"], place(effect["site"])) for effect in answer.get("effects", ())]
    right = [{(name, place(site)) for name, site in group} for group in truth["right"]]
    claims = verdict in ("named", "ambiguous")
    named = bool(right) and claims and _all_named(verdict, said, right)
    sites = [{site for _, site in group} for group in right]
    found = {site for _, site in said}
    placed = bool(right) and verdict != "none" and all(found & group for group in sites)
    classed = bool(right) and claims and all(set(said) & group for group in right)
    if verdict == "named":
        classed = classed and named
    elif len(said) > max(MEMBERS, len(right)):
        classed = False
    good = set().union(*right) if right else set()
    false = claims and any(each not in good for each in said) and not classed
    errors, covered = _coefficients(truth, answer) if named and classed else ((), ())
    return Judged(truth, answer, named, placed, classed, false, removed(answer), errors, covered)


def place(site: str) -> str:
    """Return a site's name whichever way round a pair is told."""
    if not site.startswith("between "):
        return site
    ends = site.removeprefix("between ").split(" and ")
    return f"between {' and '.join(sorted(ends))}"


def removed(answer: Mapping[str, Any]) -> float:
    """Return the share of the held-out gap that is gone, of all signals together.

    Each is weighed by its noise floor.
    """
    before = after = 0.0
    for _, first, last, floor in answer.get("gap", {}).values():
        if not floor > 0:
            continue
        before += max((first / floor) ** 2 - 1, 0.0)
        after += max((last / floor) ** 2 - 1, 0.0)
    return 1 - math.sqrt(after / before) if before > 0 else math.nan


def _all_named(
    verdict: str, said: Sequence[tuple[str, str]], right: Sequence[set[tuple[str, str]]]
) -> bool:
    names = [name for name, _ in said]
    wanted = [{name for name, _ in group} for group in right]
    if verdict == "ambiguous":  # of one effect at several sites
        return len(wanted) == 1 and bool(names) and set(names) <= wanted[0]
    left = list(names)
    for group in wanted:
        hit = next((name for name in left if name in group), None)
        if hit is None:
            return False
        left.remove(hit)
    return not left


def _coefficients(
    truth: Mapping[str, Any], answer: Mapping[str, Any]
) -> tuple[tuple[float, ...], tuple[bool, ...]]:
    """Compare coefficients of effects that were named as they were hidden."""
    errors, covered = [], []
    for hidden, asked in zip(truth["hidden"], truth["asked"], strict=True):
        for effect in answer["effects"]:
            if effect["name"] != hidden["effect"]:
                continue
            for name, true in asked.items():
                value, std = effect["parameters"].get(name, (math.nan, math.nan))
                if value is None or std is None:
                    value, std = math.nan, math.nan
                errors.append(abs(value - true) / abs(true))
                covered.append(abs(value - true) <= Z95 * std)
            break
    return tuple(errors), tuple(covered)
