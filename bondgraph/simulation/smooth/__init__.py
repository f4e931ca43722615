"""Simulation of smooth models by CasADi's integrators: stiff ODEs, and DAEs of index 1.

`functions` makes the numeric functions and consistent values, `pieces` cuts a run where
inputs bend, `plugin` builds the integrators and `quiet` collects what they print, `scales`
sizes their tolerances, `folds` watches the algebraic part, `march` goes from block to
block with the last good point in hand, `run` puts them together.
"""

from .functions import SmoothFunctions, from_rates, initial_algebraic, smooth_functions
from .run import SmoothProblem, SmoothSolution, integrate_smooth, tabled

__all__ = [
    "SmoothFunctions",
    "SmoothProblem",
    "SmoothSolution",
    "from_rates",
    "initial_algebraic",
    "integrate_smooth",
    "smooth_functions",
    "tabled",
]
