"""Derivatives of a model's modes: Jacobians of the rates and of the guards, as sparse entries.

They are made when a run first meets a mode and kept for all runs: parameters are arguments, and
which of them are asked for is not built in.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from importlib import resources
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy

from ...errors import SimulationError
from ..buffered import evaluator
from ..native.compiler import LARGE_FLAGS, LARGE_SOURCE, load_shared
from ..table import ModeTable, is_casadi

if TYPE_CHECKING:
    import ctypes

    import casadi

Array = numpy.ndarray

# Unlike the driver's models these are followed by loops over columns, which gcc makes vectors of.
FLAGS, LARGEST_FAST = ("-O3",), 200_000
HUGE_FLAGS = ("-O0",)


@dataclass(frozen=True, eq=False)
class Entries:
    """Where the entries of a sparse matrix stand.

    Attributes
    ----------
    rows, columns : (e,) arrays of int
        A column is a state's index, or n and more for a parameter's.
    """

    rows: Array
    columns: Array

    def active(self, n: int, moved: Array) -> Array:
        """Return entry, row and column of those that count, row by row, shape (e, 3).

        Parameters
        ----------
        n : int
            Number of states.
        moved : (np,) array of bool
            Whether a parameter depends on anything asked for.
        """
        counts = numpy.concatenate([numpy.ones(n, dtype=bool), moved])[self.columns]
        index = numpy.flatnonzero(counts)
        index = index[numpy.argsort(self.rows[index], kind="stable")]
        return numpy.stack([index, self.rows[index], self.columns[index]], axis=1)


@dataclass(frozen=True, eq=False)
class ModeTangent:
    """Derivatives of one mode.

    Attributes
    ----------
    rates : casadi.Function
        ``(t, x, u, p, s)`` to dx/dt (n,), then the entries of its Jacobian by (x, p).
    rates_entries : Entries
    surface : casadi.Function or None
        ``(t, x, (u, dx/dt, du/dt), p, s)`` to the guards g (k,), their rates
        along the motion (k,), the sizes of the terms in each rate (k,) and in each
        guard (k,), then the entries of the Jacobian of g by (x, p).
    surface_entries : Entries or None
    """

    rates: Any
    rates_entries: Entries
    surface: Any = None
    surface_entries: Entries | None = None


class NativeTangent(NamedTuple):
    """One mode's derivatives in memory: addresses of the functions, and their work sizes."""

    rates: int
    surface: int
    sizes: tuple[int, int]
    library: ctypes.CDLL


class TangentTable:
    """The derivatives of the modes of one model.

    Parameters
    ----------
    modes : ModeTable

    Attributes
    ----------
    n, m, k, np : int
        Numbers of states, inputs, switches and parameters.

    Examples
    --------
    >>> from bondgraph import C, One, R, assemble, CompiledModel
    >>> loop = One("loop")
    >>> model = CompiledModel(assemble("rc", loop >> (R("r", 2), C("c", 5))))
    >>> table = TangentTable(model.modes)
    >>> [float(v) for v in table.calls(0)[0](0.0, [20.0], [], [], [])]  # the rate, its slope by q
    [-2.0, -0.1]
    """

    def __init__(self, modes: ModeTable) -> None:
        self.n, self.m, self.k = modes.n, modes.m, modes.k
        first = modes.functions(0).rhs
        if not is_casadi(first):
            raise SimulationError("sensitivities need a model of CasADi functions")
        self.np = int(first.numel_in(3))
        self._modes = modes
        self._made: dict[int, ModeTangent] = {}
        self._native: dict[int, NativeTangent] = {}
        self._replay: ctypes.CDLL | None = None
        self._lock = threading.RLock()

    def mode(self, mask: int) -> ModeTangent:
        """Return the derivatives of the mode in which the switches of the mask's bits are held."""
        with self._lock:
            if mask not in self._made:
                self._made[mask] = _differentiated(self._modes, mask)
            return self._made[mask]

    def calls(self, mask: int) -> tuple[Callable[..., Array], Callable[..., Array]]:
        """Return rates and surface of a mode as plain functions, for one thread."""
        mode = self.mode(mask)
        return evaluator(mode.rates), evaluator(mode.surface)

    def machine_code(self, mask: int) -> NativeTangent:
        """Return them as compiled C; raises CompileError."""
        with self._lock:
            if mask not in self._native:
                self._native[mask] = _compiled(self.mode(mask))
            return self._native[mask]

    def replay(self) -> ctypes.CDLL:
        """Return the compiled ``replay.c``; raises CompileError."""
        with self._lock:
            if self._replay is None:
                self._replay = _load_replay()
            return self._replay

    def loaded(self) -> dict[int, NativeTangent]:
        """Return the compiled modes so far."""
        with self._lock:
            return dict(self._native)


def _differentiated(modes: ModeTable, mask: int) -> ModeTangent:
    import casadi

    mode = modes.functions(mask)
    given = [casadi.SX.sym(label, mode.rhs.numel_in(i)) for i, label in enumerate("txups")]
    guards = mode.guard(*given)[: modes.k] if modes.k else None
    return tangent_of(given, mode.rhs(*given)[: modes.n], guards)


def tangent_of(
    given: list[casadi.SX], rates: casadi.SX, guards: casadi.SX | None, held: Any = None
) -> ModeTangent:
    """Differentiate rates and guards.

    Parameters
    ----------
    given : list of casadi.SX
        ``t, x, u, p, s``, and z where there are algebraic variables.
    rates, guards : casadi.SX
        Shapes (n,) and (k,).
    held : casadi.SX, optional
        The residuals that z makes zero.
    """
    import casadi

    t, x, u, p, *rest = given
    place = casadi.vertcat(x, p, u, t)
    follows = None
    if held is not None and held.numel():
        z = rest[1]
        inner, outer = casadi.jacobian(held, z), casadi.jacobian(held, place)
        follows = -casadi.solve(casadi.densify(inner), casadi.densify(outer))

    def total(results: casadi.SX) -> casadi.SX:
        direct = casadi.jacobian(results, place)
        return direct if follows is None else direct + casadi.jacobian(results, rest[1]) @ follows

    count = x.numel() + p.numel()
    slopes, entries = _sparse(total(rates)[:, :count])
    function = casadi.Function("rates", given, [casadi.densify(casadi.vertcat(rates, slopes))])
    if guards is None:
        return ModeTangent(function, entries)
    moves = casadi.SX.sym("d", x.numel() + u.numel())
    by = total(guards)
    slope = casadi.horzcat(by[:, : x.numel()], by[:, count : count + u.numel()])
    in_time = by[:, -1]
    rate = slope @ moves + in_time
    size = casadi.fabs(slope) @ casadi.fabs(moves) + casadi.fabs(in_time)
    extent = casadi.fabs(by[:, : x.numel()]) @ casadi.fabs(x)
    parts, where = _sparse(by[:, :count])
    surface = casadi.Function(
        "surface",
        [t, x, casadi.vertcat(u, moves), p, *rest],
        [casadi.densify(casadi.vertcat(guards, rate, size, extent, parts))],
    )
    return ModeTangent(function, entries, surface, where)


def _sparse(matrix: casadi.SX) -> tuple[casadi.SX, Entries]:
    import casadi

    rows, columns = matrix.sparsity().get_triplet()
    entries = Entries(numpy.array(rows, dtype=numpy.int64), numpy.array(columns, dtype=numpy.int64))
    values = matrix.nonzeros()
    return casadi.vertcat(*values) if values else casadi.SX(0, 1), entries


def _compiled(mode: ModeTangent) -> NativeTangent:
    import ctypes

    import casadi

    generator = casadi.CodeGenerator("tangent", {"with_header": False})
    functions = {"RATES": mode.rates, "SURFACE": mode.surface}
    functions = {role: function for role, function in functions.items() if function is not None}
    macros = []
    for role, function in functions.items():
        generator.add(function)
        name = function.name()
        macros += [
            f"#define {role} {name}\n",
            f"#define {role}_CHECKOUT {name}_checkout\n#define {role}_RELEASE {name}_release\n",
            f"#define {role}_ARG {function.sz_arg()}\n#define {role}_RES {function.sz_res()}\n",
        ]
    model = generator.dump()
    source = (
        "#define CASADI_SYMBOL_EXPORT static inline __attribute__((unused))\n",
        model,
        *macros,
        resources.files(__package__).joinpath("tangent.c").read_text(encoding="utf-8"),
    )
    fast = FLAGS if len(model) < LARGEST_FAST else LARGE_FLAGS
    library = load_shared(
        "".join(source), "tangent", fast if len(model) < LARGE_SOURCE else HUGE_FLAGS
    )

    def address(name: str) -> int:
        return ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0

    iw, w = (
        max(column)
        for column in zip(*((f.sz_iw(), f.sz_w()) for f in functions.values()), strict=True)
    )
    surface = address("tangent_surface") if mode.surface is not None else 0
    return NativeTangent(address("tangent_rates"), surface, (iw, w), library)


def _load_replay() -> ctypes.CDLL:
    """Return the compiled ``replay.c``; raises CompileError."""
    import ctypes

    source = resources.files(__package__).joinpath("replay.c").read_text(encoding="utf-8")
    library = load_shared(source, "replay", ("-O3",))
    for name, arguments, result in (
        ("replay_advance", [ctypes.c_void_p], ctypes.c_longlong),
        ("replay_lay_out", [ctypes.c_void_p], None),
        ("replay_work_size", [ctypes.c_longlong] * 5, ctypes.c_longlong),
        ("replay_struct_size", [], ctypes.c_longlong),
    ):
        function = getattr(library, name)
        function.argtypes, function.restype = arguments, result
    return library
