"""Latent efforts and flows: states that follow recordings while the model may err, and what would explain the error.

`relax` follows recordings, `probes` and `columns` say what every effect at every site would do along
them, `screen` scores effects, `null` says what noise alone would reach, `isolability` which effects
cannot be told apart, `steady` whether one is as large all along. `functions`, `implicit`, `grid`, `phi`,
`linear` and `smooth` are the numerics beneath.
"""

from .isolability import Isolability, isolability, splitting
from .null import threshold
from .probes import Probe, Probed, probed
from .relax import Record, Relaxed, eased, relaxed
from .screen import Hypothesis, Sketch, sketched

__all__ = [
    "Hypothesis",
    "Isolability",
    "Probe",
    "Probed",
    "Record",
    "Relaxed",
    "Sketch",
    "eased",
    "isolability",
    "probed",
    "relaxed",
    "sketched",
    "splitting",
    "threshold",
]
