"""Forward sensitivities: derivatives of a run by parameters and initial states.

`run` has `sensitivities`, `result` what it gives. `seeds` differentiates the parameter table,
`tangents` the modes of a model, `signals` what is read off. A run of dopri5 keeps its steps, and
these are made again with their derivatives: by ``replay.c`` on modes compiled with ``tangent.c``
(run by `native`), else by its Python twin `replay`. `project` deals with contacts that stick at a
given time.
"""

from .model import ForwardModel
from .result import Sensitivities
from .run import sensitivities

__all__ = ["ForwardModel", "Sensitivities", "sensitivities"]
