"""The C baseline of eigenvalues is honest only if its answers are right."""

import numpy as np
import pytest

from . import eigenvalues
from .native import BaselineUnavailable


@pytest.fixture(autouse=True)
def _compiled():
    try:
        eigenvalues.by_hand(np.ones((1, 1, 1)))
    except BaselineUnavailable as reason:
        pytest.skip(str(reason))


def error(a):
    """Greatest distance of each true eigenvalue to the nearest found, of the matrix's size."""
    found, true = eigenvalues.by_hand(a), np.linalg.eigvals(a)
    apart = np.abs(found[:, :, None] - true[:, None, :])
    worst = np.maximum(apart.min(axis=1), apart.min(axis=2)).max(axis=1)
    return (worst / np.abs(true).max(axis=1)).max()


@pytest.mark.parametrize("n", range(1, 13))
def test_random_matrices(n):
    rng = np.random.default_rng(n)
    assert error(rng.normal(size=(500, n, n))) < 1e-11
    assert error(rng.normal(size=(500, n, n)) * np.exp(3 * rng.normal(size=(500, n, n)))) < 1e-11


def test_the_brake():
    assert error(eigenvalues.matrices(eigenvalues.points(2000))) < 1e-12


def test_the_brake_s_published_modes():
    a = eigenvalues.matrices({"V0": np.array([0.9, 1.0]), "v_s": np.array([0.2, 0.2])})
    found = eigenvalues.by_hand(a)
    for row, wheel in zip(found, (48.396984 + 1264.600102j, 3.938867 + 1259.894363j), strict=True):
        assert np.abs(row - wheel).min() < 2e-6
