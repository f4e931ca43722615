"""Invariant zeros: closed forms, singular and oblong pencils, invariance under units."""

import numpy
import pytest

from bondgraph.linear.realisation import Realisation
from bondgraph.linear.zeros import invariant_zeros

from .graphs import SYSTEMS, floating, following, ladder


def plant(a, b, c, d=None):
    a, b, c = (numpy.array(part, dtype=float) for part in (a, b, c))
    direct = numpy.zeros((len(c), b.shape[1])) if d is None else numpy.array(d, dtype=float)
    return Realisation(a, b, c, (direct,))


def companion(numerator, roots):
    """A chain with a given numerator and given poles."""
    below = numpy.poly(roots)
    n = len(roots)
    a = numpy.vstack([numpy.eye(n)[1:], -below[:0:-1]])
    c = numpy.zeros((1, n))
    c[0, : len(numerator)] = numerator[::-1]
    return plant(a, numpy.eye(n)[:, [-1]], c)


def test_of_a_known_numerator():
    found = invariant_zeros(companion([3, 18, 24], [-1, -5, -0.5, -7]))
    assert found == pytest.approx([-2, -4], rel=1e-10)


def test_without_zeros():
    assert invariant_zeros(companion([3], [-1, -5, -0.5])).size == 0


def test_zeros_at_the_origin_are_there():
    assert invariant_zeros(companion([2, 0], [-1, -3])).tolist() == [0]
    assert invariant_zeros(companion([2, 6, 0, 0], [-1, -3, -5, -0.1])) == pytest.approx([0, 0, -3])
    assert SYSTEMS["driven"]().zeros("a", "F").tolist() == [0, 0]


def test_hidden_modes_of_a_singular_pencil():
    """Two equal outputs, two equal inputs: det is zero for every s, yet a rank is lost at -7 and 3."""
    a = numpy.diag([-1.0, -7.0, 3.0])
    b = [[1, 1], [0, 0], [1, 1]]  # nothing moves the mode at -7
    c = [[1, 1, 0], [1, 1, 0]]  # nothing shows the mode at 3
    assert invariant_zeros(plant(a, b, c)) == pytest.approx([3, -7], rel=1e-12)


def test_a_transfer_that_is_zero():
    """What is moved is not shown, and the reverse: the pencil has rank two for every s."""
    a = numpy.diag([-1.0, -2.0])
    assert invariant_zeros(plant(a, [[1], [0]], [[0, 1]])).size == 0
    assert invariant_zeros(plant(a, [[1], [0]], [[0, 0]])).tolist() == [-2]


def test_oblong_systems():
    """One input, two outputs with numerators (s + 2)(s + 4) and (s + 2): only -2 is in both."""
    one = companion([1, 6, 8], [-1, -5, -9])
    both = Realisation(one.A, one.B, numpy.vstack([one.C, [[2, 1, 0]]]), (numpy.zeros((2, 1)),))
    assert invariant_zeros(both) == pytest.approx([-2], rel=1e-10)
    turned = Realisation(both.A.T, both.C.T, both.B.T, (both.direct[0].T,))
    assert invariant_zeros(turned) == pytest.approx([-2], rel=1e-10)


def test_units_and_a_change_of_states_do_not_matter():
    random = numpy.random.default_rng(3)
    for _ in range(40):
        n, m = random.integers(2, 7), random.integers(1, 4)
        a, b, c = (random.normal(size=shape) for shape in ((n, n), (n, m), (m, n)))
        d = random.normal(size=(m, m)) * random.integers(0, 2)
        plain = invariant_zeros(plant(a, b, c, d))
        units, out, into = (10 ** random.uniform(-6, 6, size) for size in (n, m, m))
        scaled = plant(
            1e4 * a * units / units[:, None],
            1e4 * b * into / units[:, None],
            c * units * out[:, None],
            d * into * out[:, None],
        )
        found = invariant_zeros(scaled) / 1e4
        assert len(found) == len(plain)
        for zero in found:
            assert min(abs(plain - zero)) < 1e-5 * abs(zero)
            pencil = numpy.block([[a - zero * numpy.eye(n), b], [c, d]])
            sizes = numpy.linalg.svd(pencil, compute_uv=False)
            assert sizes[-1] < 1e-8 * sizes[0]


@pytest.mark.parametrize("cells", [3, 12, 60])
def test_a_long_ladder_has_none(cells):
    """Each step of the reduction would let rounding grow tenfold, were the chain not kept as it is."""
    assert ladder(cells).zeros().size == 0


def test_of_graphs():
    assert SYSTEMS["unseen"]().zeros() == pytest.approx([0, -5])
    suspension = SYSTEMS["quarter_car"]().zeros("suspension", "v_road")
    assert suspension.tolist() == [0]
    assert floating().zeros("v", "F").tolist() == [0]


def test_where_an_output_follows_the_rate_of_an_input():
    """The force on a shaken mass and spring is (2 s + 3 / s) v; the tank beside it hides a mode."""
    found = following().zeros("force", "V")
    expected = [1j * numpy.sqrt(1.5), -1j * numpy.sqrt(1.5), -0.5]
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)
