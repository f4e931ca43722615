"""Noise floors, gaps by signal and by window."""

import numpy as np
import pytest
from scipy.stats import binom

from bondgraph.discrepancy import Floor, Residuals, by_signal, by_window, noise_floor
from bondgraph.errors import MeasurementError


def white(seed, n=1000, sigma=1.0):
    return np.random.default_rng(seed).normal(0, sigma, n)


def over_zero(y, **more):
    return Residuals(np.arange(len(y)) / 1000, {"v": y}, {"v": np.zeros(len(y))}, **more)


@pytest.mark.parametrize("n", [400, 4000])
def test_floor_of_white_noise(n):
    found = np.array([noise_floor(white(seed, n, 0.3)).sigma for seed in range(300)])
    assert abs(found.mean() / 0.3 - 1) < 0.01
    # scatter as the degrees of freedom say: relative variance 1 / (2 freedom)
    assert 0.7 < found.std() / 0.3 * np.sqrt(2 * noise_floor(white(0, n)).freedom) < 1.3


def test_floor_under_a_signal_with_jumps_and_gaps():
    t = np.linspace(0, 1, 5000)
    y = 50 * np.sin(30 * t) + 100 * (t > 0.3) + white(1, 5000, 0.02)
    y[::97] = np.nan
    assert abs(noise_floor(y).sigma - 0.02) < 0.001


def test_floor_of_uneven_samples():
    rng = np.random.default_rng(4)
    t = np.cumsum(rng.uniform(0.5, 1.5, 4000)) / 4000
    y = 5 * np.sin(40 * t) + white(2, 4000, 0.02)
    assert abs(noise_floor(y, t).sigma - 0.02) < 0.0015


def test_floor_needs_samples():
    with pytest.raises(MeasurementError, match="give floor="):
        noise_floor(np.ones(30))
    with pytest.raises(MeasurementError, match="give 0 or more"):
        by_signal(over_zero(white(0)), floor=-1)


def test_bias_and_noise_add_up():
    row = by_signal(over_zero(white(3, 100_000, 0.4) + 0.3), floor=0.4)["v"]
    assert abs(row.bias - 0.3) < 0.005 and abs(row.rmse - 0.5) < 0.005
    assert abs(row.above - 0.36) < 0.01 and row.share == 1.0


def test_shares_go_by_the_variance_of_each_signal():
    t = np.linspace(0, 20 * np.pi, 5001)
    s = np.sin(t)
    found = Residuals(t, {"a": 1.2 * s, "b": 1000 * 1.1 * s}, {"a": s, "b": 1000 * s})
    gaps = by_signal(found, floor={"a": 0.0, "b": Floor(0.0)})
    share = (0.2 / 1.2) ** 2 / ((0.2 / 1.2) ** 2 + (0.1 / 1.1) ** 2)
    assert gaps["a"].share == pytest.approx(share, rel=1e-3)
    assert gaps["a"].nrmse == pytest.approx(0.2 / 1.2, rel=1e-3) and len(gaps) == 2


@pytest.mark.parametrize("floor", [1.0, None], ids=["known", "estimated"])
def test_noise_alone_raises_no_window_at_the_rate_stated(floor):
    runs, alpha = 400, 0.05
    found = [
        by_window(over_zero(white(s, 500)), "v", 10, floor=floor, alpha=alpha) for s in range(runs)
    ]
    most = binom.isf(0.001, runs, alpha)
    assert sum(one.significant.any() for one in found) <= most
    assert sum(one.onset is not None for one in found) <= most


def test_correlated_noise_counts_for_less():
    from scipy.signal import lfilter

    rho, runs, alarms = 0.9, 300, {0.0: 0, -1e-3 / np.log(0.9): 0}
    for seed in range(runs):
        y = lfilter([np.sqrt(1 - rho**2)], [1, -rho], white(seed, 1200))[200:]
        for time in alarms:
            gaps = by_window(over_zero(y), "v", 5, floor=1.0, correlation_time=time, alpha=0.05)
            alarms[time] += bool(gaps.significant.any())
    plain, told = alarms.values()
    # chi-squared with effective samples has lighter tails than the sum it stands for
    assert plain > 0.4 * runs and told < 0.13 * runs


@pytest.mark.parametrize("size", [0.9, 3.0])
def test_planted_window_and_onset(size):
    y = white(5, 4000)
    y[2400:3200] += size * np.sqrt(2) * np.sin(np.arange(800))
    gaps = by_window(over_zero(y), "v", 10, floor=1.0)
    assert np.flatnonzero(gaps.significant).tolist() == [6, 7]
    assert gaps.share[[6, 7]].sum() > 0.8 and abs(gaps.onset - 2.4) < 0.1


def test_given_windows_outliers_and_gaps():
    y = white(6, 2000)
    y[500] = 200.0  # one outlier is in its window, and no onset
    y[1500:1600] = np.nan
    gaps = by_window(over_zero(y), "v", [(0.4, 0.6), (1.5, 1.599), (1.7, 1.9)], floor=1.0)
    assert gaps.significant.tolist() == [True, False, False] and gaps.onset is None
    assert gaps.count.tolist() == [200, 0, 201] and np.isnan(gaps.rmse[1])


@pytest.mark.parametrize("windows", [0, [(1, 0)], [1, 2, 3]])
def test_windows_without_meaning(windows):
    with pytest.raises(MeasurementError, match="window"):
        by_window(over_zero(white(0)), "v", windows)


def test_without_noise_any_gap_counts():
    y = np.zeros(100)
    assert not by_window(over_zero(y), "v", 5, floor=0.0).significant.any()
    y[70:] = 1e-9
    gaps = by_window(over_zero(y), "v", 5, floor=0.0)
    assert gaps.significant.tolist() == [False] * 3 + [True] * 2 and gaps.onset == 0.07
