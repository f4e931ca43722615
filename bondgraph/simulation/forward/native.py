"""Running ``replay.c``: its memory laid out by ctypes, and the services it asks for."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from typing import Any

import numpy

from ..inputs import InputTable
from .tangents import TangentTable
from .value import AMBIGUOUS, GRAZING, NON_FINITE, Array, Projection, Replayed, Travelled, Undefined

STEPS_AT_ONCE = 4096  # between two looks at the clock and at Ctrl-C
_CONTINUE, _DONE, _NEED_MODE, _PAUSED, _PROJECT, _GRAZING, _AMBIGUOUS, _NON_FINITE = range(8)
_WHY = {_GRAZING: GRAZING, _AMBIGUOUS: AMBIGUOUS, _NON_FINITE: NON_FINITE}


def _fields(kind: Any, names: str) -> list[tuple[str, Any]]:
    return [(name, kind) for name in names.split()]


class _Mode(ctypes.Structure):
    """`Mode` of replay.c."""

    _fields_ = (
        ("stuck", ctypes.c_ulonglong),
        *_fields(ctypes.c_void_p, "rates surface"),
        *_fields(ctypes.c_longlong, "rates_count surface_count"),
        *_fields(ctypes.c_void_p, "rates_entries surface_entries"),
    )


class _Replay(ctypes.Structure):
    """The public part of `Replay` of replay.c."""

    _fields_ = (
        *_fields(ctypes.c_longlong, "n np q m k n_knots n_steps n_eval n_modes own_rows"),
        ("noise", ctypes.c_double),
        *_fields(
            ctypes.c_void_p, "parameters seeds record knots values shapes t_eval events jumps modes"
        ),
        *_fields(ctypes.c_void_p, "iw w state codes rows event_rows work"),
        *_fields(ctypes.c_longlong, "until step events_done row_count culprit"),
        ("wanted", ctypes.c_ulonglong),
        *_fields(ctypes.c_longlong, "phase knot"),
    )


class NativeReplay:
    """One replay by replay.c.

    Parameters
    ----------
    table : TangentTable
    travelled : Travelled
        With inputs from a table.
    project : callable
        See `bondgraph.simulation.forward.project.Projector`.
    """

    def __init__(self, table: TangentTable, travelled: Travelled, project: Projection) -> None:
        self.table, self.travelled, self.project = table, travelled, project
        self.library = table.replay()
        self.memory = ctypes.create_string_buffer(self.library.replay_struct_size())
        self.run = run = _Replay.from_buffer(self.memory)
        self.kept: dict[str, Any] = {}
        inputs, q, n = travelled.inputs, travelled.seeds.shape[1], table.n
        assert isinstance(inputs, InputTable)
        run.n, run.np, run.q, run.m, run.k = n, table.np, q, table.m, table.k
        run.n_steps, run.n_knots = len(travelled.record) - 1, len(inputs.knots)
        run.noise, run.knot = travelled.noise, -1
        run.own_rows = travelled.t_eval is None
        run.n_eval = 0 if travelled.t_eval is None else len(travelled.t_eval)
        state = numpy.concatenate([travelled.record[0, 3:], travelled.start.ravel()])
        for name, array in (
            ("parameters", travelled.parameters),
            ("seeds", travelled.seeds),
            ("record", travelled.record),
            ("knots", inputs.knots),
            ("values", inputs.values),
            ("shapes", inputs.shapes),
            ("t_eval", numpy.zeros(0) if travelled.t_eval is None else travelled.t_eval),
            ("state", state),
            ("codes", numpy.append(travelled.codes, 0.0)),
            ("rows", numpy.empty((travelled.rows, n, q))),
            ("event_rows", numpy.zeros((len(travelled.events), q))),
        ):
            self.point(name, numpy.ascontiguousarray(array, dtype=float))
        self.point("events", numpy.ascontiguousarray(travelled.events, dtype=numpy.int64))
        self.point("jumps", inputs.jumps)
        self.moved = numpy.any(travelled.seeds != 0, axis=1)
        self.lists: dict[int, tuple[Array, Array]] = {}
        self.show_modes()

    def point(self, field: str, array: Array) -> None:
        """Let a field of the struct point to an array, and keep that alive."""
        self.kept[field] = array
        setattr(self.run, field, array.ctypes.data)

    def show_modes(self) -> None:
        """Tell replay.c all modes compiled so far, and give it room for them."""
        loaded, run = self.table.loaded(), self.run
        modes = (_Mode * max(len(loaded), 1))()
        iw = w = entries = 0
        for mode, (mask, native) in zip(modes, loaded.items(), strict=False):
            mode.stuck, mode.rates, mode.surface = mask, native.rates, native.surface
            rates, surface = self.entries(mask)
            mode.rates_entries, mode.rates_count = rates.ctypes.data, len(rates)
            mode.surface_entries, mode.surface_count = surface.ctypes.data, len(surface)
            iw, w = max(iw, native.sizes[0]), max(w, native.sizes[1])
            made = self.table.mode(mask)
            wide = len(made.surface_entries.rows) if made.surface_entries else 0
            entries = max(entries, len(made.rates_entries.rows), wide)
        self.kept["modes"], self.kept["loaded"] = modes, list(loaded.values())
        run.modes, run.n_modes = ctypes.addressof(modes), len(loaded)
        self.point("iw", numpy.empty(iw + 1, dtype=numpy.int64))
        self.point("w", numpy.empty(w + 1))
        size = self.library.replay_work_size(run.n, run.q, run.m, run.k, entries)
        work, old = numpy.empty(size), self.kept.get("work")
        if old is not None:
            slopes = run.n * (1 + run.q) * 7  # all that lasts from one turn to the next
            work[:slopes] = old[:slopes]
        self.point("work", work)
        self.library.replay_lay_out(ctypes.addressof(self.memory))

    def entries(self, mask: int) -> tuple[Array, Array]:
        """Return the entries of a mode that count in this replay."""
        if mask not in self.lists:
            mode = self.table.mode(mask)
            none = numpy.zeros((0, 3), dtype=numpy.int64)
            where = mode.surface_entries
            self.lists[mask] = (
                numpy.ascontiguousarray(mode.rates_entries.active(self.run.n, self.moved)),
                numpy.ascontiguousarray(where.active(self.run.n, self.moved)) if where else none,
            )
        return self.lists[mask]

    def to_the_end(self, deadline: float, too_late: Callable[[], Exception]) -> Replayed:
        """Advance, serving what replay.c asks for.

        Parameters
        ----------
        deadline : float
            On the monotonic clock.
        too_late : callable
            To what is raised past it.

        Raises
        ------
        Undefined
        CompileError
        """
        run, kept, n = self.run, self.kept, self.run.n
        address = ctypes.addressof(self.memory)
        while True:
            run.until = run.step + STEPS_AT_ONCE
            status = self.library.replay_advance(address)
            if status == _DONE:
                break
            if time.monotonic() > deadline:
                raise too_late()
            if status == _NEED_MODE:
                self.table.machine_code(run.wanted)
                self.show_modes()
            elif status == _PROJECT:
                here = self.travelled.record[run.step]
                codes = kept["codes"][: run.k]
                S = kept["state"][n:].reshape(n, run.q)
                S[:] = self.project(float(here[0]), here[3:], codes, S, self.travelled.seeds)
            elif status in _WHY:
                t = float(self.travelled.record[run.step, 0])
                raise Undefined(_WHY[status], t, int(run.culprit))
        rows = kept["rows"]
        if run.row_count != len(rows):  # a run stopped in the middle of a step
            raise too_late()
        return Replayed(rows, kept["state"][n:].reshape(n, run.q).copy(), kept["event_rows"])
