"""The times between which a model is followed: those of the samples, and some between."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy

from ...equations import Equations
from ...simulation.inputs import at, gather

Array = numpy.ndarray

FINEST = 16  # steps between two samples


@dataclass(frozen=True, eq=False)
class Grid:
    """Times, and what drives the model there.

    Attributes
    ----------
    t : (nt,) array, s
    samples : (ns,) array of int
        Which of the times are those of samples.
    before, after : (nt, m) array
        Inputs just before and just after each time.
    """

    t: Array
    samples: Array
    before: Array
    after: Array

    def __len__(self) -> int:
        return len(self.t)


def grid_of(
    equations: Equations, t: Array, inputs: Mapping[str, Any], step: float = numpy.inf
) -> Grid:
    """Lay a grid over samples.

    Parameters
    ----------
    equations : Equations
    t : (ns,) array
        Times of the samples.
    inputs : mapping
        As for `bondgraph.simulate`.
    step : float
        Longest wanted, s; a sample's interval is cut into 16 at most.

    Returns
    -------
    Grid

    Examples
    --------
    >>> from bondgraph import derive
    >>> from bondgraph.models import quarter_car
    >>> grid = grid_of(derive(quarter_car.graph()), numpy.array([0.0, 1.0, 3.0]), {}, 1.0)
    >>> grid.t.tolist(), grid.samples.tolist()
    ([0.0, 1.0, 2.0, 3.0], [0, 1, 3])
    """
    steps = numpy.diff(t)
    cuts = numpy.clip(numpy.ceil(steps / step * (1 - 1e-9)), 1, FINEST).astype(int)
    samples = numpy.concatenate([[0], numpy.cumsum(cuts)])
    start = numpy.repeat(t[:-1], cuts)
    width = numpy.repeat(steps / cuts, cuts)
    number = numpy.arange(samples[-1]) - numpy.repeat(samples[:-1], cuts)
    times = numpy.concatenate([start + number * width, t[-1:]])
    times[samples] = t
    table = gather(equations, inputs)
    near = 1e-9 * numpy.concatenate([[0.0], numpy.diff(times)])
    return Grid(times, samples, at(table, times - near).T, at(table, times).T)
