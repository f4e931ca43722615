"""A model along a course of its states: how it goes on from each time, and what it says there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy

from .functions import Functions, Points
from .grid import Grid
from .phi import phis

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Along:
    """A linearised model along a course.

    The states' deviation d from the course, and small changes c of parameters, obey
    ``d[k+1] = onward[k] d[k] + forced[k] c - broken[k]`` but for the model's error, and
    ``missed[i] = seen[i] d[k(i)] + felt[i] c`` but for the noise.

    Attributes
    ----------
    onward : (nt - 1, n, n) array
    forced : (nt - 1, n, q) array
    broken : (nt - 1, n) array
        What the course is off the model's own step.
    seen : (ns, ny, n) array
    felt : (ns, ny, q) array
    missed : (ns, ny) array
        Measured less said; NaN at gaps.
    rates, x : (nt, n) array
        Rates along the course, and the course.
    first, second : (nt - 1, n, n) arrays
        What a rate just after a time, and just before the next, adds to the step.
    """

    onward: Array
    forced: Array
    broken: Array
    seen: Array
    felt: Array
    missed: Array
    rates: Array
    x: Array
    first: Array
    second: Array

    def with_columns(self, forced: Array, felt: Array) -> Along:
        """Return the same with other things that may change."""
        return replace(self, forced=forced, felt=felt)

    def pushed(self, before: Array, after: Array) -> Array:
        """Return what rates add to each step, shape (nt - 1, n, q).

        Parameters
        ----------
        before, after : (nt, n, q) array
            Just before and just after each time; straight lines between.
        """
        return self.first @ after[:-1] + self.second @ before[1:]


def along(
    functions: Functions,
    grid: Grid,
    x: Array,
    p: Array,
    measured: Array,
) -> tuple[Along, Points, Points]:
    """Linearise a model along a course.

    Parameters
    ----------
    functions : Functions
    grid : Grid
    x : (nt, n) array
        The course.
    p : (np,) array
    measured : (ns, ny) array
        NaN at gaps.

    Returns
    -------
    Along
    Points
        Just before each time of the grid.
    Points
        Just after.

    Notes
    -----
    Exponential trapezoidal rule: exact for linear models whose inputs are steps or straight lines.
    """
    after = functions.at(grid.t, x, grid.after, p)
    same = numpy.array_equal(grid.before, grid.after)
    before = after if same else functions.at(grid.t, x, grid.before, p)
    h = numpy.diff(grid.t)
    mean = 0.5 * (after.rates_x[:-1] + before.rates_x[1:])
    constant = len(mean) > 1 and numpy.ptp(mean, axis=0).max() <= 1e-12 * numpy.abs(mean).max()
    even = numpy.ptp(h) <= 1e-9 * h.max()
    if constant and even:
        whole, first, second = (
            numpy.broadcast_to(part, mean.shape) for part in phis(mean[:1] * h[0])
        )
    else:
        whole, first, second = phis(mean * h[:, None, None])
    begun = h[:, None, None] * (first - second)
    ended = h[:, None, None] * second
    rest_after = after.rates[:-1] - _times(mean, x[:-1])
    rest_before = before.rates[1:] - _times(mean, x[1:])
    step = _times(whole, x[:-1]) + _times(begun, rest_after) + _times(ended, rest_before)
    forced = begun @ after.rates_p[:-1] + ended @ before.rates_p[1:]
    # a sample that falls on a step of an input is taken as just before it
    at = grid.samples
    found = Along(
        onward=whole,
        forced=forced,
        broken=x[1:] - step,
        seen=before.outputs_x[at],
        felt=before.outputs_p[at],
        missed=measured - before.outputs[at],
        rates=0.5 * (before.rates + after.rates),
        x=x,
        first=begun,
        second=ended,
    )
    return found, before, after


def _times(matrices: Array, vectors: Array) -> Array:
    return numpy.einsum("kij,kj->ki", matrices, vectors)
