"""Recordings: columns over time with units, gaps and holds.

`Measurement.read` and `read_all` read files, `matched` finds a recording's columns in a model.
`sampling`, `gaps`, `saturation`, `quantisation`, `outliers` and `noise_floor` look at what was
recorded, `decimated` and `resampled` change its steps. Nothing is removed or filled unasked.
"""

from .matching import Matched, matched
from .noise import NoiseFloor, noise_floor
from .quality import Limit, outliers, quantisation, saturation
from .reading import read_all
from .resampling import decimated, resampled
from .sampling import Sampling, gaps, sampling
from .value import Measurement

__all__ = [
    "decimated",
    "gaps",
    "Limit",
    "Matched",
    "matched",
    "Measurement",
    "noise_floor",
    "NoiseFloor",
    "outliers",
    "quantisation",
    "read_all",
    "resampled",
    "Sampling",
    "sampling",
    "saturation",
]
