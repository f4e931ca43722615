"""Noise floors against noise that was put in."""

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from bondgraph.discrepancy.measurement import Measurement, noise_floor, read_all
from bondgraph.errors import MeasurementError

DATA = Path(__file__).parents[1] / "data"
LEVELS = [0.002, 0.02, 0.1, 0.2]


def tone(level, per_period, seed=0, n=2000):
    """A tone with noise, and the noise's standard deviation."""
    rng = np.random.default_rng(seed)
    x = np.sin(2 * np.pi * np.arange(n) / per_period + 6 * rng.random())
    std = level * x.std()
    return Measurement(np.arange(n), {"x": x + std * rng.normal(size=n)}), std


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("per_period", [100, 20, 8])
def test_oversampled(level, per_period):
    run, std = tone(level, per_period)
    floor = noise_floor(run, "x")
    assert floor.reliable and floor.method == "differences"
    assert floor.std == pytest.approx(std, rel=0.15)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("per_period", [6, 5, 4, 3.5, 3, 2.7, 2.5, 2.3, 2.1, 2])
def test_coarse_sampling_is_right_or_flagged(level, per_period):
    for seed in range(5):
        run, std = tone(level, per_period, seed)
        floor = noise_floor(run, "x")
        assert not floor.reliable or floor.std == pytest.approx(std, rel=0.3)
        if per_period <= 3:
            assert not floor.reliable


def test_a_fast_signal_without_noise_is_flagged():
    floor = noise_floor(tone(0.0, 2.001)[0], "x")
    assert not floor.reliable and "of the whole signal" in floor.reason


def test_of_coloured_noise_the_highest_frequencies_are_seen():
    e = np.random.default_rng(1).normal(size=8000)
    red = lfilter([1], [1, -0.5], e)
    floor = noise_floor(Measurement(np.arange(8000), {"x": red + 0.1 * np.arange(8000)}), "x")
    assert floor.std == pytest.approx(1 / 1.5, rel=0.15)  # |1 / (1 + 0.5)| at the Nyquist frequency


def test_unequal_steps_gaps_and_jumps():
    rng = np.random.default_rng(5)
    t = np.cumsum(rng.uniform(0.5, 1.5, 3000)) * 0.01
    x = np.sin(3 * t) + np.floor(t / 5) + 0.03 * rng.normal(size=3000)
    x[rng.random(3000) < 0.1] = np.nan
    floor = noise_floor(Measurement(t, {"x": x}), "x")
    assert floor.reliable and floor.std == pytest.approx(0.03, rel=0.15)


def test_rounding_is_a_floor():
    t = np.arange(3000) * 0.001
    floor = noise_floor(Measurement(t, {"x": np.round(np.sin(t), 2)}), "x")
    assert floor.std == pytest.approx(0.01 / np.sqrt(12), rel=0.01) and "rounded" in floor.reason


def test_few_values_are_flagged():
    assert "too few" in noise_floor(tone(0.02, 40, n=30)[0], "x").reason
    with pytest.raises(MeasurementError, match="three values"):
        noise_floor(tone(0.02, 40, n=2)[0], "x")


def repeat(seed, level, shift=0.0, start=0.0):
    rng = np.random.default_rng(seed)
    t = np.arange(400) * 0.1
    x = np.sin(22 * t + shift)  # 2.9 samples a period: differences alone cannot tell
    return Measurement(t + start, {"x": x + level * rng.normal(size=400)}, name=f"run {seed}")


@pytest.mark.parametrize("level", LEVELS)
def test_repeats_tell_noise_where_differences_cannot(level):
    first, *others = (repeat(seed, level, start=seed) for seed in range(4))
    alone = noise_floor(first, "x")
    assert not alone.reliable or alone.std == pytest.approx(level, rel=0.2)
    floor = noise_floor(first, "x", others)
    assert floor.reliable and floor.method == "repeats"
    assert floor.std == pytest.approx(level, rel=0.1)


def test_repeats_that_are_none():
    slow = [
        Measurement(np.arange(400), {"x": np.sin(np.arange(400) / 30 + s)}) for s in (0, 0.2, 0.4)
    ]
    floor = noise_floor(slow[0], "x", slow[1:])
    assert not floor.reliable and "drift apart" in floor.reason
    with pytest.raises(MeasurementError, match="run 1: is not sampled at the times of run 0"):
        noise_floor(repeat(0, 0.1), "x", [repeat(1, 0.1).between(0, 20)])


def test_a_real_encoder():
    run = read_all(DATA / "pendulum_single_uw.csv", segment="seg", time="t_s")[0]
    floor = noise_floor(run, "theta_rad")
    # no less than what six digits leave out, and far below the milliradians that models miss by
    assert floor.reliable and 1e-6 / np.sqrt(12) < floor.std < 1e-3
