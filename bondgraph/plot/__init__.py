"""Plots of trajectories, linear systems, eigenvalue loci, sweeps, friction laws and gaps, on matplotlib axes.

Each function draws on the axes it is given, or on those of a new figure, and
returns the axes. pyplot is not used, so nothing is kept or shown. The colours
are told apart by colour-blind readers, the line styles in black and white.

References
----------
Okabe, Ito, Color universal design, 2008 (the palette).
"""

from .attractors import attractor_plot, reach_plot
from .bars import feed_bars, sensitivity_bars, share_bars
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
from .maps import damping_map, least_damping, stability_map
from .modes import energy_plot, mode_shape_plot, pole_zero_plot
from .motion import application, overview, phase_plane, time_response
from .periodograms import whiteness_plot, window_comparison
from .responses import bode_plot, step_plot
from .style import PALETTE, Signal, new_axes, pretty, save, signal
from .sweeps import sweep_map

__all__ = [
    "PALETTE",
    "Signal",
    "application",
    "attractor_plot",
    "bode_plot",
    "coherence_plot",
    "course_plot",
    "damping_map",
    "feed_bars",
    "energy_plot",
    "frequency_gaps",
    "friction_curve",
    "gap_course",
    "gap_shares",
    "gap_spectra",
    "growth_rates",
    "learned_law",
    "least_damping",
    "mode_shape_plot",
    "new_axes",
    "overview",
    "phase_plane",
    "pole_zero_plot",
    "pretty",
    "reach_plot",
    "region_gaps",
    "root_locus",
    "save",
    "sensitivity_bars",
    "share_bars",
    "signal",
    "signal_gaps",
    "stability_map",
    "step_plot",
    "sweep_map",
    "time_response",
    "whiteness_plot",
    "window_comparison",
    "window_gaps",
]
