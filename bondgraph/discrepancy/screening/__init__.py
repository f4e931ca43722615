"""Screening: which candidate effect, at which site, would explain what the model does not.

`score` ranks candidates by their responses to first order, after the model's own parameters have
done what they can; `segments` gathers these responses along recordings; `classes` says which
the data cannot tell apart, and what would.
"""

from .classes import SAME, Splitter, ambiguity_classes, splitters
from .score import Scores, basis_of, chosen, scored
from .segments import Record, Segmented, best_length, segmented

__all__ = [
    "SAME",
    "Record",
    "Scores",
    "Segmented",
    "Splitter",
    "ambiguity_classes",
    "basis_of",
    "best_length",
    "chosen",
    "scored",
    "segmented",
    "splitters",
]
