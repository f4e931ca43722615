"""CasADi function -> the same on arrays: each instruction once for all points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi
import numpy

from .program import ProgramError

Value = Any  # numpy.float64 or an array; what is the same for all points stays a single number

_UNARY: dict[int, Callable[[Value], Value]] = {
    casadi.OP_ASSIGN: lambda x: x,
    casadi.OP_NEG: numpy.negative,
    casadi.OP_EXP: numpy.exp,
    casadi.OP_LOG: numpy.log,
    casadi.OP_SQRT: numpy.sqrt,
    casadi.OP_SQ: numpy.square,
    casadi.OP_TWICE: lambda x: x + x,
    casadi.OP_SIN: numpy.sin,
    casadi.OP_COS: numpy.cos,
    casadi.OP_TAN: numpy.tan,
    casadi.OP_ASIN: numpy.arcsin,
    casadi.OP_ACOS: numpy.arccos,
    casadi.OP_ATAN: numpy.arctan,
    casadi.OP_SINH: numpy.sinh,
    casadi.OP_COSH: numpy.cosh,
    casadi.OP_TANH: numpy.tanh,
    casadi.OP_ASINH: numpy.arcsinh,
    casadi.OP_ACOSH: numpy.arccosh,
    casadi.OP_ATANH: numpy.arctanh,
    casadi.OP_FLOOR: numpy.floor,
    casadi.OP_CEIL: numpy.ceil,
    casadi.OP_FABS: numpy.abs,
    casadi.OP_SIGN: numpy.sign,
    casadi.OP_INV: lambda x: 1.0 / x,
    casadi.OP_LOG1P: numpy.log1p,
    casadi.OP_EXPM1: numpy.expm1,
    casadi.OP_NOT: lambda x: (x == 0) * 1.0,
}
_BINARY: dict[int, Callable[[Value, Value], Value]] = {
    casadi.OP_ADD: numpy.add,
    casadi.OP_SUB: numpy.subtract,
    casadi.OP_MUL: numpy.multiply,
    casadi.OP_DIV: numpy.divide,
    casadi.OP_POW: numpy.power,
    casadi.OP_CONSTPOW: numpy.power,
    casadi.OP_ATAN2: numpy.arctan2,
    casadi.OP_HYPOT: numpy.hypot,
    casadi.OP_FMIN: numpy.fmin,
    casadi.OP_FMAX: numpy.fmax,
    casadi.OP_FMOD: numpy.fmod,
    casadi.OP_COPYSIGN: numpy.copysign,
    casadi.OP_LT: lambda x, y: (x < y) * 1.0,
    casadi.OP_LE: lambda x, y: (x <= y) * 1.0,
    casadi.OP_EQ: lambda x, y: (x == y) * 1.0,
    casadi.OP_NE: lambda x, y: (x != y) * 1.0,
    casadi.OP_AND: lambda x, y: ((x != 0) & (y != 0)) * 1.0,
    casadi.OP_OR: lambda x, y: ((x != 0) | (y != 0)) * 1.0,
    casadi.OP_IF_ELSE_ZERO: lambda x, y: numpy.where(x != 0, y, 0.0),
}


def on_arrays(function: casadi.Function) -> Callable[..., list[list[Value]]]:
    """Turn a CasADi function of SX into one that takes a number or an array for each entry.

    Derivatives that CasADi has made are so evaluated at many points at once, each instruction
    one NumPy operation; what does not vary is worked out once.

    Parameters
    ----------
    function : casadi.Function
        Made of SX.

    Returns
    -------
    callable
        Takes, for each argument, a sequence of as many numbers or (m,) arrays as it has entries;
        returns, for each result, the list of its structural nonzeros, each a number or an array.
        Nothing is raised for what is not finite.

    Raises
    ------
    ProgramError
        For an instruction without a NumPy form.

    Examples
    --------
    >>> x = casadi.SX.sym("x", 2)
    >>> f = on_arrays(casadi.Function("f", [x], [x[0] * x[1]]))
    >>> f([numpy.array([1.0, 2.0]), 3.0])[0][0].tolist()
    [3.0, 6.0]
    """
    tape = [_instruction(function, place) for place in range(function.n_instructions())]
    sizes = [function.nnz_out(place) for place in range(function.n_out())]
    registers = function.sz_w()

    def call(*arguments: Sequence[Value]) -> list[list[Value]]:
        given = [[numpy.asarray(entry, dtype=float)[()] for entry in part] for part in arguments]
        results: list[list[Value]] = [[None] * size for size in sizes]
        work: list[Value] = [None] * registers
        with numpy.errstate(all="ignore"):
            for step in tape:
                step(given, work, results)
        return results

    return call


def _instruction(
    function: casadi.Function, place: int
) -> Callable[[list[list[Value]], list[Value], list[list[Value]]], None]:
    """Return what one instruction does with arguments, registers and results."""
    kind = function.instruction_id(place)
    into = function.instruction_output(place)
    of = function.instruction_input(place)
    if kind == casadi.OP_OUTPUT:
        return lambda given, work, results: _put(results[into[0]], into[1], work[of[0]])
    to = into[0]
    if kind == casadi.OP_INPUT:
        return lambda given, work, results: _put(work, to, given[of[0]][of[1]])
    if kind == casadi.OP_CONST:
        constant = numpy.float64(function.instruction_constant(place))
        return lambda given, work, results: _put(work, to, constant)
    if kind in _UNARY:
        one, first = _UNARY[kind], of[0]
        return lambda given, work, results: _put(work, to, one(work[first]))
    if kind in _BINARY:
        two, (left, right) = _BINARY[kind], of[:2]
        return lambda given, work, results: _put(work, to, two(work[left], work[right]))
    if kind == casadi.OP_ERF:
        from scipy.special import erf

        return lambda given, work, results: _put(work, to, erf(work[of[0]]))
    raise ProgramError(f"function {function.name()!r}: CasADi's operation {kind} has no NumPy form")


def _put(target: list[Value], place: int, value: Value) -> None:
    target[place] = value
