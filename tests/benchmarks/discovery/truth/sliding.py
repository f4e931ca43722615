"""Set-valued effects as small automata: dry friction that sticks, stops that rebound.

Each has modes, an effort in each, and a margin that turns negative where a mode ends. `Contact` asks
the machine what effort would hold the site's flow.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp

State = list[float]
FREE, STICK = 0, 9


@dataclass(frozen=True)
class Contact:
    """What a switching effect knows of its place, at one state and time.

    Attributes
    ----------
    q, f : displacement and flow
    holding : effort that would keep the flow as it is
    """

    q: float
    f: float
    holding: float


@dataclass(frozen=True)
class DryFriction:
    """Coulomb or Stribeck friction; modes are the sign of the slip, or STICK."""

    level: float
    excess: float = 0.0
    speed: float = 1.0
    held = (STICK,)

    def first(self, at: Contact) -> int:
        """Return the mode at rest."""
        if abs(at.holding) <= self.level + self.excess:
            return STICK
        return 1 if at.holding > 0 else -1

    def effort(self, mode: int, q: float, f: float) -> float:
        return mode * (self.level + self.excess * exp(-abs(f) / self.speed))

    def margin(self, mode: int, at: Contact) -> float:
        if mode == STICK:
            return self.level + self.excess - abs(at.holding)
        return mode * at.f

    def after(self, mode: int, at: Contact, strike: Callable[[float], None]) -> int:
        if mode == STICK:
            return 1 if at.holding > 0 else -1
        return self.first(at)


@dataclass(frozen=True)
class Stops:
    """Rigid stops: FREE, or at rest on the upper (1) or lower (-1) one."""

    upper: float
    lower: float
    restitution: float
    rest: float
    held = (1, -1)

    def first(self, at: Contact) -> int:
        return FREE

    def effort(self, mode: int, q: float, f: float) -> float:
        return 0.0

    def margin(self, mode: int, at: Contact) -> float:
        if mode != FREE:
            return mode * at.holding
        if at.f > 0:
            return self.upper - at.q
        return self.lower + at.q

    def after(self, mode: int, at: Contact, strike: Callable[[float], None]) -> int:
        if mode != FREE:
            return FREE
        side = 1 if at.f > 0 else -1
        if abs(at.f) > self.rest:
            strike(-self.restitution * at.f)
            return FREE
        strike(0.0)
        return side


def switched(effect: str, c: Mapping[str, float]) -> DryFriction | Stops:
    """Return the automaton of an effect."""
    if effect == "end_stop":
        return Stops(c["upper"], c["lower"], c["restitution"], c["rest"])
    return DryFriction(c["level"], c.get("excess", 0.0), c.get("speed", 1.0))


SWITCHED = ("coulomb_friction", "stribeck_friction", "end_stop")
