"""Writes a sympy expression in the language that `parse` reads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.str import StrPrinter

from ..errors import LawError
from ..laws import exact
from .language import COMPARISONS, FUNCTIONS, MAX_LENGTH, TIME, Function
from .names import quoted
from .numbers import as_double, bit_count
from .words import shortened

DOUBLE_BITS = 1023  # of a whole number that is surely below the largest double
WRITABLE = (
    sympy.Symbol,
    sympy.Rational,
    type(sympy.pi),
    type(sympy.E),
    sympy.Add,
    sympy.Mul,
    sympy.Pow,
    sympy.Piecewise,
    sympy.functions.elementary.piecewise.ExprCondPair,
    *COMPARISONS.values(),
    sympy.And,
    sympy.Or,
    sympy.Not,
    type(sympy.true),
)


def to_text(
    expression: Any, names: Mapping[str, Any], functions: Mapping[str, Function] = FUNCTIONS
) -> str:
    """Write an expression so that `parse` reads it back.

    Parameters
    ----------
    expression : Expr or number
    names : mapping of str to Symbol
        As for `parse`. Where a symbol has several names the first is written.
    functions : mapping of str to Function

    Returns
    -------
    str
        ``parse(to_text(e, names), names) == e``. What sympy evaluates by
        itself when it is built again, such as a factored ``2*(x + y)``, comes
        back in that form.

    Raises
    ------
    LawError
        For functions and symbols that have no name.

    Examples
    --------
    >>> p, c = sympy.symbols("p c", real=True)
    >>> to_text(sympy.Max(p / 3, sympy.sqrt(c)), {"mass.p": p, "c": c})
    'max(sqrt(c), mass.p/3)'
    """
    expression = exact(expression)
    text = str(_Writer(names, functions).doprint(expression))
    if len(text) > MAX_LENGTH:
        raise LawError(f"the expression is too long to write: {len(text)} characters; split it")
    return text


class _Writer(StrPrinter):
    """Writes with sympy's rules for precedence and order, in our names."""

    def __init__(self, names: Mapping[str, Any], functions: Mapping[str, Function]) -> None:
        super().__init__()
        self._constants = names
        self._spelled: dict[Any, str] = {TIME: "t"} if "t" not in names else {}
        for name, symbol in names.items():
            if isinstance(symbol, sympy.Symbol):
                self._spelled.setdefault(symbol, name)
        self._functions = {
            function.build: name
            for name, function in functions.items()
            if isinstance(function.build, type)
        }

    def doprint(self, expr: sympy.Expr) -> str:
        for part in sympy.preorder_traversal(expr):
            if not (isinstance(part, WRITABLE) or part.func in self._functions):
                raise LawError(
                    f"{part.func.__name__} in {shortened(str(expr))} cannot be written in a file; "
                    f"there are {', '.join(self._functions.values())}, sqrt and where"
                )
        return str(super().doprint(expr))

    def _print_Symbol(self, expr: sympy.Symbol) -> str:
        if expr not in self._spelled:
            raise LawError(f"{expr.name!r} has no name here; make it a parameter or an input")
        return quoted(self._spelled[expr])

    _print_Dummy = _print_Symbol

    def _print_Rational(self, expr: sympy.Rational) -> str:
        return _decimal(expr) or self._fraction(expr)

    _print_Integer = _print_Rational

    def _fraction(self, expr: sympy.Rational) -> str:
        if bit_count(expr) > DOUBLE_BITS:
            raise LawError(f"the exact number near {expr.evalf(6)} is too long to write; round it")
        return f"{expr.p}/{expr.q}" if expr.q != 1 else str(expr.p)

    def _print_Mul(self, expr: sympy.Mul) -> str:
        number, rest = expr.as_coeff_Mul()
        decimal = _decimal(number)
        if decimal is None:
            return str(super()._print_Mul(expr))
        text = self.parenthesize(rest, PRECEDENCE["Mul"], strict=True)
        return decimal + text[1:] if text.startswith("1/") else f"{decimal}*{text}"

    def _print_Pi(self, expr: sympy.Expr) -> str:
        return "pi" if self._constants.get("pi", sympy.pi) is sympy.pi else "acos(-1)"

    def _print_Exp1(self, expr: sympy.Expr) -> str:
        return "exp(1)"

    def _print_Function(self, expr: sympy.Expr) -> str:
        arguments = expr.args
        if isinstance(expr, sympy.Heaviside) and arguments[1:] == (sympy.S.Half,):
            arguments = arguments[:1]
        return f"{self._functions[expr.func]}({', '.join(map(self._print, arguments))})"

    _print_LatticeOp = _print_Heaviside = _print_Function

    def _print_Piecewise(self, expr: sympy.Piecewise) -> str:
        *pairs, last = expr.args
        if last.cond != sympy.true:
            raise LawError(
                f"{shortened(str(expr))} has no value otherwise; end it with (value, True)"
            )
        parts = [item for pair in pairs for item in (pair.cond, pair.expr)]
        return f"where({', '.join(map(self._print, [*parts, last.expr]))})"

    def _print_Relational(self, expr: sympy.Expr) -> str:
        sign = {"Eq": "==", "Ne": "!="}.get(expr.rel_op, expr.rel_op)
        return f"{self._print(expr.lhs)} {sign} {self._print(expr.rhs)}"

    def _print_And(self, expr: sympy.And) -> str:
        return self._joined(expr, " and ")

    def _print_Or(self, expr: sympy.Or) -> str:
        return self._joined(expr, " or ")

    def _print_Not(self, expr: sympy.Not) -> str:
        return f"not ({self._print(expr.args[0])})"

    def _joined(self, expr: Any, word: str) -> str:
        ordered = sorted(expr.args, key=sympy.default_sort_key)
        return word.join(f"({self._print(part)})" for part in ordered)


def _decimal(number: sympy.Expr) -> str | None:
    """Return the decimal form of a number that reads better so than as a fraction."""
    if not isinstance(number, sympy.Rational) or (number.q <= 12 and abs(number.p) < 10**16):
        return None
    value = as_double(number)
    return None if value is None else repr(value)
