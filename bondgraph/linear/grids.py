"""Grids of time and frequency that show what the poles do."""

from __future__ import annotations

import numpy

Array = numpy.ndarray

# A decay is followed to a thousandth, a growth to a thousandfold.
DECAY = float(numpy.log(1000.0))
PERIODS = 60  # an oscillation is followed no longer than this
POINTS_PER_PERIOD = 24
FEWEST, MOST = 201, 4001
PER_DECADE = 60
UNDAMPED = 1e-9  # beside the imaginary part, a smaller real one is none
SMALL = 1e-10  # beside the fastest pole, a slower one is at zero


def time_grid(poles: Array) -> Array:
    """Return evenly spaced times from zero, s.

    Parameters
    ----------
    poles : (n,) complex array

    Returns
    -------
    (nt,) array
        Until the slowest mode has decayed, or the first has grown, with some points in
        each period of the fastest oscillation as far as 4001 of them allow.

    Examples
    --------
    >>> times = time_grid(numpy.array([-2.0]))
    >>> len(times), round(float(times[-1]), 3)
    (201, 3.454)
    """
    moving = poles[numpy.abs(poles) > SMALL * numpy.abs(poles).max(initial=0.0)]
    if not len(moving):
        return numpy.linspace(0.0, 1.0, FEWEST)
    decays, turns = numpy.abs(moving.real), numpy.abs(moving.imag)
    with numpy.errstate(divide="ignore"):
        spans = numpy.minimum(DECAY / decays, PERIODS * 2 * numpy.pi / turns)
    growing = moving.real > SMALL * numpy.abs(moving)
    end = float(DECAY / decays[growing].max() if growing.any() else spans.max())
    count = int(min(POINTS_PER_PERIOD * end * turns.max() / (2 * numpy.pi), MOST)) + 1
    return numpy.linspace(0.0, end, min(max(count, FEWEST), MOST))


def frequency_grid(roots: Array) -> Array:
    """Return frequencies, rad/s, from a decade below the slowest root to one above the fastest.

    Parameters
    ----------
    roots : (n,) complex array
        Poles and zeros.

    Returns
    -------
    (nw,) array
        Evenly spaced by their logarithm, and closer about lightly damped roots.

    Examples
    --------
    >>> grid = frequency_grid(numpy.array([-2.0]))
    >>> grid[[0, -1]].round(9).tolist()
    [0.2, 20.0]
    """
    sizes = numpy.abs(roots)
    sizes = sizes[sizes > SMALL * sizes.max(initial=0.0)]
    low, high = (sizes.min() / 10, sizes.max() * 10) if len(sizes) else (0.1, 10.0)
    count = int(numpy.ceil(PER_DECADE * numpy.log10(high / low))) + 1
    even = numpy.geomspace(low, high, min(max(count, FEWEST), MOST))
    light = roots[(roots.imag > 0) & (numpy.abs(roots.real) < 0.2 * roots.imag)]
    damped = numpy.abs(light.real) > UNDAMPED * light.imag
    widths = numpy.where(damped, numpy.abs(light.real), 1e-3 * light.imag)
    near = (light.imag[:, None] + widths[:, None] * numpy.linspace(-4, 4, 33)).ravel()
    grid = numpy.unique(numpy.concatenate([even, near[(near > low) & (near < high)]]))
    for root in light.imag[~damped]:  # there is no value there, and none to trust beside it
        grid = grid[numpy.abs(grid - root) > 1e-6 * root]
    return grid
