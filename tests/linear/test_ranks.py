"""Ranks by reflections against singular values, and rows that are only moved."""

import numpy
import pytest

from bondgraph.linear.ranks import compressed


@pytest.mark.parametrize("shape", [(1, 1), (5, 2), (2, 5), (6, 6), (0, 3), (3, 0)])
def test_any_rank(shape):
    random = numpy.random.default_rng(0)
    for rank in range(min(shape) + 1):
        matrix = random.normal(size=(shape[0], rank)) @ random.normal(size=(rank, shape[1]))
        q, found = compressed(matrix, 1e-12)
        assert found == rank
        assert q.T @ q == pytest.approx(numpy.eye(shape[0]), abs=1e-14)
        assert abs(q.T @ matrix)[rank:] == pytest.approx(0, abs=1e-13)


def test_single_entries_are_moved_exactly():
    matrix = numpy.zeros((6, 2))
    matrix[4, 0], matrix[2, 1] = 0.1, -7.3
    q, rank = compressed(matrix, 1e-12)
    assert rank == 2 and set(q.ravel()) == {0, 1}
    assert (q.T @ matrix)[:2].tolist() == [[0, -7.3], [0.1, 0]]
