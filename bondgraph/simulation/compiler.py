"""The C compiler: find it, build shared objects of modes and driver, keep them on disk.

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
import re
import shutil
import subprocess
import tempfile
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ..errors import BondGraphError

if TYPE_CHECKING:
    import casadi as ca

__all__ = [
    "CompileError",
    "NativeMode",
    "find_compiler",
    "load_driver",
    "load_mode",
    "load_shared",
]

log = logging.getLogger(__name__)

# Values must not depend on the optimiser's mood or the processor: no -ffast-math, and no fused
# multiply-add, so that C, the Python twin and other machines give the same bits (at 5 % of speed).
FLAGS = ("-std=gnu11", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared")
# A model of a few states is a chain of dependent scalars: packing them into vectors only adds moves.
SMALL_SOURCE, SMALL_FLAGS = 30_000, ("-O3", "-fno-tree-vectorize")
MEDIUM_SOURCE, MEDIUM_FLAGS = 100_000, ("-O2",)
LARGE_SOURCE, LARGE_FLAGS = 5_000_000, ("-O1",)
HUGE_FLAGS = ("-O0",)  # an optimiser would take minutes
KERNEL = ("rhs", "guard", "advance", "finish", "inspect")  # functions of kernel.c, as in its Mode


class CompileError(BondGraphError):
    """No compiler, or it failed; `stderr` holds what it said."""

    def __init__(self, message: str, stderr: str = "") -> None:
        super().__init__(message)
        self.stderr = stderr


class NativeMode(NamedTuple):
    """One mode's kernel in memory: addresses of its functions, work sizes of the model."""

    functions: dict[str, int]
    sizes: tuple[int, int]  # of iw, w
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


def load_shared(source: str, name: str, flags: tuple[str, ...] = MEDIUM_FLAGS) -> ctypes.CDLL:
    """The shared object of a C source, from the cache or compiled now.

    Safe against concurrent writers (files appear whole) and against damaged files (each carries
    the hash of its content in its name; one that does not fit is thrown away and built again).

    Parameters
    ----------
    source : str
        One C translation unit.
    name : str
        For people who look into the cache.
    flags : tuple of str
        For the compiler, beside those always given.

    Raises
    ------
    CompileError
        No compiler was found, or it refused the source.
    """
    compiler = find_compiler()
    if compiler is None:
        raise CompileError("no C compiler found: install gcc or clang, or set CC")
    flags += FLAGS
    folder = _cache_folder() / _key(source, compiler, flags)
    for kept in _intact(folder):
        try:
            return ctypes.CDLL(str(kept))
        except OSError as failure:
            log.warning("%s cannot be loaded and is built again: %s", kept, failure)
            kept.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(prefix="halfarrow-") as scratch:
        built = _compile(compiler, source, flags, Path(scratch))
        try:
            return ctypes.CDLL(str(_keep(built, folder, name)))
        except OSError as failure:
            log.warning("the cache %s cannot be used: %s", folder, failure)
        try:
            return ctypes.CDLL(str(built))
        except OSError as failure:
            raise CompileError(f"compiled code cannot be loaded: {failure}") from failure


def load_driver() -> ctypes.CDLL:
    """The integrator of ``driver.c``."""
    library = load_shared(_own("kernel.c") + _own("driver.c") + _own("batch.c"), "driver")
    for name, arguments in (
        ("halfarrow_advance", [ctypes.c_void_p]),
        ("halfarrow_batch", [ctypes.c_void_p] * 2),
        ("halfarrow_work_size", [ctypes.c_longlong] * 3),
        ("halfarrow_flag_size", [ctypes.c_longlong]),
        ("halfarrow_run_size", []),
    ):
        function = getattr(library, name)
        function.argtypes = arguments
        function.restype = ctypes.c_longlong
    return library


def load_mode(
    rhs: ca.Function, guard: ca.Function | None, sizes: tuple[int, int, int]
) -> NativeMode:
    """Compile the steps of one mode: CasADi's C for its functions, and ``kernel.c`` around it.

    Parameters
    ----------
    rhs, guard : casadi.Function
        With different names and one dense result each; `guard` may be None.
    sizes : (int, int, int)
        Numbers of states, inputs and switches.
    """
    model, macros = _model_source(rhs, guard, sizes)
    flags: tuple[str, ...] = HUGE_FLAGS
    for limit, smaller in (
        (LARGE_SOURCE, LARGE_FLAGS),
        (MEDIUM_SOURCE, MEDIUM_FLAGS),
        (SMALL_SOURCE, SMALL_FLAGS),
    ):
        if len(model) < limit:
            flags = smaller
    macros["SMALL"] = str(int(len(model) < SMALL_SOURCE))
    source = (
        # Everything of CasADi's becomes static, to be taken into the kernel or dropped.
        "#define CASADI_SYMBOL_EXPORT static inline __attribute__((unused))\n",
        model,
        *(f"#define {name} {value}\n" for name, value in macros.items()),
        _own("kernel.c"),
    )
    library = load_shared("".join(source), rhs.name(), flags)
    address = {name: _address(library, f"mode_{name}") for name in KERNEL}
    functions = [f for f in (rhs, guard) if f is not None]
    iw, w = (
        max(column) for column in zip(*((f.sz_iw(), f.sz_w()) for f in functions), strict=True)
    )
    return NativeMode(address, (iw, w), library)


def _model_source(
    rhs: ca.Function, guard: ca.Function | None, sizes: tuple[int, int, int]
) -> tuple[str, dict[str, str]]:
    """CasADi's C for a mode, and the macros that tell ``kernel.c`` its names and sizes."""
    import casadi as ca

    generator = ca.CodeGenerator("mode", {"with_header": False})
    macros = dict(zip("NMK", map(str, sizes), strict=True))
    for role, function in (("RHS", rhs), ("GUARD", guard)):
        if function is not None:
            generator.add(function)
            macros[role] = function.name()
            macros[f"{role}_CHECKOUT"] = f"{function.name()}_checkout"
            macros[f"{role}_RELEASE"] = f"{function.name()}_release"
            macros[f"{role}_ARG"] = str(function.sz_arg())
            macros[f"{role}_RES"] = str(function.sz_res())
    return _straightened(generator.dump(), 1 if guard is None else 2), macros


def _straightened(model: str, count: int) -> str:
    """CasADi's C without its questions whether each argument is there.

    They cut a straight line of code into thousands of blocks, for which gcc's time grows with the
    square. Only for functions that call no others: those may well be given null pointers.
    """
    if model.count("static int casadi_f") != count:
        return model
    model = re.sub(r"arg\[(\d)\]\? arg\[\1\]\[(\d+)\] : 0", r"arg_\1[\2]", model)
    model = re.sub(r"if \(res\[0\]!=0\) res\[0\]", "res_0", model)
    arguments = ", ".join(f"*restrict arg_{i}=arg[{i}]" for i in range(5))
    local = f"  const casadi_real {arguments};\n  casadi_real *restrict res_0=res[0];\n"
    return re.sub(r"(static int casadi_f\d+\([^)]*\) \{\n)", rf"\1{local}", model)


def _own(file: str) -> str:
    return resources.files(__package__).joinpath(file).read_text(encoding="utf-8")


def _address(library: ctypes.CDLL, name: str) -> int:
    return ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0


def _cache_folder() -> Path:
    if given := os.environ.get("HALFARROW_CACHE"):
        return Path(given)
    if base := os.environ.get("XDG_CACHE_HOME"):
        return Path(base) / "halfarrow"
    try:
        return Path.home() / ".cache" / "halfarrow"
    except RuntimeError:  # no home: load_shared then finds the folder unusable and says so
        return Path(os.devnull) / "halfarrow"


def _key(source: str, compiler: str, flags: tuple[str, ...]) -> str:
    """Hash of what decides the machine code: source, flags, compiler, processor."""
    # A compiler's version is read from its file: `cc --version` would cost more than the loading.
    binary = Path(compiler).resolve()
    stat = binary.stat()
    parts = (source, *flags, str(binary), str(stat.st_size), str(stat.st_mtime_ns), _processor())
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


def _compile(compiler: str, source: str, flags: tuple[str, ...], folder: Path) -> Path:
    (folder / "source.c").write_text(source, encoding="utf-8")
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
    first = next((line for line in said.splitlines() if "error" in line), said[:200])
    raise CompileError(f"{compiler} refused the generated code: {first}", said)


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
