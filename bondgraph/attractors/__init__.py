"""Attractors: what a model ends in from several starts, beside the linear verdict.

`find_attractors` (`find`) runs a model from `starts` until each run has settled (`settle`): at a
`rest`, `going_round` a cycle, beyond all bounds. `pushes` sizes the pushes of the steady state, `basin` finds
the smallest that leaves it; `reach` follows the own start along a parameter. `bench` is what all
runs share; `described`, `value` and `reached` the results.
"""

from .find import find_attractors
from .reach import reach
from .reached import Change, Reach, ReachPoint
from .value import Attractor, Attractors, BasinEdge, Point

__all__ = [
    "Attractor",
    "Attractors",
    "BasinEdge",
    "Change",
    "Point",
    "Reach",
    "ReachPoint",
    "find_attractors",
    "reach",
]
