"""Reports of races: limits, and their places in the page."""

import pytest

from . import __main__ as runner
from .report import PAGE, Limit, Report, write


@pytest.mark.parametrize(
    ("value", "limit", "least", "kept"),
    [
        (2.9, 3, False, True),
        (3.1, 3, False, False),
        (0.5, 0.4, True, True),
        (0.3, 0.4, True, False),
    ],
)
def test_limits(value, limit, least, kept):
    found = Limit("a over b", value, limit, least)
    assert found.kept is kept
    assert ("NOT KEPT" in str(found)) is not kept
    assert Report("r", ("a",), [["1"]], [found]).kept is kept


def test_who_does_not_start_is_not_kept():
    assert not Report("r", ("a",), [], notes=["C did not start"]).kept


def test_a_nan_keeps_nothing():
    assert not Limit("a over b", float("nan"), 3).kept
    assert not Limit("a over b", float("nan"), 3, True).kept


def test_writing_replaces_the_place_and_nothing_else(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- r -->\nold\n<!-- end of r -->\nafter\n")
    report = Report("r", ("who", "s"), [["a", "1"], ["b", "2"]], [Limit("b over a", 2, 3)])
    write(report, page)
    write(report, page)
    assert page.read_text() == (
        "before\n<!-- r -->\n| who | s |\n| --- | ---: |\n| a | 1 |\n| b | 2 |\n\n"
        "- b over a: 2 (at most 3: kept)\n<!-- end of r -->\nafter\n"
    )
    with pytest.raises(ValueError, match="no place for 'other'"):
        write(Report("other", (), []), page)


@pytest.mark.parametrize("name", runner.RACES)
def test_every_race_has_its_place_in_the_page(name):
    text = PAGE.read_text(encoding="utf-8")
    assert text.count(f"<!-- {name} -->") == text.count(f"<!-- end of {name} -->") == 1
