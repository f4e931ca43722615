"""Outliers, and the samples beside them that a smoother draws along."""

import numpy

from bondgraph.discrepancy.discovery.outliers import _peaks


def test_of_neighbours_the_largest_is_the_outlier():
    off = numpy.zeros(20)
    off[[4, 5, 6]] = 0.5, 3.0, 0.6
    off[15] = 2.0
    marked = _peaks(off)
    assert marked[5] and marked[15]
    assert not marked[[4, 6]].any()


def test_gaps_are_no_peaks_beside_outliers():
    off = numpy.array([0.0, numpy.nan, 4.0, numpy.nan, 0.1])
    assert numpy.flatnonzero(_peaks(off)).tolist() == [2]
