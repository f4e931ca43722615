"""Plots of recordings beside models: envelopes keep what was there, curves are those of the values."""

from __future__ import annotations

import numpy as np
import pytest

from bondgraph import plot
from bondgraph.discrepancy import Residuals, by_frequency
from bondgraph.discrepancy.discovery import Course, Gap, LearnedLaw
from bondgraph.plot.envelope import BUCKETS, envelope
from bondgraph.report.svg import standalone

RNG = np.random.default_rng(3)


def course(count, sigma=0.1):
    t = np.linspace(0, 10, count)
    clean = np.sin(2 * np.pi * 3 * t)
    measured = clean + sigma * RNG.normal(size=count)
    return Course(
        "run", t, {"v": measured}, {"v": 0.5 * clean}, {"v": clean}, {"v": sigma}, {"v": "m/s"}
    )


@pytest.mark.parametrize("count", [1, 7, 3 * BUCKETS, 3 * BUCKETS + 1, 12345])
def test_an_envelope_loses_no_extreme(count):
    t, y = np.arange(count) / 100.0, RNG.normal(size=count)
    found = envelope(t, y)
    assert found.low.min() == y.min() and found.high.max() == y.max()
    assert (found.low <= found.high).all() and (np.diff(found.t) > 0).all()
    assert found.whole == (count <= 3 * BUCKETS) and len(found.t) <= max(count, BUCKETS)
    nearest = np.abs(found.t[:, None] - t[None, :]).argmin(axis=0) if count > 3 * BUCKETS else None
    if nearest is not None:  # each sample lies within the bucket it is nearest to, or beside
        low = np.minimum.reduce([np.roll(found.low, k) for k in (-1, 0, 1)])
        assert (y >= low[nearest]).all()


def test_gaps_stay_gaps():
    t, y = np.arange(10000.0), np.zeros(10000)
    y[2000:8000] = np.nan
    found = envelope(t, y)
    assert not found.whole
    gone = np.isnan(found.low)
    assert gone.sum() == pytest.approx(0.6 * BUCKETS, abs=2)
    assert found.t[gone].min() >= 2000 and found.t[gone].max() <= 8000


def test_a_hundred_thousand_samples_make_a_small_picture():
    ax = plot.course_plot(course(128000), "v")
    assert len(standalone(ax)) < 150_000


def test_curves_are_those_of_the_course():
    run = course(301)
    curves = {line.get_label(): line.get_ydata() for line in plot.course_plot(run, "v").lines}
    assert np.array_equal(curves["measured"], run.measured["v"])
    assert np.array_equal(curves["before"], run.before["v"])
    assert np.array_equal(curves["after"], run.after["v"])
    lines = plot.course_plot(run, "v", (2.0, 4.0), changed=False).lines
    assert [line.get_label() for line in lines] == ["measured", "before"]
    t = lines[0].get_xdata()
    assert t.min() >= 2.0 and t.max() <= 4.0 and len(t) == 60


@pytest.mark.parametrize("count", [300, 50_000])
def test_noise_fills_its_band_and_little_more(count):
    """Two deviations for samples, and for envelopes what so many samples reach."""
    run = course(count)
    ax = plot.gap_course(run, "v")
    (band,) = [patch for patch in ax.patches if patch.get_label() == "noise"]
    top = band.get_y() + band.get_height()
    after = next(line for line in ax.lines if line.get_label() == "after")
    beyond = np.mean(np.abs(after.get_ydata()) > top)
    assert beyond < 0.1 if count == 300 else 0.2 < beyond < 0.6
    assert top == pytest.approx(0.2) if count == 300 else 0.2 < top < 0.35


def test_no_noise_no_band():
    run = course(300)
    silent = Course(run.name, run.t, run.measured, run.before, run.after, {}, run.units)
    assert not plot.gap_course(silent, "v").patches


def test_spectra_keep_power_and_peak():
    t = np.arange(64000) / 1000
    hum = np.sin(2 * np.pi * 50 * t) + 0.1 * RNG.normal(size=len(t))
    found = by_frequency(Residuals(t, {"v": hum}, {"v": 0 * t}), "v", floor=0.1)
    ax = plot.gap_spectra(found, None)
    before = next(line for line in ax.lines if line.get_label() == "before")
    f, density = before.get_data()
    assert f[np.argmax(density)] == pytest.approx(50, rel=0.02)
    assert len(f) < 500
    # white noise of deviation 0.1 has the one-sided density 2 * 0.01 / 1000
    assert np.median(density[f > 100]) == pytest.approx(2e-5, rel=0.05)


def test_a_law_stands_over_no_more_dots_than_are_seen():
    x = np.linspace(-1, 1, 21)
    cloud = np.column_stack([np.linspace(-1, 1, 50_000)] * 2)
    cloud[3] = np.nan
    law = LearnedLaw("drag at v", "flow", "effort", ("m/s", "N"), x, x, 0 * x + np.inf, cloud)
    ax = plot.learned_law(law)
    dots = next(line for line in ax.lines if line.get_label() == "data alone")
    assert 300 < len(dots.get_xdata()) <= 700 and np.isfinite(dots.get_ydata()).all()
    assert len(standalone(ax)) < 120_000


def test_gaps_are_in_units_of_their_floors():
    gaps = {
        "v": Gap(1.2, 0.4, 0.11, 0.1, "m/s"),
        "x": Gap(np.nan, np.inf, 0.0, 0.0, "m"),
    }
    ax = plot.gap_shares(gaps)
    values = {line.get_label(): line.get_xdata() for line in ax.lines}
    assert values["as given"][0] == pytest.approx(12) and values["before"][0] == pytest.approx(4)
    assert values["after"][0] == pytest.approx(1.1) and np.isnan(values["after"][1])
    assert [tick.get_text() for tick in ax.get_yticklabels()] == ["v", "x"]
