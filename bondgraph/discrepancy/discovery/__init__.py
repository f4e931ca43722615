"""The whole chain: recordings and a model in, a named effect and an improved model out."""

from .run import discover
from .value import Course, Discovery, Estimate, Explanation, Gap, LearnedLaw, NamedEffect
from .verdict import Verdict

__all__ = [
    "Course",
    "Discovery",
    "Estimate",
    "Explanation",
    "Gap",
    "LearnedLaw",
    "NamedEffect",
    "Verdict",
    "discover",
]
