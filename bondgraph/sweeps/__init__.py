"""Sweeps: a model run at many points, on many workers, through kills and restarts.

`sweep` is the face (`run`). `points` and `designs` say where, `quantities` what is kept of each
run (`read` takes them in other forms), `job` holds both checked. `evaluate` runs a chunk and
returns a `block`; `worker` does so in another process, `pools` are the ways to get there,
`choice` takes one and `schedule` keeps it busy. `store` and `folder` are a sweep on disk,
`identity` what makes two sweeps the same, `dataset` is the result.
"""

from .dataset import outcomes
from .designs import latin_hypercube, sobol, uniform
from .points import Points, grid, samples
from .progress import Progress
from .quantities import (
    Count,
    Energy,
    EventTime,
    Final,
    Mean,
    Minimum,
    Peak,
    Quantity,
    Rms,
    Share,
)
from .read import parse_quantity
from .run import sweep

__all__ = [
    "Count",
    "Energy",
    "EventTime",
    "Final",
    "Mean",
    "Minimum",
    "Peak",
    "Points",
    "Progress",
    "Quantity",
    "Rms",
    "Share",
    "grid",
    "latin_hypercube",
    "outcomes",
    "parse_quantity",
    "samples",
    "sobol",
    "sweep",
    "uniform",
]
