"""A recording as a frozen value."""

import pickle

import numpy as np
import pytest

from bondgraph.discrepancy import Measurement
from bondgraph.errors import MeasurementError


def test_gaps_are_nan_and_told():
    run = Measurement([0, 1, 2], {"v": [1, np.inf, 3]}, name="a")
    assert np.isnan(run.columns["v"][1]) and run.present("v").tolist() == [True, False, True]
    with pytest.raises(TypeError):
        run.columns["w"] = [1, 2, 3]


@pytest.mark.parametrize(
    ("t", "columns", "match"),
    [
        ([0, 1, 1], {"v": [1, 2, 3]}, "increase; they do not at row 2"),
        ([0, np.nan], {"v": [1, 2]}, "finite times"),
        ([0], {"v": [1]}, "two finite times"),
        ([0, 1], {"v": [1, 2, 3]}, "'v': 3 values for 2 times"),
        ([0, 1], {"v": [np.nan, np.nan]}, "'v': no finite value"),
        ([0, 1], {}, "no column"),
    ],
)
def test_malformed(t, columns, match):
    with pytest.raises(MeasurementError, match=match):
        Measurement(t, columns, name="run 7")


def test_pickles():
    run = Measurement([0, 1], {"v": [1, 2]}, {"v": "m/s"}, {"v": "zero"}, {"m.p": 1.0}, "run")
    again = pickle.loads(pickle.dumps(run))
    assert again.columns["v"].tolist() == [1, 2] and again.name == "run"
    assert (again.units, again.holds, again.initial) == (run.units, run.holds, run.initial)
