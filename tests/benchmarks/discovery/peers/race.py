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

SOLVERS = {
    "pysindy": f"{__package__}.sindy:solve",
    "pysindy, smoothed": f"{__package__}.smoothed:solve",
}
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
    theirs = {}
    for name, solver in SOLVERS.items():
        told = folder / f"{name.replace(', ', '_')}.jsonl"
        known = {answer["id"] for answer in files.answers(told)}
        left = [folder / "cases" / row.truth["id"] for row in apt if row.truth["id"] not in known]
        run(left, told, solver, jobs, progress=progress)
        theirs[name] = {answer["id"]: answer for answer in files.answers(told)}
    return counted(apt, theirs)


def counted(
    rows: Sequence[Judged], theirs: Mapping[str, Mapping[str, Mapping[str, Any]]]
) -> Report:
    """Return right names by noise: an effect at its site here, a term in its equation there."""
    groups: dict[str, list[tuple[bool, ...]]] = {}
    for row in sorted(rows, key=lambda row: row.truth["noise"]):
        others = [hit(row.truth, told.get(row.truth["id"], {})) for told in theirs.values()]
        for name in (f"{row.truth['noise']:.1%}", "all"):
            groups.setdefault(name, []).append((row.named and row.placed, *others))
    cells, ahead = [], float("nan")
    for name, group in sorted(groups.items(), key=lambda item: item[0] == "all"):
        ours, *others = (sum(each) for each in zip(*group, strict=True))
        cells.append([name, str(len(group)), str(ours), *map(str, others)])
        if name == "all":
            ahead = (ours - max(others)) / len(group)
    limit = Limit("share named right, less pysindy's better one", ahead, AHEAD, least=True)
    return Report("pysindy", ("noise", "cases", "discover", *theirs), cells, [limit])


def hit(truth: Mapping[str, Any], answer: Mapping[str, Any]) -> bool:
    """Whether the strongest term beyond the nominal model's is the hidden law's, in its equation."""
    terms = [(effect["site"], effect["name"]) for effect in answer.get("effects", ())]
    return bool(terms) and terms[0] in expected(truth)
