"""Recordings: columns over time with units, gaps and holds.

`Measurement.read` and `read_all` read files.
"""

from .reading import read_all
from .value import Measurement

__all__ = ["Measurement", "read_all"]
