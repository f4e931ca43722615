"""Stability: is the steady state stable, what decides it, how far is the edge.

`assess` finds the operating point, linearises there, tells which elements carry
and which feed each mode, follows the eigenvalues along parameters, and says the
result in words.
"""

from ..linear import Mode, modal_table
from .assess import StabilityResult, assess
from .edges import Edge
from .locus import Gap, Locus, trace
from .maps import EigenvalueMap, PointOutcome, eigenvalue_map
from .vary import Vary
from .verdict import verdict

__all__ = [
    "Edge",
    "EigenvalueMap",
    "Gap",
    "Locus",
    "Mode",
    "PointOutcome",
    "StabilityResult",
    "Vary",
    "assess",
    "eigenvalue_map",
    "modal_table",
    "trace",
    "verdict",
]
