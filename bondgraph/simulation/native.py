"""Compiled C: find a compiler, build and keep shared objects, run ``driver.c`` on them.

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
import time
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..errors import BondGraphError
from .outcome import Outcome

if TYPE_CHECKING:
    import casadi as ca

    from .hybrid import Options, Problem

__all__ = [
    "CompileError",
    "NativeMode",
    "NativeRun",
    "find_compiler",
    "load_driver",
    "load_mode",
    "load_shared",
]

log = logging.getLogger(__name__)

LONGEST_PAUSE = 0.05  # s between two looks at the clock and at Ctrl-C

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
    library = load_shared(_own("kernel.c") + _own("driver.c"), "driver")
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


# ---------------------------------------------------------------------- running driver.c


class _Mode(ctypes.Structure):
    """`Mode` of kernel.c."""

    _fields_ = (("stuck", ctypes.c_ulonglong), *((name, ctypes.c_void_p) for name in KERNEL))


def _fields(kind: Any, names: str) -> list[tuple[str, Any]]:
    return [(name, kind) for name in names.split()]


class _Run(ctypes.Structure):
    """The public part of `Run` of driver.c."""

    _fields_ = (
        *_fields(ctypes.c_longlong, "n m k n_knots n_eval n_modes row_capacity event_capacity"),
        *_fields(ctypes.c_longlong, "max_steps max_events"),
        *_fields(ctypes.c_double, "t_end rtol max_step bound energy0 slice"),
        *_fields(ctypes.c_void_p, "x0 parameters atol weights knots values t_eval hold modes"),
        *_fields(ctypes.c_void_p, "iw w rows row_codes events event_codes x_end code"),
        *_fields(ctypes.c_void_p, "work flags"),
        *_fields(ctypes.c_double, "t"),
        *_fields(ctypes.c_longlong, "row_count event_count steps rejected evaluations"),
        *_fields(ctypes.c_ulonglong, "wanted"),
    )


# What halfarrow_advance returns, in the order of driver.c.
_NEED_MODE, _ROWS_FULL, _EVENTS_FULL, _PAUSED, _FIRST_OUTCOME = range(1, 6)
_OUTCOMES = (
    Outcome.FINISHED,
    Outcome.EVENT_LIMIT,
    Outcome.CHATTERING,
    Outcome.STEP_UNDERFLOW,
    Outcome.STEP_LIMIT,
    Outcome.NON_FINITE,
    Outcome.DIVERGED,
)


class NativeRun:
    """One run of driver.c: its memory, and the service it asks for.

    Parameters
    ----------
    problem, options
        As for `hybrid.integrate`, checked already.
    """

    def __init__(self, problem: Problem, options: Options) -> None:
        self.table, n, k = problem.modes, problem.modes.n, problem.modes.k
        self.driver = self.table.driver()
        self.memory = ctypes.create_string_buffer(self.driver.halfarrow_run_size())
        self.run = run = _Run.from_buffer(self.memory)
        self.kept: dict[str, Any] = {}
        _, knots, values, linear = problem.input_table()
        t_eval = options.t_eval
        run.n, run.m, run.k, run.n_knots = n, problem.modes.m, k, len(knots)
        run.n_eval = 0 if t_eval is None else len(t_eval)
        run.max_steps, run.max_events = options.max_steps, options.max_events
        run.t, run.t_end = problem.t_span
        run.rtol, run.max_step, run.bound = options.rtol, options.max_step, options.bound
        run.energy0 = problem.energy0
        self.point("x0", problem.x0)
        self.point("parameters", problem.parameters)
        self.point(
            "atol",
            np.full(n, options.atol)
            if np.ndim(options.atol) == 0
            else np.ascontiguousarray(options.atol, dtype=float),
        )
        self.point("weights", problem.weights_or_zero())
        self.point("knots", knots)
        self.point("values", values)
        self.point("hold", linear.view(np.int8))
        if t_eval is not None:
            self.point("t_eval", t_eval if len(t_eval) else np.zeros(1))
        self.point("work", np.empty(self.driver.halfarrow_work_size(n, run.m, k)))
        self.point("flags", np.empty(self.driver.halfarrow_flag_size(k) + 1, dtype=np.int8))
        self.point("x_end", np.empty(n + 2))
        self.point("code", np.zeros(k + 1, dtype=np.int8))
        self.make_room_for_rows(4096 if t_eval is None else len(t_eval))
        self.make_room_for_events(256 if k else 0)
        self.show_modes()

    def point(self, field: str, array: np.ndarray) -> None:
        """Let a field of the struct point to an array, and keep that alive."""
        self.kept[field] = array
        setattr(self.run, field, array.ctypes.data)

    def make_room_for_rows(self, capacity: int) -> None:
        """Rows for the driver to fill, those filled already kept."""
        rows = np.empty((capacity, self.run.n + 3))
        codes = np.empty((capacity, self.run.k), dtype=np.int8)
        if used := self.run.row_count:
            rows[:used], codes[:used] = self.kept["rows"][:used], self.kept["row_codes"][:used]
        self.point("rows", rows)
        self.point("row_codes", codes)
        self.run.row_capacity = capacity

    def make_room_for_events(self, capacity: int) -> None:
        """Events for the driver to fill, those filled already kept."""
        events = np.empty((capacity, self.run.n + 3))
        codes = np.empty((capacity, 3), dtype=np.int64)
        if used := self.run.event_count:
            events[:used], codes[:used] = (
                self.kept["events"][:used],
                self.kept["event_codes"][:used],
            )
        self.point("events", events)
        self.point("event_codes", codes)
        self.run.event_capacity = capacity

    def show_modes(self) -> None:
        """Tell the driver all modes loaded so far."""
        loaded = self.table.loaded()
        modes = (_Mode * len(loaded))()
        for mode, (mask, loaded_mode) in zip(modes, loaded.items(), strict=True):
            mode.stuck = mask
            for name, address in loaded_mode.functions.items():
                setattr(mode, name, address)
        self.kept["modes"] = modes, list(loaded.values())
        self.run.modes, self.run.n_modes = ctypes.addressof(modes), len(modes)
        iw, w = (max(column) for column in zip(*(f.sizes for f in loaded.values()), strict=True))
        self.point("iw", np.empty(iw + 1, dtype=np.int64))
        self.point("w", np.empty(w + 1))

    def to_the_end(self, time_budget: float) -> Outcome:
        """Advance, serving what the driver asks for, until it has an outcome."""
        deadline = time.monotonic() + time_budget
        advance, run, address = (
            self.driver.halfarrow_advance,
            self.run,
            ctypes.addressof(self.memory),
        )
        while True:
            left = deadline - time.monotonic()
            if left <= 0:
                return Outcome.TIME_BUDGET
            run.slice = min(LONGEST_PAUSE, left)
            status = advance(address)
            if status >= _FIRST_OUTCOME:
                return _OUTCOMES[status - _FIRST_OUTCOME]
            if status == _NEED_MODE:
                self.table.machine_code(run.wanted)
                self.show_modes()
            elif status == _ROWS_FULL:
                self.make_room_for_rows(2 * run.row_capacity)
            elif status == _EVENTS_FULL:
                self.make_room_for_events(2 * run.event_capacity + run.k)
