"""Model against measured data: where they disagree, and what effect is missing.

Each stage is a function from one frozen value to the next and can be used alone. `measurement`
holds recordings, `fitting` brings parameters to them.
holds recordings, `residual` tells where a model disagrees with one.
"""

from .measurement import Measurement
from .residual import (
    Band,
    Coherence,
    Dependence,
    Floor,
    FrequencyGaps,
    Part,
    PeakChange,
    Place,
    RegionGaps,
    Residuals,
    SignalGap,
    SignalGaps,
    Whiteness,
    WindowComparison,
    WindowGaps,
    by_frequency,
    by_region,
    by_signal,
    by_window,
    compare_windows,
    gap_rate,
    locate,
    noise_floor,
    residuals,
    whiteness,
)

__all__ = [
    "Measurement",
    "Band",
    "Coherence",
    "Dependence",
    "Floor",
    "FrequencyGaps",
    "Part",
    "PeakChange",
    "Place",
    "RegionGaps",
    "Residuals",
    "SignalGap",
    "SignalGaps",
    "Whiteness",
    "WindowComparison",
    "WindowGaps",
    "by_frequency",
    "by_region",
    "by_signal",
    "by_window",
    "compare_windows",
    "gap_rate",
    "locate",
    "noise_floor",
    "residuals",
    "whiteness",
]
