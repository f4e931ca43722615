"""Facts about times and gaps."""

import numpy as np
import pytest

from bondgraph.discrepancy.measurement import Measurement, gaps, sampling


def over(t):
    return Measurement(t, {"x": np.ones(len(t))})


def test_rounded_times_are_uniform_and_jittering_ones_are_not():
    t = np.arange(200) / 30
    assert sampling(over(np.round(t, 5))).uniform
    jitter = 0.02 * np.random.default_rng(0).uniform(-1, 1, 200) / 30
    found = sampling(over(t + jitter))
    assert not found.uniform and 0.02 < found.jitter < 0.04 and found.gaps == ()
    assert found.interval == pytest.approx(1 / 30, rel=0.01)


def test_lost_rows_are_gaps():
    found = sampling(over(np.delete(np.arange(20.0), [7, 8])))
    assert found.gaps == ((6.0, 9.0),) and found.interval == 1 and not found.uniform


def test_gaps_of_a_column_lie_in_cells_and_in_rows():
    t = np.delete(np.arange(20.0), [12])
    x = np.where((t >= 3) & (t <= 4) | (t < 1), np.nan, t)
    run = Measurement(t, {"x": x, "y": t})
    assert gaps(run, "x") == ((0.0, 1.0), (2.0, 5.0), (11.0, 13.0))
    assert gaps(run, "y") == ((11.0, 13.0),)
    assert gaps(over(np.arange(5.0)), "x") == ()
