"""Model against measured data: where they disagree, and what effect is missing.

Each stage is a function from one frozen value to the next and can be used alone. `measurement`
holds recordings, `fitting` brings parameters to them, `residual` tells where a model disagrees with
one, `candidates` holds the effects that may be missing, `screening` scores them at all sites, and
`grafting` grows one into the graph.
"""

from .candidates import EFFECTS, Effect
from .discovery import Discovery, Verdict, discover
from .grafting import Grafted, Site, graft, sites
from .measurement import Matched, Measurement, matched, read_all
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
from .screening import Screening, screen

__all__ = [
    "Discovery",
    "EFFECTS",
    "Verdict",
    "discover",
    "Effect",
    "Grafted",
    "Matched",
    "Screening",
    "Site",
    "graft",
    "matched",
    "read_all",
    "screen",
    "sites",
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
