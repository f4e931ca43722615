"""Causality: which end of each bond decides its effort, and why.

The sequential causality assignment procedure (SCAP): sources first, storage in
integral causality, elements whose law has only one direction, then the free
choices; each choice is propagated through the junction structure before the
next. Every stroke keeps its reason and the stroke it follows from.

References
----------
Karnopp, Margolis, Rosenberg, System Dynamics, 5th ed., Wiley 2012, ch. 3 and 5.

`value` is the result, `scap` the procedure.
"""

from .scap import PREFERRED, assign_causality
from .value import CausalGraph, Reason, Stroke

__all__ = ["PREFERRED", "CausalGraph", "Reason", "Stroke", "assign_causality"]
