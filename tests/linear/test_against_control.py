"""Poles, zeros, gains and responses against python-control, which shares no code with them."""

import control
import numpy
import pytest

from .graphs import SYSTEMS, close


@pytest.fixture(params=SYSTEMS)
def system(request):
    return SYSTEMS[request.param]()


def same_set(found, expected, rel=1e-8, least=0.1):
    """Whether two lists of roots are the same, in any order; double ones are off by more than rounding."""
    left = list(expected)
    assert len(found) == len(left)
    for root in found:
        nearest = min(left, key=lambda other: abs(other - root))
        assert abs(nearest - root) <= rel * max(abs(root), least)
        left.remove(nearest)


def test_poles(system):
    same_set(system.poles(), system.to_control().poles())


def test_zeros_of_channels(system):
    other = system.to_control()
    for row, output in enumerate(system.outputs):
        for column, source in enumerate(system.sources):
            part = control.ss(
                other.A, other.B[:, [column]], other.C[[row]], other.D[[row]][:, [column]]
            )
            if abs(control.evalfr(part, 1.7 + 0.3j)) < 1e-12:
                continue  # its pencil is singular: python-control returns what rounding leaves
            expected = part.zeros()
            fastest = max(1.0, abs(system.poles()).max())
            finite = expected[abs(expected) < 1e4 * fastest]
            same_set(system.zeros(output, source), finite, 1e-6, 0.01 * fastest)


def test_zeros_of_a_square_system():
    system = SYSTEMS["pulled"]()
    same_set(system.zeros(), system.to_control().zeros())


def test_dcgain(system):
    expected = numpy.atleast_2d(system.to_control().dcgain())
    if numpy.isfinite(expected).all():
        assert close(system.dcgain(), expected.reshape(system.D.shape), 1e-8)
    else:  # python-control gives up on all channels where A is singular
        assert not abs(numpy.linalg.det(system.A)) > 1e-12


def test_step(system):
    found = system.step_response()
    _, expected = control.step_response(system.to_control(), found.time, squeeze=False)
    sizes = abs(expected).max(axis=2, keepdims=True) + 1e-12 * abs(expected).max()
    assert (abs(found.values - expected) <= 1e-9 * sizes).all()


def test_impulse(system):
    found = system.impulse_response()
    with pytest.warns() if system.D.any() else _silence():
        _, expected = control.impulse_response(system.to_control(), found.time, squeeze=False)
    sizes = abs(expected).max(axis=2, keepdims=True) + 1e-12 * abs(expected).max()
    assert (abs(found.values - expected) <= 1e-9 * sizes).all()
    assert (found.direct == system.D).all()


def test_frequency_response(system):
    found = system.frequency_response()
    expected = control.frequency_response(system.to_control(), found.omega, squeeze=False)
    sizes = abs(expected.complex) + 1e-12 * abs(expected.complex).max()
    assert (abs(found.values - expected.complex) <= 1e-8 * sizes).all()


def test_transfer_functions(system):
    other = system.to_control()
    points = numpy.array([0.3 + 0.2j, 5j, 400.0 + 1200j])
    for row, output in enumerate(system.outputs):
        for column, source in enumerate(system.sources):
            found = system.transfer_function(output, source)
            expected = numpy.array([numpy.atleast_2d(other(s))[row, column] for s in points])
            size = abs(expected) + 1e-12 * abs(system.D).max()
            assert (abs(found(points) - expected) <= 1e-7 * size + 1e-18).all()
            above = numpy.polyval(found.numerator, points)
            assert found(points) == pytest.approx(
                above / numpy.polyval(found.denominator, points), rel=1e-9, abs=0
            )


class _silence:
    def __enter__(self):
        return self

    def __exit__(self, *_):
        return False
