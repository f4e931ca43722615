"""Modes: a graph with switching elements, seen in one of its modes.

In a mode each switching element is an ordinary one: a stuck contact, an open
switch or a blocking diode holds its flow at zero, the others follow a law. The
graph of a mode goes through the same causality and derivation as any other, so
that a stuck brake loses a state by the machinery that handles any derivative
causality.

`graphs` replaces elements, `equations` keeps the state vector of the whole graph
in the equations of a mode, with the jump that entering the mode takes.
"""

from collections.abc import Mapping
from types import MappingProxyType

from ..elements.friction import SLIP_BACKWARD, SLIP_FORWARD, STICK, Friction
from .equations import ModeEquations, mode_equations
from .graphs import contacts, in_mode, smoothed

CODES: Mapping[str, int] = Friction.modes
LABELS: Mapping[int, str] = MappingProxyType({code: label for label, code in CODES.items()})

__all__ = [
    "CODES",
    "LABELS",
    "ModeEquations",
    "SLIP_BACKWARD",
    "SLIP_FORWARD",
    "STICK",
    "contacts",
    "in_mode",
    "mode_equations",
    "smoothed",
]
