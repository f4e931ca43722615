"""The modes of a model: their functions, and their machine code, made when first met."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..errors import SimulationError
from .compiler import CompileError, NativeMode, load_driver, load_mode

if TYPE_CHECKING:
    import ctypes

    import casadi as ca

log = logging.getLogger(__name__)

MAX_SWITCHES = 63


@dataclass(frozen=True, eq=False)
class ModeFunctions:
    """The functions of one structural mode, that is of one set of stuck switches.

    Parameters
    ----------
    rhs : casadi.Function or callable
        (t, x, u, p, s) -> n + 2 numbers: dx/dt, supplied and dissipated power. `s` holds k codes:
        0 stick, +1 and -1 slip.
    guard : casadi.Function or callable, optional
        (t, x, u, p, s) -> 2k numbers, g and a. A slipping switch has g = s v and a = v, its slip; a
        stuck one g = breakaway - abs(a) and a = the effort that holds it. An event is g falling
        below 0. Only a model without switches may leave it out.
    """

    rhs: Any
    guard: Any = None


class ModeTable:
    """The modes of one model, made when first met and kept for all its runs.

    Parameters are inputs of the functions, so one table serves every parameter set, and several
    threads at once.

    Parameters
    ----------
    n, m, k : int
        Numbers of states, inputs and switches.
    provider : callable
        mask -> `ModeFunctions`; bit j of the mask says that switch j is stuck.

    Attributes
    ----------
    refusal : str or None
        Why the model cannot run as compiled C, once that was tried.
    """

    def __init__(self, n: int, m: int, k: int, provider: Callable[[int], ModeFunctions]) -> None:
        if k > MAX_SWITCHES:
            raise SimulationError(f"{k} switches are more than the {MAX_SWITCHES} supported")
        self.n, self.m, self.k = n, m, k
        self._provider = provider
        self._functions: dict[int, ModeFunctions] = {}
        self._native: dict[int, NativeMode] = {}
        self._driver: ctypes.CDLL | None = None
        self.refusal: str | None = None
        self._lock = threading.RLock()

    def functions(self, mask: int) -> ModeFunctions:
        """The mode in which the switches of the mask's bits are stuck."""
        with self._lock:
            if mask not in self._functions:
                self._functions[mask] = self._checked(self._provider(mask), mask)
            return self._functions[mask]

    def _checked(self, mode: ModeFunctions, mask: int) -> ModeFunctions:
        if not is_casadi(mode.rhs):
            return mode
        rhs = _dense(mode.rhs, self.n + 2, f"rhs of mode {mask}")
        if not self.k:
            return ModeFunctions(rhs)
        return ModeFunctions(rhs, _dense(mode.guard, 2 * self.k, f"guard of mode {mask}"))

    def machine_code(self, mask: int) -> NativeMode:
        """The same, as compiled C; raises CompileError."""
        with self._lock:
            if mask not in self._native:
                mode = self.functions(mask)
                self._native[mask] = load_mode(mode.rhs, mode.guard, (self.n, self.m, self.k))
            return self._native[mask]

    def driver(self) -> ctypes.CDLL:
        """The compiled integrator; raises CompileError."""
        with self._lock:
            if self._driver is None:
                self._driver = load_driver()
            return self._driver

    def loaded(self) -> dict[int, NativeMode]:
        """The compiled modes so far."""
        with self._lock:
            return dict(self._native)

    def compiled(self) -> bool:
        """Whether the model can run as compiled C; says once why where it cannot."""
        with self._lock:
            if self.refusal is None and not self._native:
                try:
                    if not is_casadi(self.functions(0).rhs):
                        raise CompileError("the model is given as Python functions")
                    self.driver()
                    self.machine_code(0)
                except CompileError as failure:
                    self.refusal = str(failure)
                    log.warning("simulating without compiled code, slower: %s", failure)
            return self.refusal is None


def is_casadi(function: Any) -> bool:
    """Whether a function is CasADi's, not a plain Python one."""
    return hasattr(function, "sz_arg")


def _dense(function: ca.Function, size: int, what: str) -> ca.Function:
    """The function with all its arguments and its result full, checked for its size."""
    import casadi as ca

    if function.n_in() != 5 or function.n_out() != 1 or function.numel_out(0) != size:
        raise SimulationError(f"the {what} must take (t, x, u, p, s) and give {size} numbers")
    if function.nnz_out(0) == size:
        return function
    arguments = [ca.MX.sym(name, function.numel_in(i)) for i, name in enumerate("txups")]
    return ca.Function(function.name(), arguments, [ca.densify(function(*arguments))])
