"""Running ``driver.c``: its memory laid out by ctypes, and the services it asks for."""

from __future__ import annotations

import ctypes
import math
import time
from typing import Any

import numpy as np

from ..outcome import Outcome
from ..problem import Options, Problem
from .compiler import KERNEL

LINE = 128  # bytes; processors fetch cache lines of 64 in pairs
LONGEST_PAUSE = 0.05  # s between two looks at the clock and at Ctrl-C


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
        *_fields(
            ctypes.c_void_p, "x0 parameters atol weights knots values shapes t_eval jumps modes"
        ),
        *_fields(ctypes.c_void_p, "iw w rows row_codes events event_codes x_end code"),
        *_fields(ctypes.c_void_p, "work flags"),
        *_fields(ctypes.c_double, "t"),
        *_fields(ctypes.c_longlong, "row_count event_count steps rejected evaluations"),
        *_fields(ctypes.c_ulonglong, "wanted"),
        *_fields(ctypes.c_longlong, "record_count record_capacity"),
        *_fields(ctypes.c_void_p, "record"),
    )


# What halfarrow_advance returns, in the order of driver.c.
BATCH_DONE, _NEED_MODE, _ROWS_FULL, _EVENTS_FULL, PAUSED = range(5)
OUTCOMES = dict(
    enumerate(
        (
            Outcome.FINISHED,
            Outcome.EVENT_LIMIT,
            Outcome.CHATTERING,
            Outcome.STEP_UNDERFLOW,
            Outcome.STEP_LIMIT,
            Outcome.NON_FINITE,
            Outcome.DIVERGED,
        ),
        start=5,
    )
)


class NotYet(Exception):  # an answer to `hybrid`, not an error
    """A mode without machine code was met, and the run is young."""


def apart(count: int, kind: Any = np.float64) -> np.ndarray:
    """Zeros that share no cache line with other memory, for what a run writes at every step.

    Two runs in two threads whose small arrays lie side by side would slow each other down.

    Examples
    --------
    >>> apart(3).tolist()
    [0.0, 0.0, 0.0]
    """
    size = count * np.dtype(kind).itemsize
    room = np.zeros(size + 2 * LINE, dtype=np.int8)
    start = -room.ctypes.data % LINE
    return room[start : start + size].view(kind)


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
        self.memory = apart(self.driver.halfarrow_run_size(), np.int8)
        self.run = run = _Run.from_buffer(self.memory.data)
        self.address = self.memory.ctypes.data
        self.kept: dict[str, Any] = {}
        _, knots, values, shapes, jumps = problem.input_table()
        t_eval = options.t_eval
        run.n, run.m, run.k, run.n_knots = n, problem.modes.m, k, len(knots)
        run.n_eval = 0 if t_eval is None else len(t_eval)
        run.max_steps, run.max_events = options.max_steps, options.max_events
        run.t, run.t_end = problem.t_span
        run.rtol, run.max_step, run.bound = options.rtol, options.max_step, options.bound
        run.energy0, run.slice = problem.energy0, LONGEST_PAUSE
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
        self.point("shapes", shapes)
        self.point("jumps", jumps)
        if t_eval is not None:
            self.point("t_eval", t_eval if len(t_eval) else np.zeros(1))
        self.point("work", apart(self.driver.halfarrow_work_size(n, run.m, k)))
        self.point("flags", apart(self.driver.halfarrow_flag_size(k) + 1, np.int8))
        self.point("x_end", np.append(problem.x0, [0.0, 0.0]))
        self.point("code", apart(k + 1, np.int8))
        self.make_room_for_rows(4096 if t_eval is None else len(t_eval))
        self.make_room_for_events(256 if k else 0)
        if options.record:
            self.make_room_for_record(1024)
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

    def make_room_for_record(self, capacity: int) -> None:
        """Steps for the driver to note, those noted already kept."""
        record = np.empty((capacity, self.run.n + 3))
        if used := self.run.record_count:
            record[:used] = self.kept["record"][:used]
        self.point("record", record)
        self.run.record_capacity = capacity

    def make_room(self) -> None:
        """Make room for rows or for the record of steps, whichever is full."""
        run = self.run
        if run.record and run.record_count >= run.record_capacity:
            self.make_room_for_record(2 * run.record_capacity)
        else:
            self.make_room_for_rows(2 * run.row_capacity)

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
        self.point("iw", apart(iw + 1, np.int64))
        self.point("w", apart(w + 1))

    def to_the_end(self, time_budget: float, patience: float = math.inf) -> Outcome:
        """Advance, serving what the driver asks for, until it has an outcome.

        Where a mode has no machine code, a run that has taken more than `patience` seconds, or
        may wait without end, waits for the compiler; a shorter one ends in `NotYet`.
        """
        began = time.monotonic()
        deadline = began + time_budget
        advance, run, address = self.driver.halfarrow_advance, self.run, self.address
        while True:
            left = deadline - time.monotonic()
            if left <= 0:
                return Outcome.TIME_BUDGET
            run.slice = min(LONGEST_PAUSE, left)
            status = advance(address)
            if status in OUTCOMES:
                return OUTCOMES[status]
            young = time.monotonic() - began < patience < math.inf
            if status == _NEED_MODE and young and not self.table.at_hand(run.wanted):
                raise NotYet
            self.serve(status)

    def serve(self, status: int) -> None:
        """Give the driver what it asks for."""
        run = self.run
        if status == _NEED_MODE:
            self.table.machine_code(run.wanted)
            self.show_modes()
        elif status == _ROWS_FULL:
            self.make_room()
        elif status == _EVENTS_FULL:
            self.make_room_for_events(2 * run.event_capacity + run.k)
