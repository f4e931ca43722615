"""Attractors: what a model ends in from several starts, beside the linear verdict.

`find_attractors` (`find`) runs a model from `starts` until each run has settled (`settle`): at a
`rest`, `going_round` a cycle, beyond all bounds. `pushes` sizes the pushes of the steady state, `basin` finds
the smallest that leaves it; `reach` follows the own start along a parameter, `trends` asks
what a tenth more or less of each does to it; both run a `line`; `motions` gathers all of it. `bench` is what all
runs share; `described`, `value` and `reached` the results.
"""

from .find import find_attractors
from .motions import Motions, motions
from .reach import reach
from .reached import Change, Reach, ReachPoint
from .trends import Trend, trends
from .value import Attractor, Attractors, BasinEdge, Point

__all__ = [
    "Attractor",
    "Attractors",
    "BasinEdge",
    "Change",
    "Motions",
    "Point",
    "Reach",
    "ReachPoint",
    "Trend",
    "find_attractors",
    "motions",
    "reach",
    "trends",
]
