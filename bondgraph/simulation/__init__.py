"""Simulation: event-driven integration of hybrid models.

`simulate` is the whole face (`run`). `compiled` holds a model's numeric functions
by mode, `inputs` what varies from outside, `trajectory` the result.

Below them is the integrator, which knows numbers only: `hybrid` integrates a
`problem` on the modes of a `table`; compiled C (`driver.c`, `kernel.c`, built by
`compiler`, run by `native`) where a compiler is found, else its Python twin
`stepper`.
"""

from .compiled import CompiledModel
from .inputs import Samples
from .outcome import Outcome
from .run import simulate
from .trajectory import Energy, Event, Trajectory

__all__ = ["CompiledModel", "Energy", "Event", "Outcome", "Samples", "Trajectory", "simulate"]
