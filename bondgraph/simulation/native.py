"""C compiled once and kept: find a compiler, build shared objects, load CasADi's code.

A shared object is kept on disk under a hash of everything that decides its content, so a model's
structure is compiled once per machine. Set ``HALFARROW_CACHE`` to move the folder (by default
``halfarrow`` in ``$XDG_CACHE_HOME`` or ``~/.cache``) and ``HALFARROW_NO_COMPILER=1`` to do without.
"""

from __future__ import annotations

import ctypes
import hashlib
import logging
import os
import platform
import shutil
import subprocess
import tempfile
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from bondgraph.errors import BondGraphError

if TYPE_CHECKING:
    import casadi as ca

__all__ = ["CompileError", "NativeMode", "find_compiler", "load_driver", "load_mode", "load_shared"]

log = logging.getLogger(__name__)

# Values must not depend on the optimiser's mood: never -ffast-math.
FLAGS = ("-O2", "-std=gnu11", "-fno-math-errno", "-fPIC", "-shared")
LARGE_SOURCE = 500_000  # beyond this many characters gcc's -O2 takes minutes, -O1 seconds


class CompileError(BondGraphError):
    """No compiler, or it failed; `stderr` holds what it said."""

    def __init__(self, message: str, stderr: str = "") -> None:
        super().__init__(message)
        self.stderr = stderr


class NativeMode(NamedTuple):
    """One mode's functions in memory: addresses, CasADi memory slots, work sizes."""

    rhs: int
    guard: int
    rhs_memory: int
    guard_memory: int
    sizes: tuple[int, int, int, int]  # of arg, res, iw, w
    library: ctypes.CDLL  # keeps the addresses valid


def find_compiler() -> str | None:
    """Path of a C compiler: ``$CC``, ``cc``, ``gcc`` or ``clang``; None where there is none.

    ``HALFARROW_NO_COMPILER=1`` in the environment hides it.
    """
    if os.environ.get("HALFARROW_NO_COMPILER", "") not in ("", "0"):
        return None
    for name in (os.environ.get("CC"), "cc", "gcc", "clang"):
        if name and (path := shutil.which(name)):
            return path
    return None


def load_shared(source: str, name: str) -> ctypes.CDLL:
    """The shared object of a C source, from the cache or compiled now.

    Safe against concurrent writers (files appear whole) and against damaged files (each carries
    the hash of its content in its name; one that does not fit is thrown away and built again).

    Parameters
    ----------
    source : str
        One C translation unit.
    name : str
        For people who look into the cache.

    Raises
    ------
    CompileError
        No compiler was found, or it refused the source.
    """
    compiler = find_compiler()
    if compiler is None:
        raise CompileError("no C compiler found: install gcc or clang, or set CC")
    folder = _cache_folder() / _key(source, compiler)
    for kept in _intact(folder):
        try:
            return ctypes.CDLL(str(kept))
        except OSError as failure:
            log.warning("%s cannot be loaded and is built again: %s", kept, failure)
            kept.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(prefix="halfarrow-") as scratch:
        built = _compile(compiler, source, Path(scratch))
        try:
            return ctypes.CDLL(str(_keep(built, folder, name)))
        except OSError as failure:
            log.warning("the cache %s cannot be used: %s", folder, failure)
            return ctypes.CDLL(str(built))


def load_driver() -> ctypes.CDLL:
    """The integrator of ``driver.c``."""
    source = resources.files(__package__).joinpath("driver.c").read_text(encoding="utf-8")
    library = load_shared(source, "driver")
    for name, arguments in (
        ("halfarrow_advance", [ctypes.c_void_p]),
        ("halfarrow_work_size", [ctypes.c_longlong] * 3),
        ("halfarrow_flag_size", [ctypes.c_longlong]),
        ("halfarrow_run_size", []),
    ):
        function = getattr(library, name)
        function.argtypes = arguments
        function.restype = ctypes.c_longlong
    return library


def load_mode(rhs: ca.Function, guard: ca.Function | None) -> NativeMode:
    """Two CasADi functions as generated and compiled C.

    Parameters
    ----------
    rhs, guard : casadi.Function
        With different names and one dense result each; `guard` may be None.
    """
    import casadi as ca

    functions = [f for f in (rhs, guard) if f is not None]
    generator = ca.CodeGenerator("mode", {"with_header": False})
    for function in functions:
        generator.add(function)
    library = load_shared(generator.dump(), rhs.name())

    def slot(function: ca.Function) -> int:
        return int(getattr(library, f"{function.name()}_checkout")())

    def address(function: ca.Function) -> int:
        return ctypes.cast(getattr(library, function.name()), ctypes.c_void_p).value or 0

    sizes = [(f.sz_arg(), f.sz_res(), f.sz_iw(), f.sz_w()) for f in functions]
    arg, res, iw, w = (max(column) for column in zip(*sizes, strict=True))
    return NativeMode(
        rhs=address(rhs),
        guard=address(guard) if guard is not None else 0,
        rhs_memory=slot(rhs),
        guard_memory=slot(guard) if guard is not None else 0,
        sizes=(arg, res, iw, w),
        library=library,
    )


def _cache_folder() -> Path:
    if given := os.environ.get("HALFARROW_CACHE"):
        return Path(given)
    if base := os.environ.get("XDG_CACHE_HOME"):
        return Path(base) / "halfarrow"
    try:
        return Path.home() / ".cache" / "halfarrow"
    except RuntimeError:  # no home: load_shared then finds the folder unusable and says so
        return Path(os.devnull) / "halfarrow"


def _key(source: str, compiler: str) -> str:
    """Hash of what decides the machine code: source, flags, compiler, processor."""
    # A compiler's version is read from its file: `cc --version` would cost more than the loading.
    binary = Path(compiler).resolve()
    stat = binary.stat()
    parts = (source, *FLAGS, str(binary), str(stat.st_size), str(stat.st_mtime_ns), _processor())
    return hashlib.blake2b("\0".join(parts).encode(), digest_size=16).hexdigest()


def _processor() -> str:
    """What -march=native looks at."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            first = file.read(8192).split("\n\n")[0].splitlines()
    except OSError:
        return f"{platform.machine()} {platform.processor()}"
    wanted = ("model name", "flags", "Features", "CPU part", "isa")
    return platform.machine() + "".join(line for line in first if line.startswith(wanted))


def _intact(folder: Path) -> list[Path]:
    """The files of a cache entry whose content is what their name says."""
    try:
        files = sorted(folder.glob("*.so"))
    except OSError:
        return []
    good = []
    for file in files:
        try:
            if file.stem.rpartition("-")[2] == _digest(file):
                good.append(file)
            else:
                log.warning("%s is damaged and is built again", file)
                file.unlink(missing_ok=True)
        except OSError:
            continue
    return good


def _digest(file: Path) -> str:
    return hashlib.blake2b(file.read_bytes(), digest_size=16).hexdigest()


def _compile(compiler: str, source: str, folder: Path) -> Path:
    (folder / "source.c").write_text(source, encoding="utf-8")
    flags = [*FLAGS]
    if len(source) > LARGE_SOURCE:
        flags[0] = "-O1"
    said = ""
    for tuned in (["-march=native"], []):  # not every compiler knows it on every processor
        command = [compiler, *flags, *tuned, "-o", "built.so", "source.c", "-lm"]
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        except OSError as failure:
            raise CompileError(f"{compiler} cannot be run: {failure}") from failure
        if done.returncode == 0:
            return folder / "built.so"
        said = done.stderr
    raise CompileError(f"{compiler} failed: {said.strip().splitlines()[-1:]}", said)


def _keep(built: Path, folder: Path, name: str) -> Path:
    """Put a file into the cache under a name that tells its content; it appears whole or not."""
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / f"{name}-{_digest(built)}.so"
    handle, part = tempfile.mkstemp(dir=folder, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(built.read_bytes())
        os.replace(part, kept)
    except OSError:
        Path(part).unlink(missing_ok=True)
        raise
    return kept
