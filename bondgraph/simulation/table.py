"""The modes of a model: their functions, and their machine code, made when first met."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..errors import SimulationError
from .native import (
    Build,
    CompileError,
    NativeMode,
    Wanted,
    driver_wanted,
    load_driver,
    load_mode,
    mode_wanted,
)

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
        self._builds: dict[int | None, tuple[Wanted, Build]] = {}
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
        """The same, as compiled C; waits for the compiler, raises CompileError."""
        with self._lock:
            if mask not in self._native:
                self._native[mask] = self._load(mask, self._wanted(mask).load())
            return self._native[mask]

    def driver(self) -> ctypes.CDLL:
        """The compiled integrator; waits for the compiler, raises CompileError."""
        with self._lock:
            if self._driver is None:
                self._driver = load_driver()
            return self._driver

    def loaded(self) -> dict[int, NativeMode]:
        """The compiled modes so far."""
        with self._lock:
            return dict(self._native)

    def at_hand(self, mask: int) -> bool:
        """Whether a mode and the integrator are there as compiled C; never waits.

        What is not in the cache is compiled behind from now on.
        """
        with self._lock:
            if self.refusal is not None:
                return False
            if mask in self._native and self._driver is not None:
                return True
            try:
                if mask not in self._native:
                    self._begin(mask)
                if self._driver is None:
                    self._begin(None)
            except CompileError as failure:
                self._refuse(failure)
            return mask in self._native and self._driver is not None

    def _begin(self, mask: int | None) -> None:
        """Load a mode, or the integrator, from the cache, or see how far the compiler is with it."""
        what = "the integrator" if mask is None else f"mode {mask} of {self.n} states"
        if mask in self._builds and not self._builds[mask][1].mine():
            del self._builds[mask]
        if mask in self._builds:
            wanted, build = self._builds[mask]
            if not build.finished():
                return
            del self._builds[mask]
            library = wanted.made(build)
            log.info("%s is compiled, after %.1f s", what, build.age())
        else:
            wanted = driver_wanted() if mask is None else self._wanted(mask)
            kept = wanted.kept()
            if kept is None:
                self._builds[mask] = wanted, wanted.behind()
                log.info("%s is compiled behind; runs are on the virtual machine till then", what)
                return
            library = kept
        if mask is None:
            self._driver = load_driver(library)
        else:
            self._native[mask] = self._load(mask, library)

    def _wanted(self, mask: int) -> Wanted:
        mode = self.functions(mask)
        if not is_casadi(mode.rhs):
            raise CompileError("the model is given as Python functions")
        return mode_wanted(mode.rhs, mode.guard, (self.n, self.m, self.k))

    def _load(self, mask: int, library: ctypes.CDLL) -> NativeMode:
        mode = self.functions(mask)
        return load_mode(mode.rhs, mode.guard, (self.n, self.m, self.k), library)

    def compiled(self) -> bool:
        """Whether the model can run as compiled C, waited for; says once why where it cannot."""
        with self._lock:
            if self.refusal is None and not (self._native and self._driver):
                try:
                    self.machine_code(0)
                    self.driver()
                except CompileError as failure:
                    self._refuse(failure)
            return self.refusal is None

    def compile(self, masks: Iterable[int]) -> bool:
        """Compile modes and the integrator, all at once, and wait; False where that cannot be."""
        wanted = list(masks)
        for mask in wanted:
            self.at_hand(mask)
        if self.compiled():
            for mask in wanted:
                self.machine_code(mask)
        return self.refusal is None

    def _refuse(self, failure: CompileError) -> None:
        self.refusal = str(failure)
        log.warning("simulating without compiled code, slower: %s", failure)


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
