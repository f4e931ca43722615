"""Stability: is the steady state stable, what decides it, how far is the edge, what to change.

`assess` gathers all of it from one graph. `family` has the equations of steady states with parameters free,
`branch` solves them along one, `locus` samples it; `continuation` follows branches and edges by
arclength; `edges` and `onset` describe a crossing, by the exact `derivatives` of the rates. `margins` asks
every parameter how far it may go, `sensitivity` what it does to each eigenvalue, `slopes` which
laws fall; `verdict` and `advice` say it in words. `maps` is about many points at once, `vary` reads ranges.
"""

from ..linear import Mode, modal_table
from .assess import StabilityResult, assess
from .continuation import Boundary, Path, Special, follow_edge
from .edges import Edge
from .locus import Gap, Locus, trace
from .maps import EigenvalueMap, PointOutcome, eigenvalue_map
from .margins import Margin, margins
from .onset import Onset, onset
from .sensitivity import Effect, Sensitivities, sensitivities
from .slopes import incremental_resistances
from .vary import Vary
from .verdict import verdict

__all__ = [
    "Boundary",
    "Edge",
    "Effect",
    "EigenvalueMap",
    "Gap",
    "Locus",
    "Margin",
    "Mode",
    "Onset",
    "Path",
    "PointOutcome",
    "Sensitivities",
    "Special",
    "StabilityResult",
    "Vary",
    "assess",
    "eigenvalue_map",
    "follow_edge",
    "incremental_resistances",
    "margins",
    "modal_table",
    "onset",
    "sensitivities",
    "trace",
    "verdict",
]
