"""Compilers at work behind: one process for each thing that is wanted, which outlives its caller.

The process moves the finished object into the cache itself, so that a program that ends before its
compiler does still leaves the object to the next one.
"""

from __future__ import annotations

import atexit
import ctypes
import logging
import os
import shutil
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

from ...errors import BondGraphError
from .cache import FRESH, load_kept, remove

log = logging.getLogger(__name__)

# Not every compiler knows -march=native on every processor. What is moved appears whole.
SCRIPT = """
done=$1; shift
if "$@" -march=native -o built.so source.c -lm 2>said || "$@" -o built.so source.c -lm 2>said
then mv built.so "$done" && rm -rf "$PWD"
else exit 1
fi
"""


class CompileError(BondGraphError):
    """No compiler, or it failed; `stderr` holds what it said."""

    def __init__(self, message: str, stderr: str = "") -> None:
        super().__init__(message)
        self.stderr = stderr


class LostError(CompileError):
    """What was compiled, or what it was compiled in, was taken away meanwhile."""


class Build:
    """One compiler at work.

    Parameters
    ----------
    compiler : str
    source : str
        One C translation unit.
    flags : tuple of str
    folder : Path
        Entry of the cache that the object goes to.
    name : str
        Of the object, for people who look into the cache.

    Raises
    ------
    CompileError
        The compiler cannot be started.
    """

    def __init__(
        self, compiler: str, source: str, flags: tuple[str, ...], folder: Path, name: str
    ) -> None:
        self.name, self.began, self.owner = name, time.monotonic(), os.getpid()
        self._compiler = compiler
        self._made: ctypes.CDLL | None = None
        self._lock = threading.Lock()
        self._scratch, self._place = _places(folder)
        self._temporary = {self._scratch, self._place} - {folder}
        self._done = self._place / f"{name}.{self._scratch.name}{FRESH}"
        command = ["/bin/sh", "-c", SCRIPT, "sh", str(self._done), compiler, *flags]
        try:
            (self._scratch / "source.c").write_text(source, encoding="utf-8")
            self._process = subprocess.Popen(
                command,
                cwd=self._scratch,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,  # Ctrl-C is meant for the program, not for its compiler
            )
        except OSError as failure:
            raise CompileError(f"{compiler} cannot be run: {failure}") from failure

    def mine(self) -> bool:
        """Whether this process began it; a fork has no part in its parent's."""
        return self.owner == os.getpid()

    def finished(self) -> bool:
        """Whether the compiler is done, without waiting."""
        return self._process.poll() is not None

    def library(self) -> ctypes.CDLL:
        """What came out; waits for the compiler.

        Raises
        ------
        CompileError
            It refused the source, or its object cannot be loaded.
        """
        with self._lock:
            if self._made is None:
                try:
                    self._made = self._loaded()
                finally:
                    remove(self._done)  # where another process was first
                    for folder in self._temporary:
                        shutil.rmtree(folder, ignore_errors=True)
            return self._made

    def _loaded(self) -> ctypes.CDLL:
        if self._process.wait():
            raise self._refusal()
        library = load_kept(self._place)
        if library is None:
            raise LostError(f"compiled code cannot be loaded: nothing good in {self._place}")
        return library

    def _refusal(self) -> CompileError:
        try:
            said = (self._scratch / "said").read_text(encoding="utf-8", errors="replace")
        except OSError:
            return LostError(f"{self._scratch} was taken away while {self._compiler} worked in it")
        first = next((line for line in said.splitlines() if "error" in line), said[:200])
        return CompileError(f"{self._compiler} refused the generated code: {first}", said)

    def age(self) -> float:
        """Seconds since it began."""
        return time.monotonic() - self.began

    def let_go(self) -> None:
        """Forget the process, which is meant to go on alone."""
        if self._process.returncode is None:
            self._process.returncode = 0  # or Python warns of a child that still runs


def _places(folder: Path) -> tuple[Path, Path]:
    """A folder to compile in, and the one to leave the object in: the cache's where it can be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        return Path(tempfile.mkdtemp(dir=folder, prefix="build-")), folder
    except OSError as failure:
        log.warning("the cache %s cannot be used: %s", folder, failure)
    made, scratch = (Path(tempfile.mkdtemp(prefix="halfarrow-")) for _ in range(2))
    return scratch, made


_running: dict[Path, Build] = {}
_lock = threading.Lock()


def begin(folder: Path, make: Callable[[], Build]) -> Build:
    """The build of a cache entry: that under way in this process, or a new one.

    Parameters
    ----------
    folder : Path
    make : callable
        Starts and returns the `Build`.
    """
    with _lock:
        build = _running.get(folder)
        if build is None or not build.mine():
            build = _running[folder] = make()
        return build


def end(folder: Path, build: Build) -> ctypes.CDLL:
    """What a build made; waits for it. Raises CompileError."""
    try:
        return build.library()
    finally:
        with _lock:
            if _running.get(folder) is build:
                del _running[folder]


@atexit.register
def _leave() -> None:
    for build in _running.values():
        build.let_go()
