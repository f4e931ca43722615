"""Grids: the samples' times stay, and inputs are known on both sides of their steps."""

import itertools

import numpy
import pytest

from bondgraph import derive
from bondgraph.discrepancy.latent.grid import FINEST, grid_of
from bondgraph.simulation import Samples

from ..machines import MACHINES

EQUATIONS = derive(MACHINES["mass_spring"]())
T = numpy.array([0.0, 0.1, 0.4, 0.45, 2.0])


@pytest.mark.parametrize("step", [numpy.inf, 0.2, 0.03, 1e-6])
def test_samples_are_on_the_grid_and_steps_no_longer_than_wanted(step):
    grid = grid_of(EQUATIONS, T, {}, step)
    assert grid.t[grid.samples].tolist() == T.tolist()
    assert (numpy.diff(grid.t) > 0).all()
    cuts = numpy.diff(grid.samples)
    assert cuts.max() <= FINEST
    widths = [numpy.diff(grid.t[a : b + 1]) for a, b in itertools.pairwise(grid.samples)]
    assert all(numpy.ptp(part) < 1e-12 for part in widths)
    full = cuts == FINEST
    assert all(part.max() <= step * 1.001 or at for part, at in zip(widths, full, strict=True))


def test_steps_of_inputs_have_two_sides():
    values = numpy.array([1.0, 3.0, -2.0, 5.0, 4.0])
    held = grid_of(EQUATIONS, T, {"push": Samples(T, values, "zero")}, 0.05)
    at = held.samples
    assert held.after[at, 0].tolist() == values.tolist()
    assert held.before[at[1:], 0].tolist() == values[:-1].tolist()
    straight = grid_of(EQUATIONS, T, {"push": (T, values)}, 0.05)
    assert numpy.allclose(straight.before, straight.after, atol=1e-7)
    assert numpy.allclose(straight.after[:, 0], numpy.interp(straight.t, T, values))
