"""Kinds of places in a graph where an effect may act."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

FLOW_JUNCTION = "1-junction"
EFFORT_JUNCTION = "0-junction"
FLOW_PAIR = "between 1-junctions"
EFFORT_PAIR = "between 0-junctions"
BOND = "bond"
SOURCE = "source"
OUTPUT = "output"
INERTIA = "inertia"
DISSIPATOR = "dissipator"

KINDS: Mapping[str, str] = MappingProxyType(
    {
        FLOW_JUNCTION: "acts on the junction's flow or its displacement",
        EFFORT_JUNCTION: "acts on the junction's effort",
        FLOW_PAIR: "acts on relative flow, through a new 0-junction",
        EFFORT_PAIR: "acts on the difference of efforts, through a new 1-junction",
        BOND: "splits the bond with a new 0-junction",
        SOURCE: "changes what the source gives",
        OUTPUT: "changes what the sensor says, outside the power graph",
        INERTIA: "changes the law of an I",
        DISSIPATOR: "changes the law of an R or a Friction",
    }
)
JUNCTIONS = (FLOW_JUNCTION, FLOW_PAIR, EFFORT_JUNCTION, EFFORT_PAIR)
MECHANICAL = ("translation", "rotation")
POWER = ("translation", "rotation", "hydraulic", "electrical")
POTENTIAL = ("hydraulic", "electrical", "thermal")
