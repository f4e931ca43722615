"""The race of `bondgraph.discover` on sealed cases.

Makes cases, asks about each in a process of its own, opens the seal, prints tables and puts them into
docs/discovery_benchmark.md.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from rich.console import Console

from ..report import write as put
from . import files, score
from .make import made
from .peers import race
from .plans import Plan, subset
from .runner import ANSWERS, ENGINE, run

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "discovery_benchmark.md"
FOLDER = ROOT / "build" / "bench" / "discovery"


def main(arguments: Sequence[str] | None = None) -> None:
    """Parse the command line and run the race."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.benchmarks discovery", description=__doc__
    )
    parser.add_argument("--fraction", type=float, default=1.0, help="share of each kind of case")
    parser.add_argument("--only", default="", metavar="NAME", help="an id, machine, effect or kind")
    parser.add_argument("--jobs", type=int, default=2, help="cases at a time")
    parser.add_argument("--dry", action="store_true", help=f"leave {PAGE.name} as it is")
    parser.add_argument("--keep", type=Path, default=FOLDER, metavar="DIR", help="cases, answers")
    parser.add_argument("--fresh", action="store_true", help="forget answers given before")
    parser.add_argument("--peers", action="store_true", help="PySINDy on the same cases as well")
    parser.add_argument("--solver", default=ENGINE, help="who answers, as module:function")
    given = parser.parse_args(arguments)
    if not 0 < given.fraction <= 1:
        parser.error("--fraction must be above 0 and at most 1")
    chosen = subset(given.fraction, given.only)
    if not chosen:
        parser.error(f"there is no case of {given.only!r}")
    console = Console(width=160)
    rows = raced(chosen, given.keep, given.solver, given.jobs, console, fresh=given.fresh)
    reports = score.reports(rows)
    if given.peers:
        tell = partial(console.print, markup=False)
        reports.append(race.report(rows, given.keep, given.jobs, tell))
    for report in reports:
        report.show(console)
        if not given.dry and given.fraction == 1 and not given.only:
            put(report, PAGE)
    sys.exit(0)


def raced(
    chosen: Sequence[Plan],
    folder: Path,
    solver: str,
    jobs: int,
    console: Console,
    *,
    fresh: bool = False,
) -> list[score.Judged]:
    """Make what is not there yet, ask what has no answer yet, and judge.

    Parameters
    ----------
    chosen : cases
    folder : where cases, seal and answers are kept
    solver : ``module:function``
    jobs : cases at a time
    console : for a line a case
    fresh : whether answers given before are forgotten
    """
    told = folder / (ANSWERS if solver == ENGINE else f"{solver.rpartition(':')[2]}.jsonl")
    if fresh:
        told.unlink(missing_ok=True)
    sealed = {row["id"] for row in files.unsealed(folder)} if _has_seal(folder) else set()
    new = [plan for plan in chosen if plan.id not in sealed]
    console.print(f"{len(chosen)} cases, {len(new)} to be made, in {folder}", markup=False)
    if new:
        with get_context("forkserver").Pool(min(jobs, len(new))) as pool:
            files.write(pool.imap(made, new), folder)
    known = {row["id"] for row in files.answers(told)}
    left = [folder / "cases" / plan.id for plan in chosen if plan.id not in known]
    run(left, told, solver, jobs, progress=lambda line: console.print(line, markup=False))
    ids = {plan.id for plan in chosen}
    return [row for row in score.results(folder, told) if row.truth["id"] in ids]


def _has_seal(folder: Path) -> bool:
    return (folder / files.SEALED).exists()


if __name__ == "__main__":
    main()
