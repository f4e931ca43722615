"""Operators against closed forms."""

import numpy
import pytest

from bondgraph.discrepancy.candidates import Signals, lagged, play, stop


@pytest.mark.parametrize("width", [0.2, 0.7])
def test_stop_encloses_the_area_of_an_elastic_slider(width):
    """One cycle of amplitude A dissipates 4 w (A - w) where the slider's level is its width."""
    t = numpy.linspace(0, 4 * numpy.pi, 40001)
    q = 1.5 * numpy.sin(t)
    held = stop(q, width)
    last = t >= 2 * numpy.pi
    area = float(numpy.trapezoid(held[last], q[last]))
    assert area == pytest.approx(4 * width * (1.5 - width), rel=1e-5)
    assert numpy.allclose(play(q, width) + held, q)


def test_lag_has_the_gain_and_phase_of_its_transfer_function():
    t = numpy.linspace(0, 30, 30001)
    response = lagged(t, numpy.sin(2 * t), 0.5)
    gain, phase = 1 / numpy.hypot(1, 1), numpy.arctan(1.0)
    late = t > 20
    assert numpy.allclose(response[late], gain * numpy.sin(2 * t[late] - phase), atol=1e-6)


def test_signals_follow_from_a_displacement_alone():
    t = numpy.linspace(0, 1, 1001)
    signals = Signals.of(t, displacement=numpy.sin(3 * t))
    assert numpy.allclose(signals.flow[1:-1], 3 * numpy.cos(3 * t[1:-1]), atol=1e-4)
    assert numpy.isnan(signals.effort).all()
