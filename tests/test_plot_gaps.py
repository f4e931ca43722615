"""Plots of gaps draw what the values hold."""

import numpy as np
import pytest

from bondgraph import plot
from bondgraph.discrepancy import (
    Measurement,
    Residuals,
    by_frequency,
    by_region,
    by_signal,
    by_window,
    compare_windows,
    whiteness,
)
from bondgraph.errors import BondGraphError

T = np.arange(4000) / 1000
RNG = np.random.default_rng(0)
U, W = RNG.normal(size=(2, 4000))
NOISE = RNG.normal(size=4000)
LATE = (T >= 2) * np.sin(400 * np.pi * T)
FOUND = Residuals(
    T,
    {"v": NOISE + 2 * LATE + U, "x": W},
    {"v": 0 * T, "x": W},
    {"v": "m/s", "u": "N"},
    {"u": U, "w": W},
)


def test_every_plot_can_be_saved(tmp_path):
    spectra = by_frequency(FOUND, "v", floor=1.0)
    run = Measurement(T, {"v": FOUND.measured["v"]})
    axes = [
        plot.signal_gaps(by_signal(FOUND, 1.0)),
        plot.window_gaps(by_window(FOUND, "v", floor=1.5)),
        plot.frequency_gaps(spectra),
        plot.coherence_plot(spectra),
        plot.region_gaps(by_region(FOUND, "v", "u", floor=1.0, permutations=9)),
        plot.region_gaps(by_region(FOUND, "v", ("u", "w"), floor=1.0, permutations=9)),
        plot.whiteness_plot(whiteness(NOISE, T)),
        plot.window_comparison(compare_windows(run, "v", (0, 1.999), (2, 3.999))),
    ]
    for number, ax in enumerate(axes):
        assert ax.get_xlabel() and (ax.get_ylabel() or number == 0)
        assert plot.save(ax, tmp_path / f"{number}.svg").stat().st_size > 1000


def test_windows_above_the_floor_are_told_from_the_others():
    gaps = by_window(FOUND, "v", 4, floor=1.5)
    ax = plot.window_gaps(gaps)
    assert gaps.significant.tolist() == [False, False, True, True]
    hatched = sorted(bar.get_x() for bar in ax.patches if bar.get_hatch())
    filled = sorted(bar.get_x() for bar in ax.patches if not bar.get_hatch())
    assert np.allclose(hatched, [0, 0.99975]) and np.allclose(filled, [1.9995, 2.99925])


def test_bands_and_appearing_peaks_are_marked():
    ax = plot.frequency_gaps(by_frequency(FOUND, "v", floor=np.sqrt(2)))
    spans = [
        patch for patch in ax.patches if patch.get_x() < 200 < patch.get_x() + patch.get_width()
    ]
    assert len(spans) == 1
    run = Measurement(T, {"v": FOUND.measured["v"]})
    ax = plot.window_comparison(compare_windows(run, "v", (0, 1.999), (2, 3.999)))
    (mark,) = [curve for curve in ax.lines if curve.get_label() == "appears"]
    assert abs(mark.get_xdata() - 200).max() < 1


def test_no_cause_no_coherence():
    with pytest.raises(BondGraphError, match="no cause was tried for v"):
        plot.coherence_plot(by_frequency(FOUND, "v", (), floor=1.0))
