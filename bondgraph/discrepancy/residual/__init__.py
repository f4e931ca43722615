"""Where model and data disagree: by signal, time, frequency and operating region."""

from .build import residuals
from .compare import PeakChange, WindowComparison, compare_windows
from .crossing import Coherence
from .floor import Floor, noise_floor
from .frequency import Band, FrequencyGaps, by_frequency, gap_rate
from .ranking import Part, Place, locate
from .regions import Dependence, RegionGaps, by_region
from .signals import SignalGap, SignalGaps, by_signal
from .value import Residuals
from .whiteness import Whiteness, whiteness
from .windows import WindowGaps, by_window

__all__ = [
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
