"""Ask about each case in a process of its own, within a time limit; answers are JSON lines."""

from __future__ import annotations

import importlib
import json
import multiprocessing
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

LIMIT = 120.0
"""Seconds that a case may take."""
ENGINE = f"{__package__}.solvers:engine"
ANSWERS = "answers.jsonl"
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass
class _Running:
    folder: Path
    process: multiprocessing.process.BaseProcess
    hears: Connection
    begun: float


def run(
    folders: Sequence[Path],
    path: Path,
    solver: str = ENGINE,
    jobs: int = 2,
    limit: float = LIMIT,
    progress: Callable[[str], object] = lambda line: None,
) -> None:
    """Append an answer for each folder to a file.

    Parameters
    ----------
    folders : of cases; their names are the ids
    path : of the answers
    solver : ``module:function``, from a folder to an answer
    jobs : processes at a time
    limit : seconds a case
    progress : told a line a case
    """
    for name in _THREADS:
        os.environ.setdefault(name, "1")
    # fresh processes, which still share the imports of one server
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["bondgraph.discrepancy", solver.partition(":")[0]])
    waiting, running, done = list(folders), [], 0
    while waiting or running:
        while waiting and len(running) < jobs:
            running.append(_started(context, waiting.pop(0), solver))
        time.sleep(0.02)
        for one in list(running):
            told = _heard(one, limit)
            if told is None:
                continue
            running.remove(one)
            done += 1
            row = {"id": one.folder.name, "wall": time.monotonic() - one.begun, **told}
            with path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
            progress(
                f"{done}/{len(folders)} {row['id']} {row['wall']:.1f} s "
                f"{row.get('error') or row.get('verdict')}"
            )


def _started(context: Any, folder: Path, solver: str) -> _Running:
    hears, tells = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(solver, str(folder), tells))
    process.start()
    tells.close()
    return _Running(folder, process, hears, time.monotonic())


def _heard(one: _Running, limit: float) -> dict[str, Any] | None:
    """Return an answer, an error, or None while there is neither."""
    told: dict[str, Any] | None = None
    if one.hears.poll():
        try:
            told = one.hears.recv()
        except EOFError:
            told = {"error": "the process died"}
    elif not one.process.is_alive():
        told = {"error": "the process died"}
    elif time.monotonic() - one.begun > limit:
        one.process.kill()
        told = {"error": f"over {limit:g} s"}
    if told is not None:
        one.process.join()
        one.hears.close()
    return told


def _work(solver: str, folder: str, tells: Connection) -> None:
    module, _, name = solver.partition(":")
    try:
        tells.send(getattr(importlib.import_module(module), name)(Path(folder)))
    except Exception as error:  # what a solver raises is its answer, not the race's end
        tells.send({"error": f"{type(error).__name__}: {error}"})
