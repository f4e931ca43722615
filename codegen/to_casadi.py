"""Program -> CasADi Function.

Each sympy node becomes one SX node; shared subexpressions stay shared.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Collection
from typing import Any

import casadi
import sympy

from .collector import held_back
from .program import Program, ProgramError
from .symbols import symbols_in

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
def to_casadi(program: Program, fixed: Collection[str] = ()) -> casadi.Function:
    """Build a CasADi function on dense column vectors.

    Parameters
    ----------
    program : Program
    fixed : collection of str
        Arguments that stay the same over many calls, such as parameters. What depends on them
        alone is kept together, so that a compiler can take it out of a loop over the calls; a
        division by them becomes a product with a reciprocal.

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
    known = _Known()
    for vector, (label, symbols) in zip(inputs, program.arguments, strict=True):
        parts = casadi.vertsplit(vector) if symbols else []
        known.values.update(zip(symbols, parts, strict=True))
        if label in fixed:
            known.fixed.update(symbols)
    for symbol, expression in program.assignments:
        known.values[symbol] = _convert(expression, known)
        if known.fixed and known.stays(expression):
            known.fixed.add(symbol)
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


class _Known:
    """What has been translated: symbols, numbers and subexpressions; and which symbols are fixed."""

    def __init__(self) -> None:
        self.values: dict[sympy.Basic, Any] = {}
        self.fixed: set[sympy.Basic] = set()

    def stays(self, expression: sympy.Basic) -> bool:
        """Whether an expression depends on fixed symbols alone."""
        return symbols_in(expression) <= self.fixed


def _convert(expression: sympy.Basic, known: _Known) -> Any:
    """Translate a tree, but for what is known already."""
    found = known.values.get(expression)
    if found is not None:
        return found
    value = known.values[expression] = _translate(expression, known)
    return value


def _translate(expression: sympy.Basic, known: _Known) -> Any:
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
    if isinstance(expression, sympy.Mul) and known.fixed:
        return _product(expression, known)
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


def _product(expression: sympy.Mul, known: _Known) -> Any:
    """Multiply what is fixed first, then the rest with it."""
    staying = [item for item in expression.args if known.stays(item)]
    moving = [_convert(item, known) for item in expression.args if item not in staying]
    below = [item for item in staying if item.is_Pow and item.exp.could_extract_minus_sign()]
    factors = [_convert(item, known) for item in staying if item not in below]
    if not moving or not below:
        return functools.reduce(_times, [*factors, *moving])
    divisor = functools.reduce(_times, [_convert(1 / item, known) for item in below])
    if factors:
        scale = functools.reduce(_times, factors) / divisor
    else:  # of 1 / divisor CasADi would make a division again
        half = casadi.SX(0.5) / divisor
        scale = half + half
    return functools.reduce(_times, moving, scale)


def _power(expression: sympy.Pow, known: _Known) -> Any:
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


def _piecewise(expression: sympy.Piecewise, known: _Known) -> Any:
    result: Any = float("nan")
    for value, condition in reversed(expression.args):
        branch = _convert(value, known)
        result = (
            branch
            if condition == sympy.true
            else casadi.if_else(_convert(condition, known), branch, result)
        )
    return result
