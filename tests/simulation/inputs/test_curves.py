"""Curves: band-limited samples and functions of time as cubics."""

from __future__ import annotations

import math

import numpy as np
import pytest

from bondgraph.errors import ParameterError, SimulationError
from bondgraph.simulation.inputs.curves import TAPS, band_limited, fitted, rate

TIMES = 0.01 * np.arange(300)
FINE = np.linspace(TIMES[0], TIMES[-1], 20_011)
INSIDE = (TIMES[TAPS] <= FINE) & (TIMES[-TAPS - 1] >= FINE)


class TestBand:
    @pytest.mark.parametrize("share", [0.01, 0.1, 0.3, 0.5, 0.7, 0.8])
    def test_sine_waves_up_to_eight_tenths_of_nyquist(self, share):
        omega = share * math.pi / 0.01
        curve = band_limited(TIMES, np.sin(omega * TIMES + 0.3))
        off = np.abs(curve.at(FINE)[0] - np.sin(omega * FINE + 0.3))
        assert off[INSIDE].max() < 2e-5
        slope = curve.at(FINE)[1] - omega * np.cos(omega * FINE + 0.3)
        assert np.abs(slope[INSIDE]).max() < 3e-4 * omega

    @pytest.mark.parametrize(("share", "off"), [(0.1, 0.0041), (0.5, 0.121), (0.8, 0.475)])
    def test_near_the_ends_it_is_as_bad_as_it_says(self, share, off):
        omega = share * math.pi / 0.01
        worst = max(
            np.abs(
                band_limited(TIMES, np.sin(omega * TIMES + phase)).at(FINE)[0]
                - np.sin(omega * FINE + phase)
            ).max()
            for phase in np.linspace(0, math.pi, 7)
        )
        assert 0.9 * off < worst < off

    def test_samples_are_met_and_nothing_jumps(self):
        values = np.random.default_rng(3).normal(size=300)
        curve = band_limited(TIMES, values)
        assert np.abs(curve.at(TIMES)[0] - values).max() < 1e-12
        before = curve.at(np.nextafter(curve.knots[1:-1], 0))
        after = curve.at(curve.knots[1:-1])
        assert np.abs(before[0] - after[0]).max() < 1e-9
        assert np.abs(before[1] - after[1]).max() < 1e-9 * np.abs(after[1]).max()

    def test_constants_and_lines_are_kept(self):
        assert np.abs(band_limited(TIMES, np.full(300, 7.0)).at(FINE)[0] - 7).max() < 1e-13
        line = band_limited(TIMES, 3 + 2 * TIMES).at(FINE)[0]
        assert np.abs(line - 3 - 2 * FINE).max() < 1e-5

    def test_slow_signals_take_few_pieces(self):
        assert len(band_limited(TIMES, np.sin(TIMES)).knots) == 300
        assert len(band_limited(TIMES, np.sin(250 * TIMES)).knots) == 299 * 16 + 1

    def test_outside_the_ends_hold(self):
        curve = band_limited(TIMES, np.cos(9 * TIMES))
        outside = curve.at(np.array([-1.0, 9.0]))
        assert outside[0] == pytest.approx([1.0, math.cos(9 * TIMES[-1])])
        assert not outside[1:].any()

    def test_one_and_two_samples(self):
        assert band_limited(np.array([2.0]), np.array([5.0])).at(np.array([9.0]))[0] == [5.0]
        two = band_limited(np.array([0.0, 1.0]), np.array([0.0, 4.0]))
        assert two.at(np.array([0.25]))[0] == pytest.approx([1.0], abs=1e-4)

    def test_times_that_are_not_uniform_are_refused_by_sample(self):
        times = TIMES.copy()
        times[200:] += 0.004
        with pytest.raises(ParameterError, match=r"sample 200 .*hold='linear'"):
            band_limited(times, np.sin(times))

    def test_rounded_times_are_uniform(self):
        band_limited(np.round(np.arange(100) / 30, 5), np.zeros(100))


class TestFitted:
    @pytest.mark.parametrize("tolerance", [1e-4, 1e-7, 1e-9])
    @pytest.mark.parametrize(
        "function",
        [
            lambda t: math.sin(30 * t),
            lambda t: math.exp(-(((t - 5) / 0.01) ** 2)),
            lambda t: max(0.0, math.sin(3 * t)),
            lambda t: t**3 - 4 * t,
            lambda t: 2.0,
            lambda t: 0.0,
        ],
        ids=["sine", "pulse", "half wave", "cubic", "constant", "nothing"],
    )
    def test_functions_are_met(self, function, tolerance):
        curve = fitted(function, (0.0, 10.0), tolerance, "u")
        times = np.random.default_rng(1).uniform(0, 10, 5000)
        exact = np.array([function(t) for t in times], dtype=float)
        assert np.abs(curve.at(times)[0] - exact).max() <= 3 * tolerance * np.abs(exact).max()

    def test_rates_are_met(self):
        curve = rate(fitted(lambda t: math.sin(30 * t), (0.0, 1.0), 1e-9, "u"))
        times = np.linspace(0, 1, 777)[:-1]
        assert np.abs(curve.at(times)[0] - 30 * np.cos(30 * times)).max() < 1e-4

    @pytest.mark.parametrize(
        ("function", "words"),
        [
            (lambda t: float(t > 1.234), r"'u'.*t = 1\.234 s"),
            (math.log, "failed at t = 0 s"),
            (lambda t: math.inf if t > 9 else 0.0, "is inf at t = "),
            (lambda t: "fast", "failed"),
        ],
        ids=["jump", "raises", "infinite", "word"],
    )
    def test_what_cannot_be_met_is_named(self, function, words):
        with pytest.raises(SimulationError, match=words):
            fitted(function, (0.0, 10.0), 1e-6, "u")
