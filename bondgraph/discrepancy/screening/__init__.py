"""Screening: which candidate effect, at which site, would explain what the model does not.

`score` ranks candidates by their responses to first order, after the model's own parameters have
done what they can; `classes` says which the data cannot tell apart, and what would.
"""

from .classes import SAME, Splitter, ambiguity_classes, splitters
from .score import Scores, basis_of, chosen, scored

__all__ = [
    "SAME",
    "Scores",
    "Splitter",
    "ambiguity_classes",
    "basis_of",
    "chosen",
    "scored",
    "splitters",
]
