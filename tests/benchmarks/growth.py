"""The ladder race: how the cost of derivation grows, beside other bond-graph packages.

RC and RLC ladders of 10 to 10000 storages, each derived in a process of its own. halfarrow goes
all the way to a CasADi right-hand side and its sparse Jacobian; the peers only derive their state
equations, which favours them. A peer that runs over the time limit is not run at larger sizes.

Peers live in virtual environments of their own under build/bench, made on first use by pip.
"""

from __future__ import annotations

import functools
import json
import math
import resource
import signal
import statistics
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from .report import Limit, Report

ROOT = Path(__file__).parents[2]
SIZES = (10, 100, 1000, 10000)
KINDS = ("rc", "rlc")
ROUNDS = 3
TIME_LIMIT = 60
"""CPU seconds that a case may take, with its imports."""
EXPONENT_LIMIT = 1.15
"""Greatest growth exponent from 1000 to 10000 storages that the framework allows itself."""
SECONDS_LIMIT = 6.0
"""Greatest CPU time of 10000 storages that the framework allows itself, s."""
OURS = "halfarrow"


class Unavailable(RuntimeError):
    """A peer cannot be installed, or does not derive a ladder."""


class OverLimit(RuntimeError):
    """A case took longer than the limit."""


@dataclass(frozen=True)
class Peer:
    """Another package: what pip calls it, and the script that derives a ladder with it."""

    name: str
    requirement: str
    script: str

    def command(self) -> list[str]:
        """Make the peer's environment if needed; return how its script is run.

        Raises
        ------
        Unavailable
            if pip cannot install the package
        """
        home = ROOT / "build" / "bench" / self.requirement.replace("==", "-")
        python, done = home / "bin" / "python", home / "installed"
        if not done.exists():
            _run([sys.executable, "-m", "venv", "--clear", str(home)])
            _run([str(python), "-m", "pip", "--quiet", "install", self.requirement])
            done.touch()
        return [str(python), "-I", str(Path(__file__).parent / "peers" / self.script)]


PEERS = (
    Peer("BondGraphTools 0.4.6", "BondGraphTools==0.4.6", "bondgraphtools.py"),
    Peer("bondgraph 0.2.0", "bondgraph==0.2.0", "bondgraph_0_2_0.py"),
)


@dataclass(frozen=True)
class Row:
    """One ladder derived by one package.

    Attributes
    ----------
    kind, storages, name : which ladder, its size, and whose derivation
    seconds : median CPU time, NaN where there is none, as `note` says
    ratio : CPU time over halfarrow's
    """

    kind: str
    storages: int
    name: str
    seconds: float = math.nan
    ratio: float = math.nan
    note: str = ""


def report(rounds: int, everything: bool) -> Report:
    """Race up to 10000 storages; ``rounds`` processes for each of ours, 3 at most."""
    rows = race(rounds=min(rounds, ROUNDS))
    names = list(dict.fromkeys(row.name for row in rows if row.kind))
    headings = ["ladder", "storages", f"{OURS}, CPU s"]
    for name in names[1:]:
        headings += [f"{name}, CPU s", "ratio"]
    lines = []
    for kind, storages in dict.fromkeys((row.kind, row.storages) for row in rows if row.kind):
        line = [kind.upper(), str(storages)]
        for row in rows:
            if (row.kind, row.storages) == (kind, storages):
                ratio = "" if row.note else f"{row.ratio:.1f}"
                told = [row.note or f"{row.seconds:.3f}", ratio]
                line += told[:1] if row.name == OURS else told
        lines.append(line)
    limits = []
    for kind, exponent, seconds in exponents(rows):
        limits.append(
            Limit(f"{kind.upper()}, exponent from 1000 to 10000", exponent, EXPONENT_LIMIT)
        )
        limits.append(Limit(f"{kind.upper()}, CPU s at 10000", seconds, SECONDS_LIMIT))
    absent = [f"{row.name}: {row.note}" for row in rows if not row.kind]
    return Report("ladders", headings, lines, limits, absent)


def race(
    sizes: Sequence[int] = SIZES, peers: Sequence[Peer] = PEERS, rounds: int = ROUNDS
) -> list[Row]:
    """Derive all ladders with all packages."""
    commands: dict[Peer, list[str]] = {}
    absent: dict[Peer, str] = {}
    for peer in peers:
        try:
            commands[peer] = peer.command()
        except Unavailable as reason:
            absent[peer] = str(reason)
    rows: list[Row] = []
    for kind in KINDS:
        for storages in sizes:
            mine = measured(
                [sys.executable, "-m", f"{__package__}.ladders"], kind, storages, rounds
            )
            rows.append(Row(kind, storages, OURS, mine, 1.0))
            for peer in list(commands):
                rows.append(_against(peer, commands[peer], kind, storages, mine, rows))
    return rows + [Row("", 0, peer.name, note=f"not run: {why}") for peer, why in absent.items()]


def _against(
    peer: Peer, command: list[str], kind: str, storages: int, mine: float, before: list[Row]
) -> Row:
    beaten = any(r.kind == kind and r.name == peer.name and r.note for r in before)
    if beaten:
        return Row(kind, storages, peer.name, note="not run: over limit")
    try:
        seconds = measured(command, kind, storages, 1)
    except OverLimit:
        return Row(kind, storages, peer.name, note=f"over {TIME_LIMIT} s")
    except Unavailable as reason:
        return Row(kind, storages, peer.name, note=f"failed: {reason}")
    return Row(kind, storages, peer.name, seconds, seconds / mine)


def measured(command: Sequence[str], kind: str, storages: int, rounds: int) -> float:
    """Median CPU seconds of deriving one ladder, each time in a fresh process.

    Raises
    ------
    Unavailable
        if the process fails or derives another number of states
    OverLimit
        if it takes too long
    """
    case = [*command, kind, str(storages)]
    answers = [json.loads(_run(case, TIME_LIMIT)) for _ in range(rounds)]
    if any(answer["states"] != storages for answer in answers):
        raise Unavailable(f"{answers[0]['states']} states of {storages}")
    return statistics.median(float(answer["seconds"]) for answer in answers)


def _run(command: list[str], limit: int | None = None) -> str:
    """Run a command for so many CPU seconds at most; return the last line it prints."""
    bounds = None if limit is None else (limit, limit + 1)
    bound = bounds and functools.partial(resource.setrlimit, resource.RLIMIT_CPU, bounds)
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, cwd=ROOT, preexec_fn=bound
        )
    except OSError as reason:
        raise Unavailable(str(reason)) from None
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        raise OverLimit(f"{limit} s")
    if done.returncode:
        told = done.stderr.strip().splitlines() or [f"exit status {done.returncode}"]
        raise Unavailable(told[-1])
    return (done.stdout.strip().splitlines() or [""])[-1]


def exponents(rows: Sequence[Row]) -> Iterator[tuple[str, float, float]]:
    """Give, for each kind of ladder, our growth exponent over the last decade and its last time."""
    for kind in KINDS:
        seconds = {r.storages: r.seconds for r in rows if r.kind == kind and r.name == OURS}
        if {1000, 10000} <= seconds.keys():
            yield kind, math.log10(seconds[10000] / seconds[1000]), seconds[10000]
