"""The C compiler: find it, write the source of modes and driver, load what it makes of them.

What is compiled is kept on disk (`cache`), so a model's structure is compiled once per machine, and
compilers work behind while a run goes on without them (`builds`). ``HALFARROW_NO_COMPILER=1`` does
without.
"""

from __future__ import annotations

import ctypes
import functools
import os
import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from .builds import Build, CompileError, LostError, begin, end
from .cache import entry, load_kept

if TYPE_CHECKING:
    import casadi as ca

__all__ = [
    "CompileError",
    "NativeMode",
    "Wanted",
    "driver_wanted",
    "find_compiler",
    "load_driver",
    "load_mode",
    "load_shared",
    "mode_wanted",
]

# Values must not depend on the optimiser's mood or the processor: no -ffast-math, and no fused
# multiply-add, so that C, the Python twin and other machines give the same bits (at 5 % of speed).
FLAGS = ("-std=gnu11", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared")
# A model of a few states is a chain of dependent scalars: packing them into vectors only adds moves.
SMALL_SOURCE, SMALL_FLAGS = 30_000, ("-O3", "-fno-tree-vectorize")
MEDIUM_SOURCE, MEDIUM_FLAGS = 100_000, ("-O2",)
LARGE_SOURCE, LARGE_FLAGS = 5_000_000, ("-O1",)
HUGE_FLAGS = ("-O0",)  # an optimiser would take minutes
KERNEL = ("rhs", "guard", "advance", "finish", "inspect")  # functions of kernel.c, as in its Mode


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
    return _on_path(os.environ.get("CC"), os.environ.get("PATH"))


@functools.lru_cache(maxsize=8)  # the search costs as much as loading a mode
def _on_path(given: str | None, path: str | None) -> str | None:
    for name in (given, "cc", "gcc", "clang"):
        if name and (found := shutil.which(name, path=path)):
            return found
    return None


@dataclass(frozen=True)
class Wanted:
    """A shared object to be loaded from the cache or compiled.

    Attributes
    ----------
    name : str
        For people who look into the cache.
    parts : tuple of str or bytes
        What decides the machine code, beside compiler and processor.
    source : callable
        To the C and the flags for it; called only where it has to be compiled.
    """

    name: str
    parts: tuple[str | bytes, ...]
    source: Callable[[], tuple[str, tuple[str, ...]]]

    def kept(self) -> ctypes.CDLL | None:
        """What is in the cache. Raises CompileError where there is no compiler."""
        return load_kept(self._place()[1])

    def behind(self) -> Build:
        """The compiler at work on it, started now unless it is already."""
        compiler, folder = self._place()

        def start() -> Build:
            source, flags = self.source()
            return Build(compiler, source, flags + FLAGS, folder, self.name)

        return begin(folder, start)

    def made(self, build: Build) -> ctypes.CDLL:
        """What a build made; waits for it. Raises CompileError."""
        folder = self._place()[1]
        try:
            return end(folder, build)
        except LostError:  # once more: the cache may have been cleared
            return end(folder, self.behind())

    def load(self) -> ctypes.CDLL:
        """From the cache, or compiled now. Raises CompileError."""
        return self.kept() or self.made(self.behind())

    def _place(self) -> tuple[str, Path]:
        compiler = find_compiler()
        if compiler is None:
            raise CompileError("no C compiler found: install gcc or clang, or set CC")
        try:
            return compiler, entry(compiler, self.parts)
        except OSError as failure:
            _on_path.cache_clear()
            raise CompileError(f"{compiler} cannot be run: {failure}") from failure


def load_shared(source: str, name: str, flags: tuple[str, ...] = MEDIUM_FLAGS) -> ctypes.CDLL:
    """The shared object of a C source, from the cache or compiled now.

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
    return Wanted(name, (source, *flags, *FLAGS), lambda: (source, flags)).load()


def driver_wanted() -> Wanted:
    """The integrator of ``driver.c``."""
    source = _own("kernel.c") + _own("driver.c") + _own("batch.c")
    return Wanted("driver", (source, *FLAGS), lambda: (source, MEDIUM_FLAGS))


def load_driver(library: ctypes.CDLL | None = None) -> ctypes.CDLL:
    """The integrator with its arguments told, from a library or by waiting for one."""
    library = library or driver_wanted().load()
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


def mode_wanted(rhs: ca.Function, guard: ca.Function | None, sizes: tuple[int, int, int]) -> Wanted:
    """The steps of one mode: CasADi's C for its functions, and ``kernel.c`` around it.

    Parameters
    ----------
    rhs, guard : casadi.Function
        With different names and one dense result each; `guard` may be None.
    sizes : (int, int, int)
        Numbers of states, inputs and switches.
    """
    # A function's serialized form holds every instruction and costs a tenth of its C. From there to
    # the C lead CasADi and this file alone.
    functions = [f.serialize() for f in (rhs, guard) if f is not None]
    return Wanted(
        rhs.name(),
        (*functions, str(sizes), _recipe(), _own("kernel.c")),
        lambda: _mode_source(rhs, guard, sizes),
    )


@functools.cache
def _recipe() -> bytes:
    """What makes a mode's C of its functions, by content."""
    import casadi as ca

    return (resources.files(__package__) / "compiler.py").read_bytes() + ca.__version__.encode()


def load_mode(
    rhs: ca.Function,
    guard: ca.Function | None,
    sizes: tuple[int, int, int],
    library: ctypes.CDLL | None = None,
) -> NativeMode:
    """The kernel of one mode, from a library or by waiting for one; arguments as `mode_wanted`."""
    library = library or mode_wanted(rhs, guard, sizes).load()
    address = {name: _address(library, f"mode_{name}") for name in KERNEL}
    functions = [f for f in (rhs, guard) if f is not None]
    iw, w = (
        max(column) for column in zip(*((f.sz_iw(), f.sz_w()) for f in functions), strict=True)
    )
    return NativeMode(address, (iw, w), library)


def _mode_source(
    rhs: ca.Function, guard: ca.Function | None, sizes: tuple[int, int, int]
) -> tuple[str, tuple[str, ...]]:
    """A mode's C, and the flags that suit its length."""
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
    return "".join(source), flags


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


@functools.cache
def _own(file: str) -> str:
    return resources.files(__package__).joinpath(file).read_text(encoding="utf-8")


def _address(library: ctypes.CDLL, name: str) -> int:
    return ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0
