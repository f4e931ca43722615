"""Exact arithmetic that stays finite, real and short."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import sympy

from .numbers import bit_count, growth
from .syntax import Source

MAX_POWER = 100  # magnitude of a numeric exponent
MAX_BITS = 1200  # of a number's numerator or denominator; every double fits
MAX_GROWTH = 100_000  # bits that sympy may write out in between
MAX_ROOT_BITS = 256  # under a fractional power, where sympy looks for factors


@dataclass(frozen=True)
class Value:
    """A part that was read; ``number`` is its value in doubles if it is constant."""

    expression: sympy.Expr
    number: float | None


class Arithmetic:
    """Builds parts of one expression, and refuses those that get out of hand."""

    def __init__(self, source: Source) -> None:
        self.fail = source.fail

    def made(self, node: ast.AST, expression: sympy.Expr, number: float | None = None) -> Value:
        """Check what sympy made of a part."""
        if expression.has(sympy.nan, sympy.zoo, sympy.oo, -sympy.oo):
            self.fail(node, "this is not finite (a division by zero?); change the numbers")
        if expression.has(sympy.I):
            self.fail(node, "this is not real; change the numbers")
        for part in (*expression.as_coeff_Mul()[:1], *expression.as_coeff_Add()[:1]):
            if bit_count(part) > MAX_BITS:
                self.fail(node, "the exact number is too long; write its value as a decimal")
        if number is None and not expression.free_symbols:
            number = self._bounded(node, lambda: float(expression.evalf(17)))
        if number is None:
            for power in expression.atoms(sympy.Pow):
                if growth(power.base, power.exp) > MAX_GROWTH:
                    self.fail(node, "a number is raised to too high a power; use exp(...)")
        return Value(expression, number)

    def _bounded(self, node: ast.AST, work: Callable[[], float]) -> float:
        """Evaluate a constant in doubles."""
        try:
            number = float(work())
        except OverflowError:
            number = math.inf
        except (ValueError, ZeroDivisionError, TypeError):
            self.fail(node, "this has no real value; change the numbers")
        if not math.isfinite(number):
            self.fail(node, "the result is too large for a double; change the numbers")
        return number

    def folded(
        self, node: ast.AST, fold: Callable[[list[float]], float], numbers: Sequence[float | None]
    ) -> float | None:
        """Evaluate a constant in doubles; None where one of its parts is none."""
        known = [number for number in numbers if number is not None]
        return self._bounded(node, lambda: fold(known)) if len(known) == len(numbers) else None

    def power(self, node: ast.AST, base: Value, exponent: Value) -> Value:
        """Raise one part to the power of another."""
        if exponent.number is not None and abs(exponent.number) > MAX_POWER:
            self.fail(node, f"the exponent {exponent.number:g} is beyond {MAX_POWER}; use exp(...)")
        if base.number == 0 and exponent.number is not None and exponent.number < 0:
            self.fail(node, "this divides by zero; change the numbers")
        number = None
        if base.number is not None and exponent.number is not None:
            below, above = base.number, exponent.number
            number = self._bounded(node, lambda: math.pow(below, above))
            if number == 0 and below != 0:
                self.fail(node, "the result is too small for a double; change the numbers")
        if exponent.expression != -1:
            self._check_growth(node, base.expression, exponent.expression)
        return self.made(node, base.expression**exponent.expression, number)

    def _check_growth(self, node: ast.AST, base: sympy.Expr, exponent: sympy.Expr) -> None:
        """Refuse powers that sympy would write out as long numbers, or search for factors."""
        for factor in sympy.Mul.make_args(base):
            below, above = factor.as_base_exp()
            if below.is_number and growth(below, above, exponent) > MAX_GROWTH:
                self.fail(node, "a number is raised to too high a power; use exp(...)")
            plain = not below.is_number and above.is_number and exponent.is_number
            if plain and abs(above * exponent) > MAX_POWER:
                self.fail(node, f"the exponents multiply to more than {MAX_POWER}; use exp(...)")
        if not exponent.is_Integer and bit_count(base.as_coeff_Mul()[0]) > MAX_ROOT_BITS:
            self.fail(node, "a root of such a number is costly; write its value as a decimal")

    def check_exponential(self, node: ast.AST, argument: sympy.Expr, number: float | None) -> None:
        """Refuse what sympy would turn into a long number: exp(x + a log(b)) is b**a exp(x)."""
        terms = sympy.Add.make_args(argument)
        constant = sympy.Add(*(term for term in terms if not term.free_symbols))
        value = self._bounded(node, lambda: math.exp(float(constant.evalf(17))))
        if value == 0 or number == 0:
            self.fail(node, "the result is too small for a double; change the numbers")
