"""Runs begin at once, and are compiled as soon as the compiler is done; the bits are the same."""

from __future__ import annotations

import logging
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from bondgraph import CompiledModel, simulate
from bondgraph.models import mass_on_belt
from bondgraph.simulation import hybrid, table
from bondgraph.simulation.native import compiler

pytestmark = pytest.mark.skipif(not compiler.find_compiler(), reason="no compiler")
GRID = np.linspace(0, 40, 401)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("HALFARROW_CACHE", str(tmp_path / "own"))
    return tmp_path / "own"


@pytest.fixture
def model():
    return CompiledModel(mass_on_belt.graph())


@pytest.fixture
def slow(tmp_path, monkeypatch):
    """A compiler that works once a file is there."""
    real, gate, fake = compiler.find_compiler(), tmp_path / "open", tmp_path / "slowcc"
    fake.write_text(
        f"#!/bin/sh\nn=0; while [ ! -e {gate} ] && [ $n -lt 600 ]\n"
        f'do sleep 0.02; n=$((n+1)); done\nexec {real} "$@"\n'
    )
    fake.chmod(0o755)
    monkeypatch.setenv("CC", str(fake))
    yield gate
    gate.touch()


def reference(model, until):
    return simulate(model, until, backend="vm", t_eval=GRID[until >= GRID])


def same(run, other):
    assert [event.t for event in run.events] == [event.t for event in other.events]
    assert np.array_equal(run.t, other.t) and np.array_equal(run.x, other.x)
    assert np.array_equal(run.codes, other.codes) and run.steps == other.steps
    assert run.energy == other.energy


def test_a_run_begins_at_once_and_the_next_is_compiled(model, slow, caplog):
    with caplog.at_level(logging.INFO, "bondgraph"):
        first = simulate(model, 5, t_eval=GRID[GRID <= 5])
        assert first.backend == "vm" and "compiled behind" in caplog.text
        slow.touch()
        assert model.compile()
        second = simulate(model, 5, t_eval=GRID[GRID <= 5])
    assert second.backend == "native"
    same(first, second)


def test_a_long_run_is_overtaken(model, slow, monkeypatch):
    opened = []
    at_hand = table.ModeTable.at_hand

    def look(self, mask):
        if len(opened) == 6:  # the compiler is let go in the middle of a run, and waited for
            slow.touch()
            for _, build in self._builds.values():
                build._process.wait()
        opened.append(mask)
        return at_hand(self, mask)

    monkeypatch.setattr(table.ModeTable, "at_hand", look)
    run = simulate(model, 40, t_eval=GRID)
    assert run.backend == "native" and len(opened) > 6
    same(run, reference(model, 40))


def test_a_mode_that_is_met_on_the_way_is_not_waited_for_early(model, slow):
    """The belt begins in a slip; only the base mode is in the cache."""
    slow.touch()
    model.modes.compile([0])
    slow.unlink()
    run = simulate(model, 2, initial={"v": 0.1}, t_eval=GRID[GRID <= 2])
    assert run.backend == "vm" and 0 in model.modes.loaded()
    slow.touch()
    assert simulate(model, 2, backend="native").backend == "native"
    assert set(model.modes.loaded()) == {0, 1}


def test_native_waits_and_vm_does_not_compile(model, folder):
    assert simulate(model, 2, backend="vm").backend == "vm" and not folder.exists()
    assert simulate(model, 2, backend="native").backend == "native"


def test_rows_are_not_copied(model):
    run = simulate(model, 2, backend="native")
    assert run.x.base is run.t.base is not None


def test_a_budget_holds_over_both_ways(model, slow):
    began = time.monotonic()
    run = simulate(model, 1e7, t_eval=[0.0], time_budget=0.3)
    assert run.outcome.value == "time budget"
    assert time.monotonic() - began < 5


def test_a_source_that_the_compiler_refuses_leaves_the_machine(
    model, tmp_path, monkeypatch, caplog
):
    fake = tmp_path / "cc"
    fake.write_text("#!/bin/sh\nexit 3\n")
    fake.chmod(0o755)
    monkeypatch.setenv("CC", str(fake))
    monkeypatch.setattr(hybrid, "LOOK", 1)
    with caplog.at_level(logging.WARNING):
        runs = [simulate(model, 20) for _ in range(3)]
    assert {run.backend for run in runs} == {"vm"}
    assert caplog.text.count("slower") == 1


def test_without_a_compiler_it_is_said_once(model, monkeypatch, caplog):
    monkeypatch.setenv("HALFARROW_NO_COMPILER", "1")
    with caplog.at_level(logging.WARNING):
        assert {simulate(model, 1).backend for _ in range(2)} == {"vm"}
    assert caplog.text.count("slower") == 1
    assert not model.compile()


def test_a_program_that_ends_first_is_silent_and_serves_the_next(folder):
    code = (
        "from bondgraph import simulate;from bondgraph.models import mass_on_belt;"
        "print(simulate(mass_on_belt.graph(), 0.01).backend)"
    )
    said = []
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=False
        )
        said.append((done.returncode, done.stdout.strip(), done.stderr))
        until = time.monotonic() + 30
        while (time.monotonic() < until) and len(list(Path(folder).glob("*/build-*"))):
            time.sleep(0.02)
    assert said == [(0, "vm", ""), (0, "native", "")]
