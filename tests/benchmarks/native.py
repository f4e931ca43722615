"""Baselines in C, compiled on first use and loaded through ctypes.

Libraries lie in the user's cache (``$XDG_CACHE_HOME/halfarrow/benchmarks``), keyed by source,
compiler, flags and processor; nothing is written into the tree.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import platform
import shutil
import subprocess
import tempfile
from pathlib import Path

FLAGS = ("-O2", "-march=native", "-shared", "-fPIC", "-DNO_MAIN")


class BaselineUnavailable(RuntimeError):
    """No C compiler, or it failed."""


@functools.cache
def compiled(name: str) -> ctypes.CDLL:
    """Compile a C file of this folder if needed and load it.

    Raises
    ------
    BaselineUnavailable
        if there is no working C compiler
    """
    source = Path(__file__).with_name(name)
    compiler = _compiler()
    key = "\0".join([compiler, *FLAGS, platform.machine(), _processor(), source.read_text("utf-8")])
    digest = hashlib.sha256(key.encode()).hexdigest()[:16]
    path = _cache() / f"{source.stem}-{digest}.so"
    if not path.exists():
        part = path.with_name(f"{path.name}.{os.getpid()}")
        command = [compiler, *FLAGS, "-o", str(part), str(source), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise BaselineUnavailable(f"{' '.join(command)}: {done.stderr.strip()}")
        # a rename is atomic: two benchmarks started together both find a whole library
        part.replace(path)
    return ctypes.CDLL(str(path))


def _compiler() -> str:
    for name in (os.environ.get("CC"), "gcc", "cc", "clang"):
        if name and shutil.which(name):
            return name
    raise BaselineUnavailable("no C compiler: set CC or install gcc")


def _cache() -> Path:
    root = os.environ.get("XDG_CACHE_HOME")
    folder = (Path(root) if root else Path.home() / ".cache") / "halfarrow" / "benchmarks"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return Path(tempfile.mkdtemp(prefix="halfarrow-benchmarks-"))
    return folder


def _processor() -> str:
    # -march=native must not meet another processor through a shared home
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() + platform.node()
    return "".join(sorted({x for x in lines if x.startswith(("model name", "flags", "Features"))}))
