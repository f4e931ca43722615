"""Simulation: event-driven integration of hybrid models.

`simulate` is the whole face. `compiled` holds a model's numeric functions by
mode; `hybrid` integrates, in C (`driver.c`) where a compiler is found and on
CasADi's virtual machine (`stepper`) where not; `trajectory` is the result.
"""

from .compiled import CompiledModel
from .inputs import Samples
from .outcome import Outcome
from .run import simulate
from .trajectory import Energy, Event, Trajectory

__all__ = ["CompiledModel", "Energy", "Event", "Outcome", "Samples", "Trajectory", "simulate"]
