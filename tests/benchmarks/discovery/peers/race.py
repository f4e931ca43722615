"""PySINDy beside `discover`, on the cases that its method applies to."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ...report import Limit, Report
from .. import files
from ..judge import Judged
from ..runner import run
from .setups import expected

SOLVER = f"{__package__}.sindy:solve"
ANSWERS = "pysindy.jsonl"
AHEAD = 0.2  # of the cases


def report(
    rows: Sequence[Judged], folder: Path, jobs: int, progress: Callable[[str], object]
) -> Report:
    """Run PySINDy on the judged cases that it applies to, and count beside `discover`.

    Parameters
    ----------
    rows : what `discover` said
    folder : of cases and answers
    jobs : processes at a time
    progress : told a line a case
    """
    if find_spec("pysindy") is None:
        return Report(
            "pysindy",
            ("noise",),
            [],
            notes=["pysindy is not installed: pip install halfarrow[bench]"],
        )
    apt = [row for row in rows if expected(row.truth)]
    told = folder / ANSWERS
    known = {answer["id"] for answer in files.answers(told)}
    left = [folder / "cases" / row.truth["id"] for row in apt if row.truth["id"] not in known]
    run(left, told, SOLVER, jobs, progress=progress)
    return counted(apt, {answer["id"]: answer for answer in files.answers(told)})


def counted(rows: Sequence[Judged], theirs: Mapping[str, Mapping[str, Any]]) -> Report:
    """Return right names by noise: an effect at its site here, a term in its equation there."""
    groups: dict[str, list[tuple[bool, bool]]] = {}
    for row in sorted(rows, key=lambda row: row.truth["noise"]):
        both = (row.named and row.placed, hit(row.truth, theirs.get(row.truth["id"], {})))
        for name in (f"{row.truth['noise']:.1%}", "all"):
            groups.setdefault(name, []).append(both)
    cells, share = [], (float("nan"), float("nan"))
    for name, group in sorted(groups.items(), key=lambda item: item[0] == "all"):
        ours, others = (sum(each) for each in zip(*group, strict=True))
        cells.append([name, str(len(group)), str(ours), str(others)])
        if name == "all":
            share = ours / len(group), others / len(group)
    limit = Limit("share named right, less pysindy's", share[0] - share[1], AHEAD, least=True)
    return Report("pysindy", ("noise", "cases", "discover", "pysindy"), cells, [limit])


def hit(truth: Mapping[str, Any], answer: Mapping[str, Any]) -> bool:
    """Whether the strongest term beyond the nominal model's is the hidden law's, in its equation."""
    terms = [(effect["site"], effect["name"]) for effect in answer.get("effects", ())]
    return bool(terms) and terms[0] in expected(truth)
