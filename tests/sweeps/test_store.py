"""A sweep on disk: taken up again to the same bits, refused where it is another."""

from __future__ import annotations

import json
import multiprocessing
import os
import shutil
import signal

import numpy as np
import pytest
import xarray

from bondgraph import CompiledModel
from bondgraph.errors import SweepError
from bondgraph.models import bicycle_brake
from bondgraph.sweeps import Final, Peak, grid, sweep
from bondgraph.sweeps.store import Store

from .cases import oscillator, two_numbers
from .same import assert_same

MODEL = CompiledModel(oscillator())
POINTS = grid(m=np.linspace(1, 3, 8), k=[-1.0, 2.0, 4.0])
ASKED = dict(t_span=1.0, initial={"spring.q": 0.1}, chunk=5)
KEPT = ("final:speed", Peak("spring.q"))


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    out = tmp_path_factory.mktemp("sweeps") / "whole"
    return sweep(MODEL, POINTS, KEPT, out=out, **ASKED), out


@pytest.fixture
def folder(undisturbed, tmp_path):
    """A copy of a finished sweep, to spoil."""
    return shutil.copytree(undisturbed[1], tmp_path / "copy")


def resumed(folder, **changes):
    told = []
    asked = dict(points=POINTS, quantity=KEPT, **ASKED) | changes
    points, kept = asked.pop("points"), asked.pop("quantity")
    found = sweep(MODEL, points, kept, out=folder, resume=True, progress=told.append, **asked)
    return found, told[-1]


def read(folder):
    with xarray.open_dataset(folder / "dataset.nc") as dataset:
        return dataset.load()


def test_the_file_holds_what_is_returned(undisturbed):
    found, out = undisturbed
    assert_same(read(out), found)
    assert "seconds" not in read(out) and "executor" not in read(out).attrs
    assert sorted(path.name for path in out.iterdir()) == [
        *("chunks", "dataset.nc", "journal.jsonl", "lock", "manifest.json")
    ]


def test_a_finished_sweep_is_read_and_not_computed(undisturbed, folder):
    found, last = resumed(folder)
    assert_same(found, undisturbed[0])
    assert (last.done, last.resumed) == (24, 24)
    assert found.attrs["executor"] == "nothing was left to do"
    assert found.seconds.values.tobytes() == undisturbed[0].seconds.values.tobytes()


def test_only_what_is_missing_is_computed(undisturbed, folder):
    for index in (0, 3):
        (folder / "chunks" / f"{index:06d}.chunk").unlink()
    (folder / "dataset.nc").unlink()
    found, last = resumed(folder)
    assert_same(found, undisturbed[0])
    assert_same(read(folder), undisturbed[0])
    assert (last.done, last.resumed) == (24, 14)
    journal = [json.loads(line) for line in (folder / "journal.jsonl").read_text().splitlines()]
    assert sorted(row["chunk"] for row in journal) == [0, 0, 1, 2, 3, 3, 4]


def test_another_chunk_or_executor_does_not_matter(undisturbed, folder):
    (folder / "chunks" / "000002.chunk").unlink()
    found, last = resumed(folder, chunk=11, executor="threads")
    assert_same(found, undisturbed[0])
    assert last.resumed == 19


SPOILS = {
    "cut short": lambda data: data[: len(data) // 2],
    "empty": lambda data: b"",
    "a bit turned": lambda data: data[:-300] + bytes([data[-300] ^ 4]) + data[-299:],
    "another's head": lambda data: data.replace(b"chunk 1", b"chunk 9", 1),
    "no checksum": lambda data: data.partition(b"\n\n")[2],
}


@pytest.mark.parametrize("spoil", SPOILS)
def test_a_spoilt_chunk_is_computed_again(undisturbed, folder, spoil):
    path = folder / "chunks" / "000001.chunk"
    path.write_bytes(SPOILS[spoil](path.read_bytes()))
    found, last = resumed(folder)
    assert_same(found, undisturbed[0])
    assert (last.done, last.resumed) == (24, 19)


def test_half_written_files_are_cleared_away(undisturbed, folder):
    (folder / "chunks" / ".000001.chunk-abc.part").write_bytes(b"half")
    (folder / ".dataset.nc-xyz.part").write_bytes(b"half")
    resumed(folder)
    assert not list(folder.rglob("*.part"))


OTHERS = [
    (dict(points=grid(m=np.linspace(1, 3, 8), k=[-1.0, 2.0, 4.5])), "points"),
    (dict(points=grid(k=[-1.0, 2.0, 4.0], m=np.linspace(1, 3, 8))), "points"),
    (dict(quantity=(KEPT[0], Peak("spring.q", after=0.5))), "quantities: peak"),
    (dict(quantity=(*KEPT, two_numbers)), "quantities: two_numbers"),
    (dict(t_span=1.5), "t_span"),
    (dict(rtol=1e-7), "options: rtol"),
    (dict(max_steps=99), "options: max_steps"),
    (dict(initial={"spring.q": 0.2}), "initial"),
    (dict(inputs={"push": 1.0}), "inputs"),
    (dict(backend="vm"), "compiled"),
    (dict(t_eval=[0.0, 1.0]), "t_eval"),
]


@pytest.mark.parametrize(("changes", "named"), OTHERS, ids=[named for _, named in OTHERS])
def test_what_decides_the_result_must_be_the_same(folder, changes, named):
    before = (folder / "manifest.json").read_bytes()
    with pytest.raises(SweepError, match=f"what differs is .*{named}"):
        resumed(folder, **changes)
    assert (folder / "manifest.json").read_bytes() == before


def test_another_model_is_told(folder):
    with pytest.raises(SweepError, match="what differs is model"):
        sweep(
            bicycle_brake.graph(), grid(V0=[1.0]), "final:V_c", t_span=1.0, out=folder, resume=True
        )


def test_functions_are_told_apart_by_what_they_do(tmp_path):
    def last_times(factor):
        return lambda run: factor * run["speed"][-1]

    asked = dict(t_span=0.1, out=tmp_path / "s")
    sweep(MODEL, grid(k=[1, 2]), last_times(2), **asked)
    sweep(MODEL, grid(k=[1, 2]), last_times(2), resume=True, **asked)
    with pytest.raises(SweepError, match="quantities: quantity"):
        sweep(MODEL, grid(k=[1, 2]), last_times(3), resume=True, **asked)


def test_nothing_is_overwritten(undisturbed, folder, tmp_path):
    asked = dict(points=POINTS, quantity=KEPT, **ASKED)
    points, kept = asked.pop("points"), asked.pop("quantity")
    with pytest.raises(SweepError, match=r"holds a sweep of 'oscillator' already.*resume"):
        sweep(MODEL, points, kept, out=folder, **asked)
    other = tmp_path / "papers"
    other.mkdir()
    (other / "thesis.tex").write_text("years of work")
    for resume in (False, True):
        with pytest.raises(SweepError, match=r"files of something else, such as thesis\.tex"):
            sweep(MODEL, points, kept, out=other, resume=resume, **asked)
    assert [path.name for path in other.iterdir()] == ["thesis.tex"]
    (tmp_path / "file").write_text("")
    with pytest.raises(SweepError, match="cannot be used"):
        sweep(MODEL, points, kept, out=tmp_path / "file", **asked)


def test_a_damaged_manifest_is_told(folder):
    (folder / "manifest.json").write_text("{")
    with pytest.raises(SweepError, match=r"manifest\.json"):
        resumed(folder)
    (folder / "manifest.json").write_text('{"format": 7}')
    with pytest.raises(SweepError, match="format 1"):
        resumed(folder)


def test_resume_begins_where_nothing_is(undisturbed, tmp_path):
    found, last = resumed(tmp_path / "new")
    assert_same(found, undisturbed[0])
    assert last.resumed == 0


def test_an_interrupt_leaves_what_is_done(undisturbed, tmp_path):
    def interrupt(now):
        if now.done >= 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(MODEL, POINTS, KEPT, out=tmp_path / "s", progress=interrupt, **ASKED)
    found, last = resumed(tmp_path / "s")
    assert_same(found, undisturbed[0])
    assert last.resumed >= 10


def _hold(folder, ready):
    store = Store(folder)
    ready.set()
    signal.pause()
    store.close()


def test_two_processes_do_not_share_a_folder_and_a_dead_one_holds_none(folder):
    spawn = multiprocessing.get_context("spawn")
    ready = spawn.Event()
    holder = spawn.Process(target=_hold, args=(folder, ready), daemon=True)
    holder.start()
    assert ready.wait(60)
    with pytest.raises(SweepError, match=f"process {holder.pid} works in this folder"):
        resumed(folder)
    os.kill(holder.pid, signal.SIGKILL)
    holder.join()
    resumed(folder)


def test_a_full_disk_is_one_error(monkeypatch, tmp_path):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(SweepError, match="cannot be written: No space left"):
        sweep(MODEL, POINTS, Final("speed"), out=tmp_path / "s", **ASKED)
    assert not list((tmp_path / "s").rglob("*.part"))
