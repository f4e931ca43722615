"""``python -m tests.benchmarks [--all] [--rounds N] [RACE ...]``: run races, print their tables."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from rich.console import Console
from rich.table import Table

from . import brake


def brake_table(rounds: int, everything: bool) -> Table:
    """The brake race, on the limit cycle or on all four behaviours of the paper."""
    title = f"bicycle brake, {brake.T_END} s, rtol {brake.RTOL:g}, {brake.N_OUT} times of output"
    table = Table(title=title, caption="CPU time, median [quartiles]; error over a state's range")
    for heading in ("", "contestant"):
        table.add_column(heading)
    for heading in ("ms a run", "ratio", "sticks", "error, 60 ms", "error, all"):
        table.add_column(heading, justify="right")
    for row in brake.race(brake.FIGURES if everything else ("fig8",), rounds=rounds):
        table.add_row(*_cells(row))
    return table


def _cells(row: brake.Row) -> list[str]:
    if row.timing is None:
        return [row.figure, row.name, "-", "-", "-", "-", row.note]
    median, low, high = (1e3 * x for x in row.timing)
    return [
        row.figure,
        row.name,
        f"{median:.3f} [{low:.3f}, {high:.3f}]",
        f"{row.ratio:.2f}",
        f"{row.sticks} of {row.true_sticks}",
        *(f"{error:.1e}" for error in row.error),
    ]


RACES: dict[str, Callable[[int, bool], Table]] = {"brake": brake_table}


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
    for name in arguments.races or RACES:
        console.print(RACES[name](arguments.rounds, arguments.all))


if __name__ == "__main__":
    main()
