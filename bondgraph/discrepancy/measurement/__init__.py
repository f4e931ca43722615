"""Recordings: columns over time with units, gaps and holds."""

from .value import Measurement

__all__ = ["Measurement"]
