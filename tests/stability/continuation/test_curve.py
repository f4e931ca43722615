"""Curves against circles, lines and curves that cross themselves."""

import numpy as np
import pytest

from bondgraph.stability.continuation.curve import (
    CLOSED,
    LIMIT,
    LOST,
    MANY,
    Frame,
    between,
    follow,
)


def free(_):
    return None


def ellipse(y):
    return np.array([y[0] ** 2 + (y[1] / 1e6) ** 2 - 1]), np.array([[2 * y[0], 2e-12 * y[1]]])


def cubic(y):
    """x^3 - x = p: two folds."""
    return np.array([y[0] ** 3 - y[0] - y[1]]), np.array([[3 * y[0] ** 2 - 1, -1.0]])


def test_an_ellipse_closes_whatever_its_units():
    frame = Frame(ellipse, np.array([1.0, 1e6]))
    found = follow(frame, np.array([1.0, 0.0]), np.array([0.0, 1.0]), free)
    assert found.end == CLOSED
    angles = np.unwrap(np.arctan2(found.points[:, 1] / 1e6, found.points[:, 0]))
    assert np.all(np.diff(angles) > 0) and angles[-1] >= 2 * np.pi
    assert np.abs(ellipse(found.points.T)[0]).max() < 1e-12


def test_folds_are_passed_and_borders_met_exactly():
    frame = Frame(cubic, np.ones(2))
    start = np.array([-2.0, -6.0])
    found = follow(frame, start, np.array([0.0, 1.0]), free, borders={1: (-6.0, 6.0)})
    assert found.end == LIMIT and found.points[-1] == pytest.approx([2.0, 6.0], abs=1e-12)
    assert (np.diff(np.sign(np.diff(found.points[:, 1]))) != 0).sum() == 2
    assert np.abs(found.points[:, 0] ** 3 - found.points[:, 0] - found.points[:, 1]).max() < 1e-9


def test_a_start_on_the_border_goes_nowhere():
    frame = Frame(cubic, np.ones(2))
    start = np.array([2.0, 6.0])
    found = follow(frame, start, np.array([0.0, 1.0]), free, borders={1: (-6.0, 6.0)})
    assert found.end == LIMIT and found.points.tolist() == [[2.0, 6.0]]


def test_what_is_not_allowed_ends_it_there():
    frame = Frame(cubic, np.ones(2))

    def within(y):
        return "too far" if y[0] > -1.5 else None

    found = follow(frame, np.array([-2.0, -6.0]), np.array([0.0, 1.0]), within)
    assert found.end == "too far" and found.points[-1][0] == pytest.approx(-1.5, abs=1e-6)
    few = follow(frame, np.array([-2.0, -6.0]), np.array([0.0, 1.0]), free, most=7)
    assert few.end == MANY and len(few.points) == 7


def test_a_curve_that_ends_is_lost():
    def root(y):  # y1 = sqrt(y0), which stops at zero
        with np.errstate(invalid="ignore", divide="ignore"):
            left = np.array([y[1] - np.sqrt(y[0])])
            return left, np.array([[-0.5 / np.sqrt(y[0]), 1.0]])

    found = follow(Frame(root, np.ones(2)), np.array([1.0, 1.0]), np.array([-1.0, 0.0]), free)
    assert found.end == LOST and 0 < found.points[-1][0] < 1e-3


def test_straight_on_where_curves_cross():
    def cross(y):  # x (x^2 - p): a pitchfork at zero
        return np.array([y[0] * (y[0] ** 2 - y[1])]), np.array([[3 * y[0] ** 2 - y[1], -y[0]]])

    start = np.array([0.0, -1.0])
    frame = Frame(cross, np.ones(2))
    found = follow(frame, start, np.array([0.0, 1.0]), free, borders={1: (-1, 1)})
    assert found.end == LIMIT and np.abs(found.points[:, 0]).max() == 0


def test_between_two_points():
    frame = Frame(ellipse, np.array([1.0, 1e6]))
    low, high = np.array([1.0, 0.0]), np.array([np.cos(0.1), 1e6 * np.sin(0.1)])
    y = between(frame, low, high, 0.5)
    assert y == pytest.approx([np.cos(0.05), 1e6 * np.sin(0.05)], rel=1e-9)
    assert between(frame, low, low, 0.5) is low
