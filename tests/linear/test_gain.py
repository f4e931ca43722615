"""Gain at frequency zero, where integrators lie between and where they lie aside."""

import numpy
import pytest

from bondgraph.linear.gain import static_gain
from bondgraph.linear.realisation import Realisation

from .graphs import floating, following


def plant(a, b, c, d=0.0):
    a, b, c = (numpy.array(part, dtype=float) for part in (a, b, c))
    return Realisation(a, b, c, (numpy.full((len(c), b.shape[1]), float(d)),))


def test_each_channel_for_itself():
    """A force on a mass with a damper: the position runs away, the speed settles."""
    assert floating().dcgain().tolist() == [[numpy.inf], [0.25]]


def test_signs_of_integrators():
    assert static_gain(plant([[0]], [[1]], [[-2], [3]])).tolist() == [[-numpy.inf], [numpy.inf]]


def test_two_integrators_in_turn():
    """-1/s^2 + 5/s goes to minus infinity."""
    chain = [[0, 1], [0, 0]]
    assert static_gain(plant(chain, [[0], [1]], [[-1, 5]])).tolist() == [[-numpy.inf]]


def test_an_integrator_aside_does_not_matter():
    """Of no output, of no input, and in a basis where that does not meet the eye."""
    a = numpy.diag([0.0, 0.0, -2.0])
    b, c = numpy.array([[0.0], [1.0], [4.0]]), numpy.array([[1.0, 0.0, 3.0]])
    turn = numpy.linalg.qr(numpy.random.default_rng(1).normal(size=(3, 3)))[0]
    turned = plant(turn @ a @ turn.T, turn @ b, c @ turn.T, 1)
    assert static_gain(turned) == pytest.approx(numpy.array([[7.0]]))


def test_a_zero_at_the_pole_leaves_a_number():
    """s / (s (s + 4)) at zero is a quarter; the general formula would be 0 / 0."""
    assert static_gain(plant([[0, 1], [0, -4]], [[0], [1]], [[0, 1]])) == pytest.approx(0.25)


def test_slow_is_not_zero():
    a = numpy.diag([-1e-9, -1e5])
    assert static_gain(plant(a, [[1], [1]], [[1, 1]])) == pytest.approx(1e9)


def test_without_states():
    nothing = Realisation(*(numpy.zeros(s) for s in ((0, 0), (0, 1), (1, 0))), (numpy.eye(1),))
    assert static_gain(nothing).tolist() == [[1]]


def test_where_a_rate_of_an_input_is_needed():
    """(2 s + 3 / s) and 2 s / (1 + 2 s)."""
    assert following().dcgain().tolist() == [[numpy.inf], [0]]
