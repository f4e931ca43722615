"""Spectra: power and frequency of known signals, and the brake's second harmonic."""

import numpy
import pytest

from bondgraph import models, simulate, spectrum
from bondgraph.errors import SimulationError

from .graphs import van_der_pol

T = numpy.arange(20_000) / 1000
WAVE = 3 * numpy.sin(2 * numpy.pi * 50.3 * T) + 0.2 * numpy.sin(2 * numpy.pi * 120 * T)


@pytest.mark.parametrize("window", ["hann", "boxcar", "blackman", "flattop"])
def test_the_integral_is_the_variance(window):
    rng = numpy.random.default_rng(1)
    noise = rng.normal(size=len(T))
    found = spectrum((T, WAVE + noise), window=window, segment=1.0)
    power = found.density.sum() * found.line_spacing
    assert power == pytest.approx((WAVE + noise).var(), rel=0.02)
    # white noise: variance over half the rate
    quiet = (found.frequency > 200) & (found.frequency < 490)
    assert found.density[quiet].mean() == pytest.approx(1 / 500, rel=0.05)


def test_peaks_have_the_frequency_and_amplitude_of_sines():
    first, second = spectrum((T, WAVE), segment=4.0).peaks()
    assert first.frequency_hz == pytest.approx(50.3, rel=1e-4)
    assert first.amplitude == pytest.approx(3, rel=0.01)  # between two lines
    assert (second.frequency_hz, second.amplitude) == pytest.approx((120, 0.2), rel=1e-3)


def test_what_it_can_tell_apart_is_said():
    found = spectrum((T, WAVE), "wave", segment=2.0, overlap=0.75)
    assert found.line_spacing == pytest.approx(0.5) and found.resolution == pytest.approx(0.75)
    assert found.averages == 1 + (20_000 - 2000) // 500 and found.overlap == 0.75
    assert (found.rate, found.segment) == pytest.approx((1000, 2.0))
    assert found.unit == "(1)^2/Hz" and found.window == "hann"


def test_detrend():
    ramp = 5 + 0.3 * T
    kept = spectrum((T, WAVE + ramp), detrend=False, window="boxcar", segment=2.0)
    level = spectrum((T, WAVE + ramp), detrend="constant", window="boxcar", segment=2.0)
    straight = spectrum((T, WAVE + ramp), detrend="linear", window="boxcar", segment=2.0)
    assert kept.density[0] > 10 > 1e-6 > level.density[0]
    assert straight.density[1] < 0.1 * level.density[1]


def test_the_brakes_peak_is_the_second_harmonic():
    """Stick times say 143.318344 Hz; the largest line of the spectrum stands at twice that."""
    run = simulate(models.bicycle_brake.graph(), 1.0, {"mu_s": 0.5, "tau": 0.02}, rtol=1e-9)
    assert (numpy.diff(run.t) != numpy.diff(run.t)[0]).any()  # rows of the integrator's own
    found = spectrum(run, "V_c", start=0.2, rate=20_000, segment=0.4)
    highest = found.peaks()[0]
    assert highest.frequency_hz == pytest.approx(286.636688, abs=0.2)
    assert found.unit == "(m/s)^2/Hz"
    fundamental = min(found.peaks(), key=lambda peak: abs(peak.frequency_hz - 143.318344))
    assert fundamental.frequency_hz == pytest.approx(143.318344, abs=0.2)
    assert fundamental.density < 0.1 * highest.density


def test_a_run_with_even_rows_is_taken_as_it_is():
    grid = numpy.linspace(0, 200, 4001)
    run = simulate(van_der_pol(), 200, initial={"c.q": 2}, t_eval=grid, rtol=1e-8)
    found = spectrum(run, "c.q", segment=100)
    assert found.rate == pytest.approx(20)
    assert found.peaks()[0].frequency_hz == pytest.approx(1 / 6.66328686, rel=1e-2)


@pytest.mark.parametrize(
    ("source", "given", "words"),
    [
        ((numpy.sqrt(T), WAVE), {}, "'lever' is not evenly spaced"),
        ((T[:100], WAVE[:99]), {}, "100 times and 99 values"),
        ((T[:5], WAVE[:5]), {}, "5 samples"),
        ((T, numpy.where(T == 5, numpy.nan, WAVE)), {}, "not finite"),
        ((T, WAVE), {"segment": 100.0}, "segment of 100 s"),
        ((T, WAVE), {"overlap": 1.0}, "overlap is 1"),
        ((T, WAVE), {"window": "hanning-ish"}, "window 'hanning-ish' is not known"),
        ((T, WAVE), {"detrend": "cubic"}, "detrend is 'cubic'"),
        (3, {}, r"needs a Trajectory, or \(times, values\)"),
    ],
)
def test_refusals_say_what_and_where(source, given, words):
    with pytest.raises(SimulationError, match=words):
        spectrum(source, "lever", **given)


def test_one_gap_is_found():
    t = numpy.delete(T, 700)
    with pytest.raises(SimulationError, match=r"0\.002 s after t = 0\.699 s, elsewhere 0\.001 s"):
        spectrum((t, numpy.delete(WAVE, 700)), "lever")
