"""Gaps by operating region, and the sentence that sums up."""

import numpy as np
import pytest
from scipy import signal, stats
from scipy.integrate import solve_ivp

from bondgraph.discrepancy import Residuals, by_region, gap_rate, locate
from bondgraph.errors import MeasurementError

N = 4000
T = np.arange(N) / 1000


def white(seed, n=N):
    return np.random.default_rng(seed).normal(size=n)


def slow(seed, rho=0.95, n=N):
    return signal.lfilter([np.sqrt(1 - rho**2)], [1, -rho], white(seed, n + 500))[500:]


def over_zero(y, **inputs):
    return Residuals(T[: len(y)], {"v": y}, {"v": np.zeros(len(y))}, {"v": "m/s"}, inputs=inputs)


def test_bins_by_scipy():
    x, y = slow(0), white(1)
    found = by_region(over_zero(y, x=x), "v", "x", bins=7, floor=1.0, permutations=9)
    mean, edges, _ = stats.binned_statistic(x, y, "mean", 7)
    spread = stats.binned_statistic(x, y, "std", 7)[0]
    assert np.allclose(found.mean, mean) and np.allclose(found.edges[0], edges)
    assert np.allclose(found.spread, spread) and found.count.sum() == N
    pair = by_region(over_zero(y, x=x, z=white(2)), "v", ("x", "z"), bins=(4, 3), permutations=9)
    grid = stats.binned_statistic_2d(x, white(2), y, "mean", [4, 3])[0]
    assert np.allclose(pair.mean, grid, equal_nan=True) and pair.count.shape == (4, 3)


def test_correlation_ratio_is_that_of_the_analysis_of_variance():
    x, y = np.arange(N) % 4, white(3) + 0.1 * (np.arange(N) % 4)
    found = by_region(over_zero(y, x=x), "v", "x", bins=4, floor=1.0, permutations=99)
    f = stats.f_oneway(*[y[x == k] for k in range(4)]).statistic
    assert found.of_mean.ratio == pytest.approx(3 * f / (3 * f + N - 4)) and found.of_mean.p == 0.01
    assert found.of_mean.expected == pytest.approx(3 / (N - 1), rel=0.4)


@pytest.mark.parametrize("gap", [white, slow], ids=["white", "slow"])
def test_no_dependence_is_found_at_the_rate_stated(gap):
    runs = 200
    found = [
        by_region(
            over_zero(gap(s, n=1500), x=slow(s + 5000, n=1500)),
            "v",
            "x",
            floor=1.0,
            permutations=39,
        )
        for s in range(runs)
    ]
    most = stats.binom.isf(0.001, runs, 0.05) + 5  # blocks forget only nearly all
    assert sum(one.of_mean.p <= 0.05 for one in found) <= most
    assert sum(one.of_power.p <= 0.05 for one in found) <= most


def test_bands_of_means_cover():
    inside = 0
    for seed in range(200):
        found = by_region(
            over_zero(white(seed), x=slow(seed + 900)),
            "v",
            "x",
            bins=[-1, 0, 1],
            permutations=0,
            floor=1.0,
        )
        inside += (np.abs(found.mean) < found.band).sum()
    assert abs(inside / 400 - 0.95) < 0.035


def test_power_alone_can_depend():
    x = slow(7)
    found = by_region(over_zero(white(8) * (1 + (x > 1)), x=x), "v", "x", floor=1.0, seed=3)
    assert found.of_power.p == 0.002 and found.of_mean.p > 0.01
    assert found.share[found.edges[0][1:] > 1].sum() > 0.8


def test_empty_bins_are_marked():
    x = np.where(np.arange(N) < 5, 9.5, white(9).clip(-2, 2))
    found = by_region(over_zero(white(10), x=x), "v", "x", bins=[-2, 0, 2.5, 5, 9, 10], floor=1.0)
    assert found.thin.tolist() == [False, False, True, True, True]
    assert np.isnan(found.mean[2]) and found.count[4] == 5


def test_same_seed_same_answer():
    x = slow(1)
    one, two = (by_region(over_zero(slow(2), x=x), "v", "x", floor=1.0, seed=5) for _ in range(2))
    assert one.of_mean == two.of_mean and one.block > 10


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"over": "y"}, "no signal 'y'"),
        ({"over": ("x", "x", "x")}, "one or two signals"),
        ({"bins": [1, 0]}, "must increase"),
        ({"bins": [100, 101]}, "no sample within"),
        ({"over": "still"}, "must change"),
        ({"values": [1.0]}, "1 values for 4000"),
    ],
)
def test_refused(change, match):
    with pytest.raises(MeasurementError, match=match):
        by_region(
            over_zero(white(0), x=slow(1), still=np.ones(N)),
            "v",
            **{"over": "x", "floor": 1.0, **change},
        )


def test_a_missing_force_shows_its_law():
    def push(t):
        return 6 * np.sin(1.3 * t) + 4 * np.sin(2.9 * t)

    t = np.linspace(0, 100, 20_001)
    speeds = [
        solve_ivp(
            lambda t, v, d=d: (push(t) - v - d * v * abs(v)) / 2,
            (0, 100),
            [0.0],
            t_eval=t,
            rtol=1e-8,
        ).y[0]
        for d in (0.1, 0.0)
    ]
    found = Residuals(
        t, {"v": speeds[0] + 0.005 * white(3, 20_001)}, {"v": speeds[1]}, inputs={"F": push(t)}
    )
    force = 2 * gap_rate(found, "v", 0.3) + found.gap("v")
    regions = by_region(found, "v", "v", values=force, bins=9)
    middle = (regions.edges[0][1:] + regions.edges[0][:-1]) / 2
    assert (~regions.thin).sum() >= 7
    slope, _ = np.polyfit((middle * abs(middle))[~regions.thin], regions.mean[~regions.thin], 1)
    assert (
        regions.of_mean.p == 0.002 and -0.1 < slope < -0.05
    )  # weighed down by the simulated speed
    assert regions.of_mean.ratio > by_region(found, "v", "F", values=force).of_mean.ratio


def test_planted_place_is_named():
    t = np.arange(8000) / 1000
    slip = 1 + 0.6 * np.sin(2 * np.pi * 3 * t)
    burst = np.where((t >= 3.2) & (t < 4.8) & (slip < 0.8), 0.3 * np.sin(400 * np.pi * t), 0)
    v, x = np.sin(30 * t), np.cos(30 * t)
    found = Residuals(
        t,
        {"V_c": v + 0.05 * white(1, 8000) + burst, "x_c": x + 0.02 * white(2, 8000)},
        {"V_c": v, "x_c": x},
        {"V_c": "m/s", "slip": "m/s"},
        {"slip": slip},
    )
    place = locate(found, floor={"V_c": 0.05, "x_c": 0.02})
    assert place.found and place.signal == "V_c"
    assert abs(place.window.low - 3.2) < 0.01 and abs(place.window.high - 4.8) < 0.01
    assert place.band.low < 200 < place.band.high < place.band.low + 80
    assert place.region.name == "slip" and place.region.low < 0.5 < place.region.high < 1.0
    assert abs(place.onset - 3.2) < 0.3 and place.share > 0.6
    assert "V_c between 3.2" in place.text and "at slip from" in place.text


def test_what_is_spread_is_said_to_be():
    place = locate(over_zero(1.5 * white(4), x=slow(2)), floor=1.0)
    assert place.found and (place.window, place.band, place.region) == (None, None, None)
    assert place.text.endswith("none stands out by time or frequency or operating region")


@pytest.mark.parametrize("floor", [1.0, None], ids=["known", "estimated"])
def test_noise_alone_names_nothing_at_the_rate_stated(floor):
    runs = 300
    found = [
        locate(over_zero(white(s, 1500), x=slow(s, n=1500)), floor=floor, alpha=0.05).found
        for s in range(runs)
    ]
    assert sum(found) <= stats.binom.isf(0.001, runs, 0.05)
    assert "no gap above the noise floor" in locate(over_zero(white(0)), floor=1.0).text


def test_uneven_records_are_located_in_time():
    y = white(5)
    y[3000:] += 2.0
    y[100:500] = np.nan
    place = locate(over_zero(y), floor=1.0)
    assert place.found and place.window.low == pytest.approx(2.8, abs=0.21) and place.band.low == 0
