"""The library of effects that may be missing from a model.

An effect is a frozen value: where it fits, its law, its parameters and what builds it. `friction`,
`springs`, `flows`, `signals`, `inertia` and `heat` hold the families, `table` all of them by name.
"""

from .builders import resistor, source, spring
from .features import Feature, Shape, Signals, lagged, play, stop
from .place import Change, Place
from .table import EFFECTS, effects
from .value import (
    DISPLACEMENT,
    EFFORT,
    FLOW,
    MEMORY,
    MOMENTUM,
    SIGNAL,
    Coefficient,
    Effect,
    Scale,
)

__all__ = [
    "Change",
    "Coefficient",
    "DISPLACEMENT",
    "EFFECTS",
    "EFFORT",
    "Effect",
    "FLOW",
    "Feature",
    "MEMORY",
    "MOMENTUM",
    "Place",
    "SIGNAL",
    "Scale",
    "Shape",
    "Signals",
    "effects",
    "lagged",
    "play",
    "resistor",
    "source",
    "spring",
    "stop",
]
