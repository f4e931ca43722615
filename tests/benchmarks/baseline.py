"""The hand-written C automaton, compiled on first use and called through ctypes.

The library lies in the user's cache (``$XDG_CACHE_HOME/halfarrow/benchmarks``), keyed by source,
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
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

SOURCE = Path(__file__).with_name("brake_automaton.c")
FLAGS = ("-O2", "-march=native", "-shared", "-fPIC", "-DNO_MAIN")
NAMES = (
    *("k_f", "k_w", "f_f", "f_w", "r_r", "r_t", "zeta_f", "zeta_w"),
    *("V0", "mu_s", "mu_k", "v_s", "F_k", "tau"),
)
MODES = {0: "stick", 1: "slip+", -1: "slip-"}
MAX_EVENTS = 4096

_FAILURES = {-1: "ran out of steps", -2: "step underflow", -3: "not finite"}
_Pointer = ctypes.POINTER(ctypes.c_double)


class BaselineUnavailable(RuntimeError):
    """No C compiler, or it failed."""


@dataclass(frozen=True)
class AutomatonRun:
    """A run of the automaton.

    Attributes
    ----------
    t : (n,) array, s
    states : (n, 4) array, ordered omega_r, V_c, theta_w, x_c
    pad_force : (n,) array, N
    events : (time in s, mode entered) in order
    energies : road, bt, bf, friction in J
    """

    t: NDArray[np.float64]
    states: NDArray[np.float64]
    pad_force: NDArray[np.float64]
    events: tuple[tuple[float, str], ...]
    energies: tuple[float, float, float, float]

    @property
    def stick_times(self) -> list[float]:
        """Times at which rotor and pads stick, s."""
        return [t for t, mode in self.events if mode == "stick"]


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


@functools.cache
def automaton() -> ctypes.CDLL:
    """Compile the automaton if needed and load it.

    Raises
    ------
    BaselineUnavailable
        if there is no working C compiler
    """
    compiler = _compiler()
    key = "\0".join([compiler, *FLAGS, platform.machine(), _processor(), SOURCE.read_text("utf-8")])
    path = _cache() / f"brake-{hashlib.sha256(key.encode()).hexdigest()[:16]}.so"
    if not path.exists():
        part = path.with_name(f"{path.name}.{os.getpid()}")
        command = [compiler, *FLAGS, "-o", str(part), str(SOURCE), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise BaselineUnavailable(f"{' '.join(command)}: {done.stderr.strip()}")
        # a rename is atomic: two benchmarks started together both find a whole library
        part.replace(path)
    loaded = ctypes.CDLL(str(path))
    n, x = ctypes.c_int, ctypes.c_double
    loaded.brake_run.argtypes = [_Pointer, x, x, n, _Pointer, _Pointer, n]
    loaded.brake_run_full.argtypes = [
        _Pointer, _Pointer, x, x, x, n, _Pointer, _Pointer, n, _Pointer
    ]  # fmt: skip
    loaded.brake_run.restype = loaded.brake_run_full.restype = n
    return loaded


def _vector(values: Sequence[float]) -> ctypes.Array[ctypes.c_double]:
    return (ctypes.c_double * len(values))(*values)


def prepare(
    parameters: Mapping[str, float], t_end: float, rtol: float, n_out: int
) -> Callable[[], int]:
    """Make a repeatable run, for timing: states at `n_out` equal times, no energies.

    Returns
    -------
    call : runs the automaton into the same buffers each time and returns the number of events
    """
    out, events = np.empty((n_out, 5)), np.empty((MAX_EVENTS, 2))
    arguments = (
        _vector([parameters[name] for name in NAMES]),
        ctypes.c_double(t_end),
        ctypes.c_double(rtol),
        n_out,
        out.ctypes.data_as(_Pointer),
        events.ctypes.data_as(_Pointer),
        MAX_EVENTS,
    )
    function = automaton().brake_run
    # the arrays must outlive the pointers into them
    return lambda _kept=(out, events): int(function(*arguments))  # type: ignore[misc]


def run(
    parameters: Mapping[str, float],
    t_end: float,
    *,
    rtol: float = 1e-6,
    n_out: int = 5001,
    start: Sequence[float] | None = None,
) -> AutomatonRun:
    """Run the automaton once.

    Parameters
    ----------
    parameters : the fourteen of `NAMES`, SI units
    t_end : length of the run, s
    rtol : relative tolerance; the absolute one is a thousandth of it
    n_out : number of equal times from 0 to `t_end`
    start : omega_r, V_c, theta_w, x_c at t = 0; steady rolling if not given

    Raises
    ------
    BaselineUnavailable
        if there is no working C compiler
    RuntimeError
        if the automaton gives up
    """
    out, events, energies = np.empty((n_out, 5)), np.empty((MAX_EVENTS, 2)), np.empty(4)
    count = automaton().brake_run_full(
        _vector([parameters[name] for name in NAMES]),
        None if start is None else _vector(start),
        t_end,
        rtol,
        1e-3 * rtol,
        n_out,
        out.ctypes.data_as(_Pointer),
        events.ctypes.data_as(_Pointer),
        MAX_EVENTS,
        energies.ctypes.data_as(_Pointer),
    )
    if count < 0:
        raise RuntimeError(f"brake automaton: {_FAILURES[count]}")
    road, bt, bf, friction = energies.tolist()
    return AutomatonRun(
        t=np.linspace(0, t_end, n_out),
        states=out[:, :4],
        pad_force=out[:, 4],
        events=tuple((float(t), MODES[int(mode)]) for t, mode in events[: min(count, MAX_EVENTS)]),
        energies=(road, bt, bf, friction),
    )
