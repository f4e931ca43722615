"""What expressions may hold: functions, constants and comparisons, and hints on the rest."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import sympy

TIME = sympy.Symbol("t", real=True)  # the same symbol as graph.TIME, which lies above
MAX_LENGTH = 10_000  # characters
MAX_CHOICES = 16  # arguments of min and max: sympy compares each with each


@dataclass(frozen=True)
class Function:
    """A function that expressions may call.

    Attributes
    ----------
    build : callable
        Sympy's function; a class if `to_text` shall write it.
    number : callable
        The same in doubles, for constants: raises OverflowError or ValueError
        where there is no finite real result.
    least, most : int
        How many arguments it takes.

    Examples
    --------
    >>> FUNCTIONS["atan2"].most
    2
    """

    build: Callable[..., Any]
    number: Callable[..., float]
    least: int = 1
    most: int = 1


def _sign(x: float) -> float:
    return float((x > 0) - (x < 0))


def _heaviside(x: float, at_zero: float = 0.5) -> float:
    return at_zero if x == 0 else float(x > 0)


FUNCTIONS: Mapping[str, Function] = MappingProxyType(
    {
        "exp": Function(sympy.exp, math.exp),
        "log": Function(sympy.log, math.log),
        "sqrt": Function(sympy.sqrt, math.sqrt),
        "sin": Function(sympy.sin, math.sin),
        "cos": Function(sympy.cos, math.cos),
        "tan": Function(sympy.tan, math.tan),
        "asin": Function(sympy.asin, math.asin),
        "acos": Function(sympy.acos, math.acos),
        "atan": Function(sympy.atan, math.atan),
        "atan2": Function(sympy.atan2, math.atan2, 2, 2),
        "sinh": Function(sympy.sinh, math.sinh),
        "cosh": Function(sympy.cosh, math.cosh),
        "tanh": Function(sympy.tanh, math.tanh),
        "asinh": Function(sympy.asinh, math.asinh),
        "acosh": Function(sympy.acosh, math.acosh),
        "atanh": Function(sympy.atanh, math.atanh),
        "abs": Function(sympy.Abs, abs),
        "sign": Function(sympy.sign, _sign),
        "floor": Function(sympy.floor, math.floor),
        "ceil": Function(sympy.ceiling, math.ceil),
        "erf": Function(sympy.erf, math.erf),
        "heaviside": Function(sympy.Heaviside, _heaviside, 1, 2),
        "min": Function(sympy.Min, min, 1, MAX_CHOICES),
        "max": Function(sympy.Max, max, 1, MAX_CHOICES),
    }
)
CONSTANTS: Mapping[str, sympy.Expr] = MappingProxyType({"pi": sympy.pi, "t": TIME})
COMPARISONS: Mapping[type, type] = MappingProxyType(
    {
        ast.Lt: sympy.StrictLessThan,
        ast.LtE: sympy.LessThan,
        ast.Gt: sympy.StrictGreaterThan,
        ast.GtE: sympy.GreaterThan,
        ast.Eq: sympy.Equality,
        ast.NotEq: sympy.Unequality,
    }
)

# What people write in other languages, and what it is called here.
HINTS: Mapping[str, str] = MappingProxyType(
    {
        "ln": "write log",
        "pow": "write a**b",
        "Abs": "write abs",
        "Max": "write max",
        "Min": "write min",
        "Piecewise": "write where(condition, value, otherwise)",
        "arctan2": "write atan2",
        ast.BitXor.__name__: "a power is written **",
        ast.FloorDiv.__name__: "write floor(a / b)",
        ast.Mod.__name__: "write a - b*floor(a / b)",
        ast.BitAnd.__name__: "in a condition write: and",
        ast.BitOr.__name__: "in a condition write: or",
        ast.IfExp.__name__: "write where(condition, value, otherwise)",
        ast.Compare.__name__: "a comparison stands as the condition of where(...) only",
        ast.BoolOp.__name__: "'and', 'or' stand in the condition of where(...) only",
        ast.Not.__name__: "'not' stands in the condition of where(...) only",
        ast.Attribute.__name__: "a dotted name starts with a name, such as spring.q",
    }
)
ALLOWED = "allowed are numbers, names, + - * / **, parentheses and functions"
