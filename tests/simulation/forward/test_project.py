"""Projections where rates are no numbers end in a named answer."""

import numpy
import pytest

from bondgraph.simulation.forward.project import Projector
from bondgraph.simulation.forward.value import NON_FINITE, Undefined


class Overflown(Projector):
    def __init__(self, push):
        self.push = push

    def _slopes(self, t, x, codes):
        return numpy.array([[1.0, 0.0]]), numpy.zeros((1, 1))

    def _rates(self, t, x, codes):
        return numpy.zeros(2) if codes[0] == 0 else numpy.array([self.push, 0.0])


PLACE = (0.5, numpy.zeros(2), numpy.array([0.0]), numpy.ones((2, 1)), numpy.zeros((1, 1)))


def test_a_stuck_contact_allows_no_slip():
    assert Overflown(-3.0)(*PLACE)[:, 0] == pytest.approx([0.0, 1.0])


def test_rates_that_are_no_numbers_are_named():
    with pytest.raises(Undefined) as failure:
        Overflown(numpy.inf)(*PLACE)
    assert failure.value.why == NON_FINITE and failure.value.t == 0.5
