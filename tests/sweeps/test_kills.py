"""Sweeps killed again and again, and taken up each time, find what an undisturbed one does."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest
import xarray

from .same import assert_same

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(os.name != "posix", reason="kills process groups")


def command(out, points, executor, *more):
    return [
        *(sys.executable, "-m", "bondgraph.cli", "sweep", "bicycle_brake"),
        *("--vary", f"V0=0.5:1.5:{points // 20}", "--vary", "F_k=-100:1100:20[N]"),
        *("--until", "0.5", "--quantity", "final:V_c", "--quantity", "count:friction:stick"),
        *("--executor", executor, "--workers", "2", "--out", str(out), "--json", *more),
    ]


def started(words):
    return subprocess.Popen(
        words, cwd=ROOT, start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


def chunk_files(out):
    return len(list((out / "chunks").glob("*.chunk")))


def killed_at_random(words, out, chance):
    """Start a sweep, kill its whole process group a few chunks on; False where it got to its end."""
    process = started(words)
    enough, deadline = chunk_files(out) + chance.randrange(8), time.monotonic() + 60
    while process.poll() is None and chunk_files(out) <= enough and time.monotonic() < deadline:
        time.sleep(0.001)
    time.sleep(chance.random() * 0.02)
    if process.poll() is not None:
        return False
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    assert process.returncode == -signal.SIGKILL
    return True


def survive(tmp_path, points, chunk, kills, executor, seed):
    chance = random.Random(seed)
    whole, out = tmp_path / "whole", tmp_path / "killed"
    subprocess.run(command(whole, points, executor), cwd=ROOT, check=True, capture_output=True)
    words = command(out, points, executor, "--chunk", str(chunk), "--resume")
    done = 0
    for _ in range(kills):
        done += killed_at_random(words, out, chance)
    assert done == kills, "the sweep ended before it was killed so often"
    assert not (out / "dataset.nc").exists()
    end = subprocess.run(words, cwd=ROOT, check=True, capture_output=True, text=True)
    told = json.loads(end.stdout)
    assert told["points"] == points and 0 < told["resumed"] < points
    # Each chunk once; but one that was whole on disk when the kill came may lack its line.
    journal = [json.loads(line) for line in (out / "journal.jsonl").read_text().splitlines()]
    count = Counter(row["chunk"] for row in journal)
    assert set(count.values()) == {1}
    assert points // chunk - kills <= len(count) <= points // chunk
    with (
        xarray.open_dataset(whole / "dataset.nc") as a,
        xarray.open_dataset(out / "dataset.nc") as b,
    ):
        assert_same(a, b)
    assert (whole / "dataset.nc").read_bytes() == (out / "dataset.nc").read_bytes()


def test_two_kills(tmp_path):
    survive(tmp_path, 400, 5, 2, "threads", seed=1)


@pytest.mark.slow
@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_twenty_kills(tmp_path, executor):
    survive(tmp_path, 2000, 10, 20, executor, seed=2)


def children(pid):
    return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def alive(pid):
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state not in "ZX"


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="needs /proc")
def test_workers_end_with_their_parent(tmp_path):
    out = tmp_path / "s"
    process = started(command(out, 20_000, "processes", "--chunk", "50"))
    while chunk_files(out) < 3:
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    workers = children(process.pid)
    assert len(workers) >= 2
    process.kill()  # it alone
    process.wait()
    deadline = time.monotonic() + 20
    while any(map(alive, workers)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(map(alive, workers))


@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_ctrl_c_stops_soon_and_keeps_what_is_done(tmp_path, executor):
    out = tmp_path / "s"
    words = command(out, 20_000, executor, "--chunk", "100")
    process = started(words)
    while chunk_files(out) < 2:
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does
    _, said = process.communicate(timeout=20)
    assert process.returncode == 130
    assert said.decode().strip() == "bondgraph: stopped"
    assert 2 <= chunk_files(out) < 200 and not list(out.rglob("*.part"))
