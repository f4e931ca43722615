"""Program -> CasADi Function.

Each sympy node becomes one SX node; shared subexpressions stay shared.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable
from typing import Any

import casadi
import sympy

from .collector import held_back
from .program import Program, ProgramError

# SX operators by sympy class; the number of arguments is what sympy gives.
FUNCTIONS: dict[Any, Callable[..., Any]] = {
    sympy.exp: casadi.exp,
    sympy.log: casadi.log,
    sympy.sin: casadi.sin,
    sympy.cos: casadi.cos,
    sympy.tan: casadi.tan,
    sympy.asin: casadi.asin,
    sympy.acos: casadi.acos,
    sympy.atan: casadi.atan,
    sympy.atan2: casadi.atan2,
    sympy.sinh: casadi.sinh,
    sympy.cosh: casadi.cosh,
    sympy.tanh: casadi.tanh,
    sympy.asinh: casadi.asinh,
    sympy.acosh: casadi.acosh,
    sympy.atanh: casadi.atanh,
    sympy.Abs: casadi.fabs,
    sympy.sign: casadi.sign,
    sympy.floor: casadi.floor,
    sympy.ceiling: casadi.ceil,
    sympy.erf: casadi.erf,
    sympy.Min: lambda *args: functools.reduce(casadi.fmin, args),
    sympy.Max: lambda *args: functools.reduce(casadi.fmax, args),
    sympy.Heaviside: lambda x, at_zero=0.5: casadi.if_else(x == 0, at_zero, x > 0),
    sympy.StrictGreaterThan: operator.gt,
    sympy.GreaterThan: operator.ge,
    sympy.StrictLessThan: operator.lt,
    sympy.LessThan: operator.le,
    sympy.Equality: operator.eq,
    sympy.Unequality: operator.ne,
    sympy.And: lambda *args: functools.reduce(casadi.logic_and, args),
    sympy.Or: lambda *args: functools.reduce(casadi.logic_or, args),
    sympy.Not: casadi.logic_not,
}


# A tenth of the time that the operators + and * take to find out what they are given.
_plus = functools.partial(casadi.SX.binary, casadi.OP_ADD)
_times = functools.partial(casadi.SX.binary, casadi.OP_MUL)


@held_back()
def to_casadi(program: Program) -> casadi.Function:
    """Build a CasADi function on dense column vectors.

    Parameters
    ----------
    program : Program

    Returns
    -------
    casadi.Function
        Inputs and outputs named and ordered as the program's.

    Raises
    ------
    ProgramError
        For a function CasADi has no counterpart of.

    Examples
    --------
    >>> x = sympy.Symbol("x")
    >>> f = to_casadi(Program("f", (("x", (x,)),), (), (("y", (x**2,)),)))
    >>> float(f(3))
    9.0
    """
    inputs = [casadi.SX.sym(label, len(symbols)) for label, symbols in program.arguments]
    known: dict[sympy.Basic, Any] = {}
    for vector, (_, symbols) in zip(inputs, program.arguments, strict=True):
        parts = casadi.vertsplit(vector) if symbols else []
        known.update(zip(symbols, parts, strict=True))
    for symbol, expression in program.assignments:
        known[symbol] = _convert(expression, known)
    outputs = []
    for _, expressions in program.results:
        column = [_convert(expression, known) for expression in expressions]
        outputs.append(casadi.densify(casadi.vertcat(*column)) if column else casadi.SX(0, 1))
    return casadi.Function(
        program.name,
        inputs,
        outputs,
        [label for label, _ in program.arguments],
        [label for label, _ in program.results],
    )


def _convert(expression: sympy.Basic, known: dict[sympy.Basic, Any]) -> Any:
    """Translate a tree; ``known`` remembers symbols, numbers and subexpressions."""
    found = known.get(expression)
    if found is not None:
        return found
    value = known[expression] = _translate(expression, known)
    return value


def _translate(expression: sympy.Basic, known: dict[sympy.Basic, Any]) -> Any:
    if expression.is_Symbol:
        raise ProgramError(f"{expression} is not known")
    if expression in (sympy.true, sympy.false):
        return casadi.SX(float(bool(expression)))
    if isinstance(expression, sympy.Expr) and expression.is_number and not expression.args:
        return casadi.SX(float(expression))
    if isinstance(expression, sympy.Piecewise):
        return _piecewise(expression, known)
    if isinstance(expression, sympy.Pow):
        return _power(expression, known)
    arguments = [_convert(argument, known) for argument in expression.args]
    if isinstance(expression, sympy.Add):
        return functools.reduce(_plus, arguments)
    if isinstance(expression, sympy.Mul):
        return functools.reduce(_times, arguments)
    function = FUNCTIONS.get(expression.func)
    if function is None:
        raise ProgramError(
            f"no CasADi form of {expression.func.__name__} in {expression}; write it in known functions"
        )
    return function(*arguments)


def _power(expression: sympy.Pow, known: dict[sympy.Basic, Any]) -> Any:
    base, exponent = expression.args
    below = _convert(base, known)
    if exponent == sympy.S.Half:
        return casadi.sqrt(below)
    if exponent == -sympy.S.Half:
        return 1 / casadi.sqrt(below)
    if exponent.is_Integer:
        positive = _integer_power(below, abs(int(exponent)))
        return 1 / positive if int(exponent) < 0 else positive
    return casadi.power(below, _convert(exponent, known))


def _integer_power(base: Any, exponent: int) -> Any:
    """Multiply out small powers: exact and cheaper than ``pow``."""
    if exponent > 8:
        return casadi.power(base, exponent)
    return functools.reduce(operator.mul, [base] * exponent)


def _piecewise(expression: sympy.Piecewise, known: dict[sympy.Basic, Any]) -> Any:
    result: Any = float("nan")
    for value, condition in reversed(expression.args):
        branch = _convert(value, known)
        result = (
            branch
            if condition == sympy.true
            else casadi.if_else(_convert(condition, known), branch, result)
        )
    return result
