"""Run the races, print a table of each and put it into docs/benchmarks.md.

Exit status 1 means that a contestant could not start or that the framework missed a limit.
``discovery`` is a race by itself, with arguments of its own: ``discovery --help``.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

from rich.console import Console

from . import brake, eigenvalues, growth, sensitivities, sweeps
from .report import Report, write

RACES: dict[str, Callable[[int, bool], Report]] = {
    "brake": brake.report,
    "sweep": sweeps.report,
    "sensitivities": sensitivities.report,
    "eigenvalues": eigenvalues.report,
    "ladders": growth.report,
}


def main() -> None:
    """Parse the command line and run the races."""
    if sys.argv[1:2] == ["discovery"]:  # hours, not minutes, and with arguments of its own
        from .discovery.__main__ import main as discovery

        discovery(sys.argv[2:])
        return
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description=__doc__)
    parser.add_argument("races", nargs="*", metavar="RACE", help=f"of: {', '.join(RACES)}")
    parser.add_argument("--all", action="store_true", help="every case of a race, not its main one")
    parser.add_argument("--rounds", type=int, default=9, help="rounds of interleaved timing")
    parser.add_argument("--dry", action="store_true", help="leave docs/benchmarks.md as it is")
    arguments = parser.parse_args()
    if unknown := set(arguments.races) - set(RACES):
        parser.error(f"unknown race {', '.join(sorted(unknown))}; there are {', '.join(RACES)}")
    if arguments.rounds < 2:
        parser.error("--rounds must be at least 2")
    console = Console(width=140)
    kept = True
    for name in arguments.races or RACES:
        report = RACES[name](arguments.rounds, arguments.all)
        report.show(console)
        if not arguments.dry and not arguments.all:
            write(report)
        kept = kept and report.kept
    sys.exit(0 if kept else 1)


if __name__ == "__main__":
    main()
