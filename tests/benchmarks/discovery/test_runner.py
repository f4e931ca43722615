"""The runner with solvers that know nothing: processes, limits, what is kept."""

import pytest
from rich.console import Console

from . import files
from .__main__ import PAGE, main, raced
from .plans import subset
from .runner import run

FAKE = f"{__package__}.fake:"


@pytest.fixture
def folders(tmp_path):
    found = [tmp_path / "cases" / name for name in ("a", "b")]
    for folder in found:
        folder.mkdir(parents=True)
        (folder / "case.json").write_text('{"model": "rlc"}')
    return found


@pytest.mark.parametrize(
    ("solver", "limit", "error"),
    [("broken", 60, "ValueError: cannot read"), ("dies", 60, "died"), ("sleeps", 1, "over 1 s")],
)
def test_what_goes_wrong_is_an_answer(folders, tmp_path, solver, limit, error):
    told, lines = tmp_path / "answers.jsonl", []
    run(folders, told, FAKE + solver, 2, limit, lines.append)
    rows = files.answers(told)
    assert sorted(row["id"] for row in rows) == ["a", "b"]
    assert all(error in row["error"] for row in rows) and len(lines) == 2


def test_a_race_resumes(tmp_path):
    quiet = Console(quiet=True)
    chosen = [plan for plan in subset(1.0, "nothing") if plan.machine in ("rlc", "rc")][:3]
    first = raced(chosen[:2], tmp_path, FAKE + "silent", 2, quiet)
    assert [row.verdict for row in first] == ["none", "none"]
    assert first[0].answer["seen"] == ["case.json", "train.csv", "validate.csv"]
    (told,) = tmp_path.glob("*.jsonl")
    before = told.read_text()
    rows = raced(chosen, tmp_path, FAKE + "silent", 2, quiet)
    assert told.read_text().startswith(before) and len(told.read_text().splitlines()) == 3
    assert not any(row.false for row in rows) and len(rows) == 3


def test_the_command_prints_and_leaves_the_page(tmp_path, capsys):
    page = PAGE.read_text(encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        main(
            [
                "--only",
                subset(1.0, "low")[0].id,
                "--keep",
                str(tmp_path),
                "--solver",
                FAKE + "silent",
            ]
        )
    assert ended.value.code == 0 and PAGE.read_text(encoding="utf-8") == page
    assert "false names, effect not excited" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["--only", "no such thing"])


@pytest.mark.parametrize("name", ["asked", "verdicts", "machine", "effect", "pysindy", "failures"])
def test_every_table_has_its_place_in_the_page(name):
    text = PAGE.read_text(encoding="utf-8")
    assert text.count(f"<!-- {name} -->") == text.count(f"<!-- end of {name} -->") == 1
