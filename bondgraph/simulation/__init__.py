"""Simulation: event-driven integration of hybrid models.

`simulate` is the whole face (`run`), and `solvers` chooses. `compiled` holds a model's
numeric functions, `mode_set` those of its modes, `implicit` what of them is solved for in
each call; `inputs` is what varies from outside (`samples`, `curves`), `trajectory` the result.

Three ways to run. `hybrid` integrates a `problem` with frictions on the modes of a `table`:
compiled C (`driver.c`, `kernel.c`, built by `compiler`, run by `native`) where a compiler is
found, else its Python twin `stepper`. ``switched/`` searches the modes of all other switching
elements, on the same stepper. ``smooth/`` is for stiff models and DAEs, by CasADi's integrators.
``forward/`` differentiates a run by parameters and initial states.
"""

from .compiled import CompiledModel
from .forward import Sensitivities, sensitivities
from .inputs import Samples
from .outcome import Outcome
from .run import simulate
from .trajectory import Energy, Event, Trajectory

__all__ = [
    "CompiledModel",
    "Energy",
    "Event",
    "Outcome",
    "Samples",
    "Sensitivities",
    "Trajectory",
    "sensitivities",
    "simulate",
]
