"""Verdicts from multipliers."""

import numpy
import pytest

from bondgraph.cycles import Floquet


@pytest.mark.parametrize(
    ("sizes", "autonomous", "verdict"),
    [
        ([1.0, 0.3, 0.0], True, "stable"),
        ([1.0, -1.2], True, "unstable"),
        ([1.0, 1.0], True, "undecided"),
        ([1.0, 0.5], False, "undecided"),
        ([0.9, -0.5], False, "stable"),
    ],
)
def test_verdict(sizes, autonomous, verdict):
    found = Floquet.of(numpy.diag(sizes), autonomous)
    assert found.verdict == verdict and found.stable == (verdict == "stable")


def test_the_trivial_one_is_that_along_the_orbit():
    """Two multipliers next to one: the direction of the orbit tells which is a shift along it."""
    monodromy = numpy.diag([1.0 + 2e-4, 1.0 - 3e-4, 0.1])
    found = Floquet.of(monodromy, True, along=numpy.array([0.0, 5.0, 0.0]))
    assert found.multipliers[found.trivial].real == pytest.approx(1 - 3e-4)
    assert found.verdict == "unstable"


def test_zeros_are_counted():
    basis = numpy.array([[1.0, 2.0, 0.0], [0.0, 1.0, 3.0], [1.0, 0.0, 1.0]])
    monodromy = basis @ numpy.diag([1.0, 0.0, 0.0]) @ numpy.linalg.inv(basis)
    assert Floquet.of(monodromy, True).zeros == 2


def test_a_turning_pair():
    turn = 0.8 * numpy.array([[0.6, -0.8], [0.8, 0.6]])
    found = Floquet.of(turn, False)
    assert abs(found.multipliers) == pytest.approx([0.8, 0.8]) and found.stable
