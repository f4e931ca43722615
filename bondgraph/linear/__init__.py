"""Linear systems: A B C D about a steady state, and what they tell of the model."""

from ..steady import SteadyState, steady_state
from .linearize import linearize, linearize_at
from .modal import Mode, growths, modal_table
from .system import LinearSystem

__all__ = [
    "LinearSystem",
    "Mode",
    "SteadyState",
    "growths",
    "linearize",
    "linearize_at",
    "modal_table",
    "steady_state",
]
