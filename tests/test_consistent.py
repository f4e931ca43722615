"""Consistent values against roots known beforehand."""

import numpy as np
import pytest
from scipy.special import lambertw

from bondgraph.consistent import consistent, newton


def system(function, slope, terms=None):
    """A residual of one variable."""

    def residual(z):
        left = np.array([function(z[0])])
        return left, np.array([[slope(z[0])]]), np.array([terms or np.abs(left[0]) + 1])

    return residual


def diode(e):
    """100 ohm to a source of e volts, and a diode of 1e-12 A and 25 mV: left over at z volts."""
    return system(
        lambda z: (e - z) / 100 - 1e-12 * np.expm1(z / 0.025),
        lambda z: -1 / 100 - 1e-12 / 0.025 * np.exp(z / 0.025),
    )


@pytest.mark.parametrize("source", [0.1, 5.0, 100.0])
@pytest.mark.parametrize("guess", [0.0, -50.0, 20.0])
def test_a_diode_behind_a_resistor(source, guess):
    """By Lambert's function: z = E + R Is - Vt W(R Is / Vt exp((E + R Is) / Vt))."""
    if source > 10:  # the exponent overflows; its logarithm fixes z as well
        exact = 0.025 * np.log((source - 0.7) / 1e-10)
        for _ in range(50):
            exact = 0.025 * np.log((source - exact) / 1e-10 + 1)
    else:
        shifted = source + 1e-10
        exact = shifted - 0.025 * lambertw(1e-10 / 0.025 * np.exp(shifted / 0.025)).real
    (found,) = consistent(diode(source), np.array([guess]))
    assert found == pytest.approx(exact, rel=1e-11)


def test_the_guess_chooses_among_roots():
    cubic = system(lambda z: z**3 - z, lambda z: 3 * z**2 - 1)
    for root in (-1.0, 0.0, 1.0):
        assert consistent(cubic, np.array([root + 0.1]))[0] == pytest.approx(root, abs=1e-13)


def test_a_minimum_above_zero_is_no_root():
    above = system(lambda z: z**2 + 1e-3, lambda z: 2 * z)
    assert consistent(above, np.array([1.0])) is None


def test_where_newton_starts_on_a_horizontal_tangent():
    flat = system(lambda z: np.arctan(z**3) - 0.5, lambda z: 3 * z**2 / (1 + z**6))
    assert newton(flat, np.zeros(1)) is None
    assert consistent(flat, np.zeros(1))[0] ** 3 == pytest.approx(np.tan(0.5), rel=1e-12)


def test_coupled_rows_of_very_different_sizes():
    """1e9 (x - 1) + y^3 = 0 and 1e-9 (y - 2) - 1e-9 (x - 1) = 0."""

    def residual(z):
        x, y = z
        left = np.array([1e9 * (x - 1) + y**3, 1e-9 * (y - x - 1)])
        return left, np.array([[1e9, 3 * y**2], [-1e-9, 1e-9]]), np.array([1e9, 1e-9])

    x, y = consistent(residual, np.zeros(2))
    assert y - x == pytest.approx(1, rel=1e-12)
    assert 1e9 * (1 - x) == pytest.approx(y**3, rel=1e-6)


def test_nothing_to_solve():
    assert consistent(lambda z: (z, np.zeros((0, 0)), z), np.zeros(0)).shape == (0,)
