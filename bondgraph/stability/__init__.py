"""Stability: is the steady state stable, what decides it, how far is the edge.

`assess` finds the operating point, linearises there, tells which elements carry
and which feed each mode, follows the eigenvalues along parameters, and says the
result in words.
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
    "Margin",
    "Path",
    "Special",
    "follow_edge",
    "margins",
    "Edge",
    "Effect",
    "EigenvalueMap",
    "Gap",
    "Locus",
    "Mode",
    "Onset",
    "PointOutcome",
    "Sensitivities",
    "StabilityResult",
    "Vary",
    "assess",
    "eigenvalue_map",
    "incremental_resistances",
    "modal_table",
    "onset",
    "sensitivities",
    "trace",
    "verdict",
]
