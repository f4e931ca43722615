"""Limits, steps and outliers that were put in by hand."""

import numpy as np
import pytest

from bondgraph.discrepancy.measurement import Measurement, outliers, quantisation, saturation
from bondgraph.errors import MeasurementError

T = np.linspace(0, 10, 1001)
SINE = np.sin(2 * T)


def of(values):
    return Measurement(T, {"x": values}, name="run")


def test_a_clipped_sine():
    low, high = saturation(of(np.clip(SINE, -2, 0.8)), "x")
    assert low is None and high.level == 0.8
    assert high.fraction == pytest.approx(np.mean(SINE >= 0.8), abs=1e-12)
    assert high.longest == pytest.approx(np.arccos(0.8) / 0.01, abs=1)
    assert saturation(of(SINE), "x") == (None, None) == saturation(of(np.ones(1001)), "x")


def test_a_clipped_column_with_gaps():
    values = np.clip(SINE, -0.5, 2)
    values[::7] = np.nan
    low, high = saturation(of(values), "x")
    assert high is None and low.level == -0.5
    assert low.fraction == pytest.approx(np.mean(values[~np.isnan(values)] == -0.5))


@pytest.mark.parametrize("step", [0.05, 0.1, 0.0049])
def test_the_step_of_a_converter(step):
    values = step * np.round(SINE / step)
    assert quantisation(of(values), "x") == pytest.approx(step, rel=1e-3)
    assert quantisation(of(np.round(values, 6)), "x") == pytest.approx(step, rel=1e-3)


def test_digits_of_a_file_that_no_two_neighbours_show():
    values = np.array([0, 2, 5, 9, 14, 2, 5, 0]) * 1e-6 + 3
    assert quantisation(Measurement(range(8), {"x": values}), "x") == pytest.approx(1e-6, rel=1e-6)


def test_values_on_no_grid():
    noise = np.random.default_rng(2).normal(size=1001)
    noise[500] = noise[501]
    assert quantisation(of(noise), "x") is None
    assert quantisation(of(SINE), "x") is None
    assert quantisation(of(np.where(T < 5, 0.0, 1.0)), "x") is None  # two levels are no grid


@pytest.mark.parametrize("noise", [0.0, 0.01, 0.1])
def test_spikes_are_marked_and_little_else(noise):
    rng = np.random.default_rng(4)
    values = SINE + noise * rng.normal(size=1001)
    places = rng.choice(1001, 20, replace=False)
    values[places] += rng.choice([-1, 1], 20) * 3.0
    values[[50, 300]] = np.nan
    places = np.setdiff1d(places, [50, 300])
    found = outliers(of(values), "x")
    assert found[places].all() and not found[[50, 300]].any()
    assert found.sum() - len(places) <= 3


def test_steps_and_rest_are_no_outliers():
    assert not outliers(of(np.where(T < 5, 0.0, 1.0)), "x").any()
    resting = np.zeros(1001)
    resting[::50] = 0.01  # the last digit flickers
    resting[500:] = 0.01 * np.round(100 * SINE[500:])
    assert not outliers(of(resting), "x").any()


def test_what_cannot_be_tested():
    with pytest.raises(MeasurementError, match="run, column 'x': an outlier test"):
        outliers(of(SINE), "x", half=0)
    with pytest.raises(MeasurementError, match="no column 'z'"):
        quantisation(of(SINE), "z")
