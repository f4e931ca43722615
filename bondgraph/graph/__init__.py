"""Graphs: bonds gathered, checked and frozen.

``assemble`` is the only way to make a `BondGraph`. It names the elements,
turns backward arrows on passive one-ports round, and refuses malformed
structure by name. Submodels are graphs with ports.

`value` holds the graph itself, `assembly` makes it, `structure` says what is
well-formed, `symbols` sorts what the laws use.
"""

from .assembly import assemble
from .structure import check_structure
from .value import TIME, BondGraph, GraphBond, Output, Port, Signal

__all__ = [
    "TIME",
    "BondGraph",
    "GraphBond",
    "Output",
    "Port",
    "Signal",
    "assemble",
    "check_structure",
]
