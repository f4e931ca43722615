"""Plots of trajectories, eigenvalue loci, sweeps, friction laws and gaps, on matplotlib axes.

Each function draws on the axes it is given, or on those of a new figure, and
returns the axes. pyplot is not used, so nothing is kept or shown. The colours
are told apart by colour-blind readers, the line styles in black and white.

References
----------
Okabe, Ito, Color universal design, 2008 (the palette).
"""

from .attractors import attractor_plot, reach_plot
from .courses import (
    course_plot,
    gap_course,
    gap_shares,
    gap_spectra,
    learned_law,
)
from .gaps import (
    coherence_plot,
    frequency_gaps,
    region_gaps,
    signal_gaps,
    window_gaps,
)
from .laws import friction_curve
from .loci import growth_rates, root_locus
from .maps import stability_map
from .motion import application, overview, phase_plane, time_response
from .periodograms import whiteness_plot, window_comparison
from .style import PALETTE, Signal, new_axes, pretty, save, signal
from .sweeps import sweep_map

__all__ = [
    "PALETTE",
    "Signal",
    "application",
    "attractor_plot",
    "coherence_plot",
    "course_plot",
    "frequency_gaps",
    "friction_curve",
    "gap_course",
    "gap_shares",
    "gap_spectra",
    "growth_rates",
    "learned_law",
    "new_axes",
    "overview",
    "phase_plane",
    "pretty",
    "reach_plot",
    "region_gaps",
    "root_locus",
    "save",
    "signal",
    "signal_gaps",
    "stability_map",
    "sweep_map",
    "time_response",
    "whiteness_plot",
    "window_comparison",
    "window_gaps",
]
