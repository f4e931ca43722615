"""What a machine is, as differential equations."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

State = list[float]
Loads = Mapping[str, float]


@dataclass(frozen=True)
class Ode:
    """A machine with numbers in it.

    Attributes
    ----------
    start : initial states, SI
    rates : of states, input, and what hidden effects take at sites: an effort at a 1-junction, a
        flow at a 0-junction
    flows : what an effect at a site sees, in states: flow at a 1-junction, effort at a 0-junction
    outputs : of states and input
    names : of the outputs
    pace : fastest rate, 1/s, that steps must follow
    ways : displacement of sites at the start, where it is not zero
    """

    start: Sequence[float]
    rates: Callable[[State, float, Loads], State]
    flows: Mapping[str, Callable[[State], float]]
    outputs: Callable[[State, float], tuple[float, ...]]
    names: tuple[str, ...]
    pace: float
    ways: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Inner:
    """An effect that changes a machine's own equations.

    Attributes
    ----------
    effect, site : of the library's names
    values : coefficients, SI
    """

    effect: str = ""
    site: str = ""
    values: Mapping[str, float] = field(default_factory=dict)


NOTHING = Inner()
