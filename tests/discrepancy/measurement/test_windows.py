"""Parts of a recording."""

import pytest

from bondgraph.discrepancy import Measurement
from bondgraph.errors import MeasurementError

NAN = float("nan")
RUN = Measurement(
    [2, 3, 4, 5],
    {"x": [5, 6, 7, 8], "y": [1, 2, NAN, NAN]},
    {"x": "m", "y": "N"},
    {"y": "zero"},
    {"m.p": 1.0},
    name="run",
)


def test_windows_keep_times_and_know_where_initial_states_hold():
    late = RUN.between(3, 4)
    assert late.t.tolist() == [3, 4] and late.columns["x"].tolist() == [6, 7]
    assert late.start == 3 and dict(late.initial) == {} and dict(late.holds) == {"y": "zero"}
    assert dict(RUN.between(0, 3).initial) == {"m.p": 1.0}


def test_split_shares_no_row_and_loses_none():
    first, second = RUN.without("y").split(0.4)
    assert [*first.t, *second.t] == [2, 3, 4, 5]
    assert dict(first.initial) == {"m.p": 1.0} and dict(second.initial) == {}


def test_without_forgets_units_and_holds_too():
    rest = RUN.without("y")
    assert list(rest.columns) == ["x"] and dict(rest.units) == {"x": "m"} and not rest.holds


@pytest.mark.parametrize(
    ("part", "words"),
    [
        (lambda: RUN.between(4, 4), "window 4 s to 4 s is empty"),
        (lambda: RUN.between(9, 10), "9 to 10 s holds 0 rows"),
        (lambda: RUN.between(4, 5), "column 'y': no value in 4 to 5 s"),
        (lambda: RUN.split(1.0), "fraction between 0 and 1"),
        (lambda: RUN.split(0.9), "the last 0.1 holds 1 row;"),
        (lambda: RUN.without("x", "y"), "no column would be left"),
        (lambda: RUN.without("z"), "no column 'z'; it has x, y"),
    ],
)
def test_what_cannot_be_cut(part, words):
    with pytest.raises(MeasurementError, match=words):
        part()
