"""Fewer and equal steps against the signals they were taken from."""

import numpy as np
import pytest

from bondgraph.discrepancy.measurement import Measurement, decimated, resampled, sampling
from bondgraph.errors import MeasurementError

T = np.arange(4000) / 1000


def tone(f):
    return np.sin(2 * np.pi * f * T)


@pytest.mark.parametrize("n", [2, 5, 10])
def test_what_passes_and_what_would_alias(n):
    nyquist = 500 / n
    run = Measurement(T, {"slow": tone(0.6 * nyquist), "fast": tone(1.05 * nyquist)})
    found = decimated(run, n)
    inner = slice(12, -12)
    np.testing.assert_array_equal(found.t, T[::n])
    np.testing.assert_allclose(
        found.columns["slow"][inner], tone(0.6 * nyquist)[::n][inner], atol=4e-3
    )
    assert np.abs(found.columns["fast"][inner]).max() < 4e-3
    assert np.abs(tone(1.05 * nyquist)[::n]).max() > 0.5  # what plain thinning would leave


def test_gaps_holds_and_initial_states():
    slow = tone(2)
    slow[1000:1100] = np.nan
    run = Measurement(T, {"x": slow, "F": tone(1)}, holds={"F": "zero"}, initial={"m.p": 0.0})
    found = decimated(run, 10)
    assert np.isnan(found.columns["x"]).nonzero()[0].tolist() == list(range(100, 110))
    assert dict(found.holds) == {"F": "linear"} and not found.initial
    assert decimated(run, 1) is run


def test_a_held_input_keeps_its_phase():
    run = Measurement(T, {"F": tone(20)}, holds={"F": "zero"})
    found = decimated(run, 4)
    late = np.sin(2 * np.pi * 20 * (found.t - 0.0005))  # a staircase lags by half a step
    np.testing.assert_allclose(found.columns["F"][12:-12], late[12:-12], atol=5e-3)


def test_jittered_rows_become_equal_steps():
    t = (np.arange(5000) + np.random.default_rng(1).uniform(-0.4, 0.4, 5000)) * 0.002
    run = Measurement(t, {"x": np.sin(t)})
    found = resampled(run, 0.05)  # twenty-five steps to one
    assert sampling(found).uniform and found.t[1] - found.t[0] == pytest.approx(0.05)
    kept = found.present("x")
    assert kept.all()
    np.testing.assert_allclose(found.columns["x"][kept], np.sin(found.t[kept]), atol=2e-3)


def test_lost_rows_are_not_invented():
    t = np.delete(np.arange(100.0), np.arange(40, 60))
    found = resampled(Measurement(t, {"x": t, "F": t}, holds={"F": "zero"}), 0.5)
    lost = ~found.present("x")
    assert found.t[lost].min() == 39.5 and found.t[lost].max() == 59.5
    np.testing.assert_allclose(found.columns["x"][~lost], found.t[~lost])
    np.testing.assert_allclose(found.columns["F"][~lost], np.floor(found.t[~lost]))


@pytest.mark.parametrize(
    ("part", "words"),
    [
        (lambda run: decimated(run, 0), "decimated by 0, which is no count"),
        (lambda run: decimated(run, 2.5), "decimated by 2.5"),
        (lambda run: decimated(run, 10), "11 rows are too few to be decimated by 10"),
        (lambda run: resampled(run, -1.0), "interval of -1 s does not fit"),
        (lambda run: resampled(run, 100.0), "interval of 100 s does not fit"),
    ],
)
def test_what_cannot_be(part, words):
    with pytest.raises(MeasurementError, match=words):
        part(Measurement(np.arange(11.0), {"x": np.ones(11)}))


def test_unequal_steps_are_not_decimated():
    with pytest.raises(MeasurementError, match="resample it first"):
        decimated(Measurement(np.arange(100.0) ** 1.1, {"x": np.ones(100)}), 2)
