"""Limit cycles: measured on runs, found by shooting, judged by Floquet multipliers.

`measure` reads period, scatter and amplitude off a run; `sections` has Poincaré sections, `welch`
power spectra; `shooting` closes an orbit by Newton from a `guess`, `floquet` judges it. `again`
starts a run anew from a row of another, `flow` has the derivative of a run's end by its start.
"""

from .floquet import Floquet
from .measure import Amplitude, LimitCycle, limit_cycle
from .sections import Section, poincare_section
from .shooting import PeriodicOrbit, periodic_orbit
from .welch import Peak, Spectrum, spectrum

__all__ = [
    "Amplitude",
    "Floquet",
    "LimitCycle",
    "Peak",
    "PeriodicOrbit",
    "Section",
    "Spectrum",
    "limit_cycle",
    "periodic_orbit",
    "poincare_section",
    "spectrum",
]
