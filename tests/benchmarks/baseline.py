"""The hand-written C automaton, one run or a loop over many."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .native import compiled

NAMES = (
    *("k_f", "k_w", "f_f", "f_w", "r_r", "r_t", "zeta_f", "zeta_w"),
    *("V0", "mu_s", "mu_k", "v_s", "F_k", "tau"),
)
MODES = {0: "stick", 1: "slip+", -1: "slip-"}
MAX_EVENTS = 4096

_FAILURES = {-1: "ran out of steps", -2: "step underflow", -3: "not finite"}
_Pointer = ctypes.POINTER(ctypes.c_double)


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


@functools.cache
def automaton() -> ctypes.CDLL:
    """Load the automaton.

    Raises
    ------
    BaselineUnavailable
        if there is no working C compiler
    """
    loaded = compiled("brake_automaton.c")
    n, x = ctypes.c_int, ctypes.c_double
    loaded.brake_run.argtypes = [_Pointer, x, x, n, _Pointer, _Pointer, n]
    loaded.brake_run_full.argtypes = [
        _Pointer, _Pointer, x, x, x, n, _Pointer, _Pointer, n, _Pointer
    ]  # fmt: skip
    loaded.brake_sweep.argtypes = [_Pointer, n, x, x, _Pointer, ctypes.POINTER(n)]
    loaded.brake_run.restype = loaded.brake_run_full.restype = loaded.brake_sweep.restype = n
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


def sweep(
    points: Sequence[Mapping[str, float]], t_end: float, rtol: float
) -> tuple[NDArray[np.float64], NDArray[np.intc]]:
    """Run the automaton once for each point, in one loop in C.

    Returns
    -------
    final : (np, 4) array, states at `t_end`
    sticks : (np,) array of int, how often rotor and pads stuck; -1 where the automaton gave up
    """
    parameters = np.array([[point[name] for name in NAMES] for point in points])
    final, sticks = np.empty((len(points), 4)), np.empty(len(points), dtype=np.intc)
    automaton().brake_sweep(
        parameters.ctypes.data_as(_Pointer),
        len(points),
        t_end,
        rtol,
        final.ctypes.data_as(_Pointer),
        sticks.ctypes.data_as(ctypes.POINTER(ctypes.c_int)),
    )
    return final, sticks
