"""Screening: which candidate effect, at which site, would explain what the model does not.

`screen` is the face (`run`). `bank` puts every effect that fits at every site with a coefficient of
zero; `score` ranks candidates by their responses to first order, after the model's own parameters have
done what they can; `segments` gathers these responses along recordings; `classes` says which
the data cannot tell apart, and what would.
"""

from .bank import Bank, Probe, bank
from .classes import SAME, Splitter, ambiguity_classes, splitters
from .run import Row, Screening, screen
from .score import Scores, basis_of, chosen, scored
from .segments import Record, Segmented, best_length, segmented

__all__ = [
    "Bank",
    "Probe",
    "Row",
    "Screening",
    "SAME",
    "Record",
    "Scores",
    "Segmented",
    "Splitter",
    "ambiguity_classes",
    "bank",
    "basis_of",
    "best_length",
    "chosen",
    "scored",
    "screen",
    "segmented",
    "splitters",
]
