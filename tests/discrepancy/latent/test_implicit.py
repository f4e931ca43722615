"""Algebraic variables at many points, against closed forms."""

import numpy
import pytest

from bondgraph.discrepancy.latent.implicit import solved

LEVELS = numpy.array([-30.0, -1e-6, 0.0, 2.0, 1e6])


def _pipe(points, z):
    """Linear and quadratic resistance in series with an effort: r f + d f |f| = e."""
    level = LEVELS[points, None]
    left = 2 * z + 3 * z * abs(z) - level
    return left, (2 + 6 * abs(z))[:, :, None], abs(2 * z) + abs(3 * z * z) + abs(level)


def test_a_pipe_of_two_resistances_has_the_roots_of_a_quadratic():
    magnitude = (-2 + numpy.sqrt(4 + 12 * abs(LEVELS))) / 6
    found = solved(_pipe, len(LEVELS), 1)[:, 0]
    assert found == pytest.approx(numpy.sign(LEVELS) * magnitude, rel=1e-9, abs=1e-15)


def test_two_variables_that_need_each_other():
    """A circle and a line: x^2 + y^2 = r^2, y = x; the point found is one of the two."""
    radius = numpy.array([1.0, 5.0, 0.1])

    def both(points, z):
        x, y = z.T
        left = numpy.column_stack([x**2 + y**2 - radius[points] ** 2, y - x])
        slope = numpy.stack(
            [numpy.column_stack([2 * x, 2 * y]), numpy.column_stack([0 * x - 1, 0 * y + 1])], axis=1
        )
        return left, slope, numpy.column_stack([x**2 + y**2 + radius[points] ** 2, abs(x) + abs(y)])

    found = solved(both, 3, 2)
    assert abs(found) == pytest.approx(numpy.outer(radius, [0.5**0.5] * 2), rel=1e-9)


def test_where_nothing_fits_there_is_no_number_and_the_others_are_found():
    target = numpy.array([4.0, -1.0, 9.0])

    def square(points, z):
        left = z**2 - target[points, None]
        return left, (2 * z)[:, :, None], z**2 + abs(target[points, None])

    found = solved(square, 3, 1)[:, 0]
    assert numpy.isnan(found[1])
    assert abs(found[[0, 2]]) == pytest.approx([2.0, 3.0])
