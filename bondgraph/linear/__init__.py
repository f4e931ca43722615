"""Linear systems: A B C D about a steady state, and what they tell of the model."""

from ..steady import SteadyState, steady_state
from .damping import DampingRow
from .frequency import FrequencyResponse
from .linearize import linearize, linearize_at
from .modal import Mode, growths, modal_table
from .response import TimeResponse
from .shapes import ModeShape
from .system import LinearSystem
from .transfer import TransferFunction

__all__ = [
    "DampingRow",
    "FrequencyResponse",
    "LinearSystem",
    "Mode",
    "ModeShape",
    "SteadyState",
    "TimeResponse",
    "TransferFunction",
    "growths",
    "linearize",
    "linearize_at",
    "modal_table",
    "steady_state",
]
