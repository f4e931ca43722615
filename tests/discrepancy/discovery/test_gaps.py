"""Gaps: root mean squares written out, and shares of what lies above the noise."""

import math
from types import SimpleNamespace

import numpy
import pytest

from bondgraph.discrepancy.discovery import Gap
from bondgraph.discrepancy.discovery import gaps as measured
from bondgraph.discrepancy.discovery.prepare import floor


@pytest.mark.parametrize(
    ("before", "after", "floor", "share"),
    [
        (5.0, 3.0, 3.0, 1.0),  # down to the noise
        (5.0, 5.0, 3.0, 0.0),
        (5.0, math.sqrt(9 + 4), 3.0, 0.5),  # what lies above: 4, then 2
        (5.0, 2.0, 3.0, 1.0),  # below the noise is no more than all
        (5.0, 7.0, 0.0, -0.4),
    ],
)
def test_the_share_removed_is_of_what_lies_above_the_noise(before, after, floor, share):
    gap = Gap(9.0, before, after, floor)
    assert gap.removed == pytest.approx(share)
    assert measured.removed({"x": gap}, {"x": 2.0}) == pytest.approx(share)


def test_where_nothing_lies_above_nothing_can_be_removed():
    assert math.isnan(Gap(1.0, 1.0, 1.0, 1.0).removed)
    assert measured.removed({"x": Gap(1.0, 1.0, 1.0, 1.0)}, {}) == 0.0


def test_a_run_that_fails_removes_less_than_nothing_and_one_before_it_all():
    assert measured.removed({"x": Gap(1.0, 1.0, math.nan, 0.1)}, {}) == -math.inf
    assert measured.removed({"x": Gap(1.0, math.nan, 0.1, 0.1)}, {}) == 1.0


def test_signals_count_by_their_size():
    """Above the noise: 3 to 0 of one of size 1, 400 to 400 of one of size 100."""
    found = {"x": Gap(9, 3.0, 0.0, 0.0), "p": Gap(9, 400.0, 400.0, 0.0)}
    assert measured.removed(found, {"x": 1.0, "p": 100.0}) == pytest.approx(
        1 - math.sqrt(16 / (9 + 16))
    )


def _recording(**columns):
    arrays = {name: numpy.array(values) for name, values in columns.items()}
    plain = SimpleNamespace(t=numpy.arange(3.0), columns=arrays)
    return SimpleNamespace(plain=plain, signals=tuple(arrays), noise=dict.fromkeys(arrays, 0.5))


def test_the_root_mean_square_is_over_all_samples_that_are_there():
    rows = [_recording(x=[1.0, math.nan, 3.0]), _recording(x=[0.0, 0.0, 2.0])]
    runs = ({"x": numpy.array([0.0, 9.0, 1.0])}, {"x": numpy.array([0.0, 3.0, 2.0])})
    assert measured.rmse(rows, runs, "x") == pytest.approx(math.sqrt((1 + 4 + 9) / 5))
    assert math.isnan(measured.rmse(rows, ({"x": numpy.full(3, math.nan)}, runs[1]), "x"))


def test_a_signal_of_one_recording_only_counts_there():
    rows = [_recording(x=[1.0, 1.0, 1.0]), _recording(v=[0.0, 3.0, 0.0])]
    runs = ({"x": numpy.zeros(3)}, {"v": numpy.zeros(3)})
    found = measured.gaps(rows, runs, runs, runs, {"v": "m/s"}, {"x": 0.5, "v": 0.5})
    assert found["x"].after == pytest.approx(1.0)
    assert found["v"].before == pytest.approx(math.sqrt(3)) and found["v"].unit == "m/s"


def test_no_gap_lies_below_its_floor():
    rows = [_recording(x=[1.0, 1.0, 1.0])]
    runs = ({"x": numpy.array([1.1, 0.9, 1.1])},)
    found = measured.gaps(rows, runs, runs, runs, {}, {"x": 5.0})["x"]
    assert found.noise_floor <= min(found.before, found.after)


def test_the_floor_is_the_root_mean_square_over_recordings():
    rows = [_recording(x=[0.0] * 3), _recording(x=[0.0] * 3)]
    rows[1].noise["x"] = 1.5
    assert floor(rows, "x") == pytest.approx(math.sqrt((0.25 + 2.25) / 2))


def test_what_noise_alone_may_leave_counts_as_gone():
    """A mean square of n values of noise scatters by noise^2 sqrt(2 / n)."""
    gap = {"x": Gap(9.0, 1.5, 1.03, 1.0)}
    plain = measured.removed(gap, {"x": 1.0})
    assert plain == pytest.approx(1 - math.sqrt((1.03**2 - 1) / (1.5**2 - 1)))
    assert measured.removed(gap, {"x": 1.0}, {"x": 500}) == 1.0
    assert plain < measured.removed(gap, {"x": 1.0}, {"x": 50_000}) < 1.0


def test_a_gap_that_noise_alone_may_be_is_not_called_gone():
    gap = {"x": Gap(9.0, 1.03, 1.02, 1.0)}
    assert measured.removed(gap, {"x": 1.0}, {"x": 100}) == measured.removed(gap, {"x": 1.0})
