"""Run the races and print a table of each.

Exit status 1 means that a contestant could not start or that the framework missed its limit.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

from rich import box
from rich.console import Console
from rich.table import Table

from . import brake, growth


def brake_race(console: Console, rounds: int, everything: bool) -> bool:
    """The brake race, on the limit cycle or on all four behaviours of the paper."""
    rows = brake.race(brake.FIGURES if everything else ("fig8",), rounds=rounds)
    title = f"bicycle brake: {brake.T_END} s, rtol {brake.RTOL:g}, {brake.N_OUT} output times"
    caption = "median CPU time of a run; greatest error to 60 ms and to the end, of a state's range"
    table = Table(title=title, caption=caption, box=box.SIMPLE)
    for heading in ("", "contestant"):
        table.add_column(heading, no_wrap=True)
    for heading in ("CPU ms", "spread", "ratio", "sticks", "60 ms", "end"):
        table.add_column(heading, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(*_cells(row))
    console.print(table)
    for absent in dict.fromkeys(f"{r.name} did not start: {r.note}" for r in rows if not r.timing):
        console.print(absent, markup=False)
    return _verdict(console, rows)


def _verdict(console: Console, rows: list[brake.Row]) -> bool:
    """Whether all started and the framework kept its limit on the limit cycle."""
    ratios = [r.ratio for r in rows if r.name == brake.OURS and r.figure == "fig8" and r.timing]
    if ratios:
        kept = "within" if ratios[0] <= brake.LIMIT else "NOT within"
        console.print(f"{ratios[0]:.2f} times the C automaton: {kept} {brake.LIMIT:g}")
    return all(r.timing for r in rows) and all(ratio <= brake.LIMIT for ratio in ratios)


def _cells(row: brake.Row) -> list[str]:
    if row.timing is None:
        return [row.figure, row.name]
    median, low, high = row.timing
    return [
        row.figure,
        row.name,
        f"{1e3 * median:.3f}",
        f"{(high - low) / median:.0%}",
        f"{row.ratio:.2f}",
        f"{row.sticks} of {row.true_sticks}",
        *(f"{error:.0e}" for error in row.error),
    ]


def ladder_race(console: Console, rounds: int, everything: bool) -> bool:
    """The ladder race, up to 10000 storages; ``rounds`` processes for each of ours, 3 at most."""
    rows = growth.race(rounds=min(rounds, growth.ROUNDS))
    table = Table(
        title="derivation of ladders",
        caption="CPU s without imports, each in a fresh process; ratio to halfarrow",
        box=box.SIMPLE,
    )
    for heading in ("ladder", "storages", "package", "CPU s", "ratio"):
        table.add_column(heading, justify="left" if heading in "ladder package" else "right")
    for row in rows:
        if row.kind:
            told = [row.note, ""] if row.note else [f"{row.seconds:.3f}", f"{row.ratio:.1f}"]
            table.add_row(row.kind.upper(), str(row.storages), row.name, *told)
    console.print(table)
    for absent in (row for row in rows if not row.kind):
        console.print(f"{absent.name}: {absent.note}", markup=False)
    return all([_grows_well(console, *found) for found in growth.exponents(rows)])


def _grows_well(console: Console, kind: str, exponent: float, seconds: float) -> bool:
    """Whether the cost of a kind of ladder grows as slowly as the framework asks of itself."""
    kept = exponent <= growth.EXPONENT_LIMIT and seconds <= growth.SECONDS_LIMIT
    console.print(
        f"{kind.upper()}: exponent {exponent:.2f} from 1000 to 10000, {seconds:.2f} s at 10000: "
        f"{'within' if kept else 'NOT within'} {growth.EXPONENT_LIMIT:g} and {growth.SECONDS_LIMIT:g} s"
    )
    return kept


RACES: dict[str, Callable[[Console, int, bool], bool]] = {
    "brake": brake_race,
    "ladders": ladder_race,
}


def main() -> None:
    """Parse the command line and run the races."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description=__doc__)
    parser.add_argument("races", nargs="*", metavar="RACE", help=f"of: {', '.join(RACES)}")
    parser.add_argument("--all", action="store_true", help="every case of a race, not its main one")
    parser.add_argument("--rounds", type=int, default=9, help="rounds of interleaved timing")
    arguments = parser.parse_args()
    if unknown := set(arguments.races) - set(RACES):
        parser.error(f"unknown race {', '.join(sorted(unknown))}; there are {', '.join(RACES)}")
    if arguments.rounds < 2:
        parser.error("--rounds must be at least 2")
    console = Console()
    kept = [
        RACES[name](console, arguments.rounds, arguments.all) for name in arguments.races or RACES
    ]
    sys.exit(0 if all(kept) else 1)


if __name__ == "__main__":
    main()
