"""A failing plan made small: parts left out, and bypassed, as long as it fails in the same way."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

from .plans import SIGNALS, Plan


def shrunken(plan: Plan, fails: Callable[[Plan], bool], seconds: float = 60.0) -> Plan:
    """Return a plan from which no part can be left out without losing the failure.

    Parameters
    ----------
    plan : Plan
        It fails.
    fails : callable
        Whether a plan fails in the same way; what it raises counts as another way.
    seconds : float
        Time after which the smallest so far has to do.
    """
    until = time.monotonic() + seconds
    again = True
    while again and time.monotonic() < until:
        again = False
        for smaller in _smaller(plan):
            if _holds(fails, smaller):
                plan, again = smaller, True
                break
    return plan


def _smaller(plan: Plan) -> Iterator[Plan]:
    """Go through the plans with one part less."""
    for name, part in plan.parts.items():
        less = plan.without(name)
        yield _pruned(less)
        yield less
        beside = [bond[0] if bond[1] == name else bond[1] for bond in plan.bonds if name in bond]
        kept = {plan.owner(end) for end in beside} <= set(less.parts)
        if kept and len(beside) == 2 and not part.ports and beside[0] != beside[1]:
            yield Plan(less.parts, (*less.bonds, (beside[0], beside[1])))
            yield Plan(less.parts, (*less.bonds, (beside[1], beside[0])))


def _pruned(plan: Plan) -> Plan:
    """Leave out what has lost its bonds, and what loses its own by that."""
    for name, part in plan.parts.items():
        bonds = sum(plan.owner(end) == name for bond in plan.bonds for end in bond)
        least = {"0": 2, "1": 2, "TF": 2, "GY": 2, "RS": 2}.get(part.kind, len(part.ports) or 1)
        if bonds < least and part.kind not in SIGNALS:
            return _pruned(plan.without(name))
    return plan


def _holds(fails: Callable[[Plan], bool], plan: Plan) -> bool:
    try:
        return fails(plan)
    except Exception:
        return False
