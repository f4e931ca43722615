"""Compiled code on disk: built once, shared by processes, never half there, never in the way."""

from __future__ import annotations

import logging
import shutil
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import casadi as ca
import pytest

from bondgraph.simulation.native import builds, cache, compiler

pytestmark = pytest.mark.skipif(not compiler.find_compiler(), reason="no compiler")
SOURCE = "double twice(double x) { return 2 * x; }\n"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("HALFARROW_CACHE", str(tmp_path / "own"))
    return tmp_path / "own"


def kept(folder):
    return sorted(folder.rglob("*.so"))


def wanted(source=SOURCE):
    return compiler.Wanted("twice", (source,), lambda: (source, ()))


def wait_for(what, seconds=20):
    until = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < until
        time.sleep(0.01)


def test_is_built_once(folder, monkeypatch):
    compiler.load_shared(SOURCE, "twice")
    (file,) = kept(folder)
    monkeypatch.setattr(compiler, "Build", None)  # would fail if called
    assert compiler.load_shared(SOURCE, "twice").twice
    assert kept(folder) == [file]


def test_nothing_but_the_object_is_left(folder):
    compiler.load_shared(SOURCE, "twice")
    assert [path.suffix for path in folder.rglob("*") if not path.is_dir()] == [".so"]
    assert not [path for path in folder.rglob("*") if path.name.startswith("build-")]


@pytest.mark.parametrize("damage", [b"", b"\x7fELF", "half", "byte"])
def test_damaged_files_are_built_again(folder, damage):
    compiler.load_shared(SOURCE, "twice")
    (file,) = kept(folder)
    content = file.read_bytes()
    file.unlink()  # the old one stays mapped
    if damage == "half":
        damage = content[: len(content) // 2]
    elif damage == "byte":
        damage = content[:5000] + bytes([content[5000] ^ 1]) + content[5001:]
    file.write_bytes(damage)
    assert compiler.load_shared(SOURCE, "twice").twice
    (file,) = kept(folder)
    assert file.read_bytes() == content


@pytest.mark.parametrize("part", [0.3, 0.999])
def test_an_unsigned_file_that_is_cut_is_not_loaded(folder, part):
    compiler.load_shared(SOURCE, "twice")
    (file,) = kept(folder)
    content = file.read_bytes()
    file.unlink()
    file.with_name("twice.build-x.fresh").write_bytes(content[: int(part * len(content))])
    assert cache.load_kept(file.parent) is None
    assert not list(folder.rglob("*.fresh"))


def test_many_writers_do_no_harm(folder):
    sources = [SOURCE + f"int number = {i % 3};\n" for i in range(12)]
    with ThreadPoolExecutor(6) as pool:
        assert all(pool.map(lambda source: compiler.load_shared(source, "twice").twice, sources))
    assert len({file.parent for file in kept(folder)}) == 3
    assert not list(folder.rglob("*.fresh"))


def test_processes_that_want_the_same_all_get_it(folder):
    code = (
        "from bondgraph.simulation.native import load_shared;"
        f"assert load_shared({SOURCE!r}, 'twice').twice"
    )
    running = [
        subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE) for _ in range(3)
    ]
    assert [process.communicate()[1] for process in running] == [b""] * 3
    assert [process.returncode for process in running] == [0] * 3
    assert kept(folder) and not list(folder.rglob("*.fresh"))


def test_threads_share_one_build(folder):
    with ThreadPoolExecutor(4) as pool:
        found = set(pool.map(lambda _: id(wanted().behind()), range(4)))
    assert len(found) == 1
    assert wanted().load().twice


def test_a_process_that_ends_leaves_the_object_to_the_next(folder):
    code = (
        "from bondgraph.simulation.native import Wanted;"
        f"Wanted('twice', ({SOURCE!r},), lambda: ({SOURCE!r}, ())).behind()"
    )
    began = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-X", "dev", "-c", code], capture_output=True, check=False, text=True
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert time.monotonic() - began < 60
    wait_for(lambda: list(folder.rglob("*.fresh")))
    wait_for(lambda: not list(folder.rglob("build-*[!h]")))
    assert wanted().kept().twice
    assert kept(folder)


@pytest.mark.parametrize("place", ["/dev/null/nowhere", "file"])
def test_an_unusable_cache_is_done_without(tmp_path, monkeypatch, caplog, place):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("HALFARROW_CACHE", str(tmp_path / place))
    with caplog.at_level(logging.WARNING):
        assert compiler.load_shared(SOURCE, "twice").twice
    assert "cannot be used" in caplog.text


def test_a_cache_that_cannot_be_written_is_read(folder, monkeypatch):
    compiler.load_shared(SOURCE, "twice")
    (file,) = kept(folder)
    fresh = file.rename(file.with_name("twice.build-x.fresh"))

    def refused(*_):  # as in a folder of another user; a mode of 0500 would not stop root
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(cache.os, "replace", refused)
    assert cache.load_kept(file.parent).twice and fresh.exists()


def test_a_cache_that_is_cleared_meanwhile_is_filled_again(folder):
    build = wanted().behind()
    shutil.rmtree(folder, ignore_errors=True)
    assert wanted().made(build).twice


def test_another_processor_gets_its_own_code(monkeypatch):
    here = cache.entry(compiler.find_compiler(), ("a",))
    monkeypatch.setattr(cache, "_processor", lambda: "another")
    assert cache.entry(compiler.find_compiler(), ("a",)) != here


def test_entries_differ_where_anything_does(tmp_path):
    one = tmp_path / "cc"
    one.write_text("1")
    first = cache.entry(str(one), ("a", "b"))
    assert first == cache.entry(str(one), (b"a", "b"))
    assert first != cache.entry(str(one), ("ab", ""))
    one.write_text("22")
    assert first != cache.entry(str(one), ("a", "b"))


def test_a_mode_is_known_by_its_instructions():
    def key(law, p=1):
        x = ca.SX.sym("x")
        given = [ca.SX.sym("t"), x, *(ca.SX.sym(name, 0) for name in "ups")]
        rhs = ca.Function("rhs", given, [ca.vertcat(law(x), 0, 0)])
        return compiler.mode_wanted(rhs, None, (1, 0, 0)).parts

    assert key(lambda x: x**2 + 1) == key(lambda x: x**2 + 1)
    assert key(lambda x: x**2 + 1) != key(lambda x: x**2 + 1.0000000000000002)
    assert key(lambda x: x**2 + 1) != key(lambda x: x**2 - 1)


def test_a_refused_source_keeps_what_the_compiler_said(folder):
    with pytest.raises(compiler.CompileError) as caught:
        compiler.load_shared("int oops(", "oops")
    assert "oops" in caught.value.stderr
    assert not list(folder.rglob("build-*"))


def test_a_compiler_that_is_none_is_named(tmp_path, monkeypatch):
    fake = tmp_path / "cc"
    fake.write_text("#!/bin/sh\nexit 3\n")
    fake.chmod(0o755)
    monkeypatch.setenv("CC", str(fake))
    with pytest.raises(compiler.CompileError, match="refused"):
        compiler.load_shared(SOURCE, "twice")


def test_a_fork_has_no_part_in_its_parents_builds(folder, monkeypatch):
    made = []

    def make():
        made.append(builds.Build("/bin/true", SOURCE, (), folder / "entry", "twice"))
        return made[-1]

    place = Path("/nowhere/at/all")
    first = builds.begin(place, make)
    assert builds.begin(place, make) is first
    monkeypatch.setattr(builds.os, "getpid", lambda: -1)
    assert not first.mine() and builds.begin(place, make) is not first
    del builds._running[place]
    for build in made:
        with pytest.raises(builds.CompileError):
            build.library()


def test_one_build_serves_all_who_wait_without_a_cache(monkeypatch):
    monkeypatch.setenv("HALFARROW_CACHE", "/dev/null/nowhere")
    build = wanted().behind()
    found = []
    waiting = [threading.Thread(target=lambda: found.append(build.library())) for _ in range(3)]
    for thread in waiting:
        thread.start()
    for thread in waiting:
        thread.join()
    assert len(found) == 3 and len(set(map(id, found))) == 1
    wanted().made(build)
