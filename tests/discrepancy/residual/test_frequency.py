"""Spectra of gaps, coherence, and whiteness."""

import numpy as np
import pytest
from scipy import signal, stats

from bondgraph.discrepancy import Residuals, by_frequency, gap_rate, whiteness
from bondgraph.errors import MeasurementError

RATE = 1000.0
N = 8000
T = np.arange(N) / RATE


def white(seed, n=N):
    return np.random.default_rng(seed).normal(size=n)


def over_zero(y, t=T, **inputs):
    return Residuals(t, {"v": y}, {"v": np.zeros(len(y))}, inputs=inputs)


def test_densities_are_those_of_scipy():
    found = by_frequency(over_zero(white(0)), "v", floor=1.0, segment=0.5)
    frequency, density = signal.welch(white(0), RATE, nperseg=500, detrend=False)
    assert np.allclose(found.gap.frequency, frequency) and np.allclose(found.gap.density, density)
    assert found.floor_density == pytest.approx(2 / RATE) and found.gap.averages == 31


def test_noise_alone_has_no_band_at_the_rate_stated():
    runs = 300
    alarms = sum(
        bool(by_frequency(over_zero(white(s, 2000), T[:2000]), "v", floor=1.0, alpha=0.05).bands)
        for s in range(runs)
    )
    assert alarms <= stats.binom.isf(0.001, runs, 0.05)


def test_planted_band():
    low, high = 180.0, 220.0
    inner = signal.sosfilt(
        signal.butter(6, [low, high], "bandpass", fs=RATE, output="sos"), white(2)
    )
    band, *rest = by_frequency(over_zero(white(1) + inner), "v", floor=1.0, segment=0.25).bands
    assert abs(band.low - low) < 15 and abs(band.high - high) < 15 and low < band.peak < high
    assert band.share > 0.7 > sum(other.share for other in rest)


def test_a_bias_is_a_band_from_zero():
    (band,) = by_frequency(over_zero(white(3) + 0.5), "v", floor=1.0, segment=0.5).bands
    assert band.low == 0 and band.high < 8 and band.share > 0.5


def test_coherence_is_that_of_scipy_and_its_limit_holds():
    u, w = white(3), white(4)
    found = by_frequency(over_zero(white(5) + 0.7 * u, u=u, w=w), "v", floor=1.0, segment=0.5)
    linked = found.coherence
    for name, cause in (("u", u), ("w", w)):
        _, expected = signal.coherence(cause, white(5) + 0.7 * u, RATE, nperseg=500, noverlap=250)
        assert np.allclose(linked.ordinary[name][1:], expected[1:])
    inner = slice(2, -2)
    assert abs(linked.ordinary["u"][inner].mean() - 0.49 / 1.49) < 0.04
    assert (linked.ordinary["w"][inner] > linked.limit).mean() < 0.05
    assert (linked.partial["w"][inner] > linked.limit_partial).mean() < 0.05


def test_partial_coherence_sees_through_a_common_cause():
    u = white(6)
    w = u + 0.5 * white(7)  # follows u, and does nothing of its own
    linked = by_frequency(
        over_zero(u + 0.3 * white(8), u=u, w=w), "v", floor=0.3, segment=0.5
    ).coherence
    inner = slice(2, -2)
    assert linked.ordinary["w"][inner].mean() > 0.6
    assert linked.partial["w"][inner].mean() < 0.1 < 0.5 < linked.partial["u"][inner].mean()
    # as the formula for two causes, from scipy's cross spectra
    y = u + 0.3 * white(8)
    s = {
        (a, b): signal.csd(p, q, RATE, nperseg=500, noverlap=250)[1][inner]
        for a, p in (("y", y), ("u", u), ("w", w))
        for b, q in (("y", y), ("u", u), ("w", w))
    }
    yw = s["y", "w"] - s["y", "u"] * s["u", "w"] / s["u", "u"]
    yy = s["y", "y"] - abs(s["y", "u"]) ** 2 / s["u", "u"]
    ww = s["w", "w"] - abs(s["w", "u"]) ** 2 / s["u", "u"]
    assert np.allclose(linked.partial["w"][inner], abs(yw) ** 2 / (yy * ww).real, atol=1e-6)


def test_dependent_causes_have_no_partial_coherence():
    u = white(9)
    linked = by_frequency(over_zero(u, u=u, w=2 * u, still=np.ones(N)), "v", floor=0.1).coherence
    assert set(linked.ordinary) == {"u", "w"} and np.isnan(linked.partial["u"]).all()
    assert linked.ordinary["u"][5] == pytest.approx(1)


def test_short_holes_and_jitter_are_bridged_and_said():
    y = np.sin(2 * np.pi * 20 * T)
    holed = y.copy()
    holed[100:105] = holed[3000:3002] = np.nan
    found = by_frequency(over_zero(holed), "v", floor=1e-3)
    assert "bridged" in found.treatment and abs(found.bands[0].peak - 20) < 1
    uneven = T + np.random.default_rng(1).uniform(-0.3, 0.3, N) / RATE
    found = by_frequency(over_zero(np.sin(2 * np.pi * 20 * uneven), uneven), "v", floor=1e-3)
    assert "even steps" in found.treatment and abs(found.bands[0].peak - 20) < 1


@pytest.mark.parametrize(
    ("rows", "match"), [(slice(10, 40), "a hole of"), (slice(0, 900), "samples are missing")]
)
def test_long_holes_are_refused(rows, match):
    y = white(0)
    y[rows] = np.nan
    with pytest.raises(MeasurementError, match=match):
        by_frequency(over_zero(y), "v", floor=1.0)


def test_a_large_step_is_refused():
    t = np.append(T[:4000], T[4000:] + 1.0)
    with pytest.raises(MeasurementError, match=r"a step of 1\.001 s at t = 3\.999 s"):
        by_frequency(over_zero(white(0), t), "v", floor=1.0)


def test_rate_of_a_gap():
    found = over_zero(np.sin(3 * T))
    assert np.abs(gap_rate(found, "v", 0.05) - 3 * np.cos(3 * T)).max() < 2e-4
    assert np.abs(gap_rate(found, "v", 0.05, order=2) + 9 * np.sin(3 * T)).max() < 0.05
    with pytest.raises(MeasurementError, match="smooth"):
        gap_rate(found, "v", 0.002)


def test_whiteness_of_white_noise_at_the_rate_stated():
    runs = 300
    found = [whiteness(white(s, 600)) for s in range(runs)]
    most = stats.binom.isf(0.001, runs, 0.05)
    assert sum(one.p_ljung_box < 0.05 for one in found) <= most
    assert sum(one.p_kolmogorov < 0.05 for one in found) <= most
    assert np.mean([one.predictable for one in found]) < 0.02


def test_ljung_box_by_hand():
    y = white(11, 300)
    c = y - y.mean()
    rho = np.array(
        [np.corrcoef(c, c)[0, 0] * (c[k:] * c[:-k]).sum() / (c**2).sum() for k in (1, 2, 3)]
    )
    expected = 300 * 302 * (rho**2 / (299, 298, 297)).sum()
    found = whiteness(y, lags=3)
    assert found.ljung_box == pytest.approx(expected)
    assert found.p_ljung_box == pytest.approx(stats.chi2.sf(expected, 3))


@pytest.mark.parametrize("rho", [0.3, 0.9])
def test_predictable_share_is_that_of_a_first_order_series(rho):
    y = signal.lfilter([1], [1, -rho], white(12, 100_000))
    found = whiteness(y)
    assert abs(found.predictable - rho**2) < 0.02 and found.verdict.startswith("not white")
    assert abs(found.effective / 100_000 / ((1 - rho) / (1 + rho)) - 1) < 0.25


def test_a_long_record_is_rejected_for_next_to_nothing():
    y = white(13, 128_000)
    y[1:] += 0.03 * y[:-1]
    found = whiteness(y, floor=1.0)
    assert found.p_ljung_box < 1e-9 and found.predictable < 0.002 and abs(found.above) < 0.02


def test_whiteness_says_where():
    found = whiteness(white(14) + np.sin(2 * np.pi * 200 * T), T)
    assert "from 188 to 250 Hz" in found.where and found.p_kolmogorov < 1e-6
    for series in (np.ones(100), white(0, 10)):
        with pytest.raises(MeasurementError):
            whiteness(series)
