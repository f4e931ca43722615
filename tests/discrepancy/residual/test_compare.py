"""Spectra before and during an event."""

import numpy as np
import pytest
from scipy import signal, stats

from bondgraph.discrepancy import Measurement, compare_windows
from bondgraph.errors import MeasurementError

T = np.arange(8000) / 2000
BEFORE, DURING = (0, 1.9995), (2.0, 3.9995)
LATE = T >= 2


def recording(seed, *tones):
    y = np.random.default_rng(seed).normal(size=len(T))
    for hertz, before, during in tones:
        y += np.where(LATE, during, before) * np.sin(2 * np.pi * hertz * T)
    return Measurement(T, {"a": y}, name="run 3")


def compared(seed, *tones, **options):
    return compare_windows(recording(seed, *tones), "a", BEFORE, DURING, **options)


def test_each_kind_of_change_is_told():
    found = compared(1, (100, 0, 1), (250.3, 0.8, 3), (400, 1, 1), (600, 1, 0), (800, 3, 0.8))
    kinds = {peak.kind: round(peak.frequency_hz) for peak in found.peaks}
    assert kinds == {"appears": 100, "grows": 250, "stays": 400, "vanishes": 600, "shrinks": 800}
    (grown,) = found.of("grows")
    assert abs(grown.frequency_hz - 250.3) < 0.3 and 5 < grown.ratio < 25 and grown.p < 1e-4
    assert found.before.resolution * 0.8 < grown.width_hz < found.before.resolution * 2


def test_a_peak_can_drown():
    run = recording(2, (500, 0.5, 0.5))
    loud = run.columns["a"] + np.where(LATE, 10, 0) * np.random.default_rng(5).normal(size=len(T))
    found = compare_windows(Measurement(T, {"a": loud}), "a", BEFORE, DURING)
    assert [peak.kind for peak in found.peaks] == ["drowned"]
    assert 70 < found.rise < 140 and found.risen > 0.9


def test_a_wide_peak_has_its_width():
    b, a = signal.iirpeak(300, 10, fs=2000)  # 30 Hz between the points of half the power
    y = np.random.default_rng(4).normal(size=len(T))
    y[LATE] += 10 * signal.lfilter(b, a, np.random.default_rng(6).normal(size=len(T)))[LATE]
    found = compare_windows(Measurement(T, {"a": y}), "a", BEFORE, DURING, segment=0.1)
    top = max(found.of("appears"), key=lambda peak: peak.during)
    assert abs(top.frequency_hz - 300) < 15 and 15 < top.width_hz < 60


def test_noise_alone_has_no_peak_at_the_rate_stated():
    runs = 300
    found = [compared(seed, alpha=0.05) for seed in range(runs)]
    most = stats.binom.isf(0.001, runs, 0.05)
    assert sum(bool(one.peaks) for one in found) <= most
    assert sum(one.risen > 0 for one in found) <= most


def test_spectra_are_those_of_scipy():
    found = compared(3, segment=0.25)
    for part, rows in ((found.before, ~LATE), (found.during, LATE)):
        density = signal.welch(recording(3).columns["a"][rows], 2000, nperseg=500)[1]
        assert np.allclose(part.density, density)
    assert found.freedom[0] == pytest.approx(2 * 15 / (1 + 2 * 14 / 15 / 36), rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        (("b", BEFORE, DURING), "no column 'b'; there is a"),
        (("a", (1, 0), DURING), "window from 1 to 0 s"),
        (("a", BEFORE, (2, 9)), "the recording has 0 to 3.9995 s"),
        (("a", (0.1, 0.1002), DURING), "1 samples in the window"),
    ],
)
def test_refused(arguments, match):
    with pytest.raises(MeasurementError, match=match):
        compare_windows(recording(0), *arguments)
