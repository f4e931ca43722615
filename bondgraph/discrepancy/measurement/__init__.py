"""Recordings: columns over time with units, gaps and holds.

`Measurement.read` and `read_all` read files, `matched` finds a recording's columns in a model.
"""

from .matching import Matched, matched
from .reading import read_all
from .value import Measurement

__all__ = ["Matched", "Measurement", "matched", "read_all"]
