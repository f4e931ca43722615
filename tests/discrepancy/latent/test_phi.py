"""Matrix functions against scipy's exponential of block matrices."""

import numpy
import pytest
from scipy.linalg import expm

from bondgraph.discrepancy.latent.phi import phis
from bondgraph.errors import SimulationError


def _blocks(z):
    """exp of [[Z, 1, 0], [0, 0, 1], [0, 0, 0]] has exp(Z), phi1(Z) and phi2(Z) in its first row."""
    n = len(z)
    zero, one = numpy.zeros((n, n)), numpy.eye(n)
    whole = expm(numpy.block([[z, one, zero], [zero, zero, one], [zero, zero, zero]]))
    return whole[:n, :n], whole[:n, n : 2 * n], whole[:n, 2 * n :]


@pytest.mark.parametrize("size", [1e-8, 0.3, 5.0, 60.0])
def test_phis_are_blocks_of_an_exponential(size):
    many = size * numpy.random.default_rng(3).normal(size=(6, 4, 4)) / 2
    many[-1] = 0.0  # the norm of the largest sets the doublings of all
    many[:-1] -= size * numpy.eye(4)
    found = phis(many)
    for number, z in enumerate(many):
        for part, expected in zip(found, _blocks(z), strict=True):
            near = 1e-11 * max(1.0, numpy.abs(expected).max())
            assert numpy.allclose(part[number], expected, rtol=1e-9, atol=near)


def test_singular_and_nilpotent_matrices_have_phis():
    z = numpy.array([[[0.0, 1.0], [0.0, 0.0]]])
    whole, first, second = phis(z)
    assert numpy.allclose(whole[0], [[1, 1], [0, 1]])
    assert numpy.allclose(first[0], [[1, 0.5], [0, 1]])
    assert numpy.allclose(second[0], [[0.5, 1 / 6], [0, 0.5]])


def test_what_is_not_finite_is_refused():
    with pytest.raises(SimulationError, match="finite"):
        phis(numpy.array([[[numpy.nan]]]))
