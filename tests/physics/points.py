"""Derived equations evaluated at a point, in as many digits as asked, without codegen.

Rates of what has no equation of its own, such as the state of a dependent storage, are taken by
differences along the motion: in 60 digits they are good to far more than is asked.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import sympy

from bondgraph import Equations
from bondgraph.graph import TIME

from .plans import JUNCTIONS, Plan
from .raw import Rows, Values

DIGITS = 60
STEP = mpmath.mpf(10) ** -20
FUNCTIONS = ("sin", "cos", "tan", "tanh", "exp", "log", "sinh", "cosh", "sign")


class UnsolvedError(Exception):
    """No values of the algebraic variables were found at a point."""


class Arithmetic:
    """Evaluates expressions over numbers of one kind: mpmath's, or fractions.

    Examples
    --------
    >>> x = sympy.Symbol("x")
    >>> Arithmetic(Fraction).value(x / 3 + 1, {x: Fraction(2)})
    Fraction(5, 3)
    """

    def __init__(self, number: Any = mpmath.mpf) -> None:
        self.number = number

    def value(self, expression: sympy.Basic, known: Mapping[sympy.Basic, Any]) -> Any:
        """Return the value of an expression, with its symbols known."""
        if isinstance(expression, sympy.Symbol):
            return known[expression]
        if isinstance(expression, sympy.Rational):
            return self.number(int(expression.p)) / int(expression.q)
        values = [self.value(argument, known) for argument in expression.args]
        if isinstance(expression, sympy.Add):
            return sum(values)
        if isinstance(expression, sympy.Mul):
            product = values[0]
            for factor in values[1:]:
                product = product * factor
            return product
        if isinstance(expression, sympy.Pow):
            exponent = expression.exp
            return values[0] ** (int(exponent) if exponent.is_Integer else values[1])
        if isinstance(expression, sympy.Abs):
            return abs(values[0])
        name = type(expression).__name__
        assert name in FUNCTIONS, f"{expression} is of no kind known here"
        return getattr(mpmath, name)(values[0])

    def follow(self, equations: Equations, known: dict[sympy.Basic, Any]) -> dict[sympy.Basic, Any]:
        """Return all variables of equations, from what is given from outside."""
        found = dict(known)
        for symbol, expression in equations.assignments:
            found[symbol] = self.value(expression, found)
        return found


def matrix(equations: Equations) -> list[list[Fraction]]:
    """Return A of linear equations, exactly, column by column from unit vectors."""
    exact = Arithmetic(Fraction)
    given = dict.fromkeys(equations.arguments, Fraction(0))
    columns = []
    for state in equations.states:
        found = exact.follow(equations, {**given, state: Fraction(1)})
        columns.append([exact.value(rate, found) for rate in equations.derivatives])
    return [list(row) for row in zip(*columns, strict=True)]


class Point:
    """Equations at one point: everything known, in `DIGITS` digits.

    Parameters
    ----------
    equations : Equations
    seed : int
        Draws states, inputs and their rates, and directions of slip.
    given : mapping of Symbol to number, optional
        Instead of what is drawn.
    """

    def __init__(
        self,
        equations: Equations,
        seed: int,
        given: Mapping[sympy.Basic, Any] | None = None,
    ) -> None:
        self.equations = equations
        self.arithmetic = Arithmetic()
        rng = random.Random(seed)
        self.given: dict[sympy.Basic, Any] = {TIME: mpmath.mpf(rng.uniform(0.1, 2))}
        for symbol in (*equations.states, *equations.inputs):
            self.given[symbol] = mpmath.mpf(rng.uniform(-0.8, 0.8))
        for symbol in equations.directions:
            self.given[symbol] = mpmath.mpf(rng.choice((-1, 1)))
        self.given |= given or {}
        self.guess = [mpmath.mpf(0)] * len(equations.algebraic)
        self.known = self._solved(self.given, rng)
        self.rates = {
            state: self.value(rate)
            for state, rate in zip(equations.states, equations.derivatives, strict=True)
        }

    def value(self, expression: Any) -> Any:
        """Return an expression's value here."""
        return self.arithmetic.value(sympy.sympify(expression), self.known)

    def total(self, expressions: Any) -> Any:
        """Return the sum of some expressions' values here."""
        return sum((self.value(each) for each in expressions), mpmath.mpf(0))

    def change(self, *expressions: Any) -> list[Any]:
        """Return the rates of expressions along the motion, by a central difference."""
        ends = []
        for sign in (1, -1):
            known = self._solved(self._moved(sign * STEP))
            ends.append([self.arithmetic.value(sympy.sympify(each), known) for each in expressions])
        return [(after - before) / (2 * STEP) for after, before in zip(*ends, strict=True)]

    def after(self, step: Any) -> Point:
        """Return the point that one step along the motion leads to."""
        return Point(self.equations, 0, self._moved(step))

    def _moved(self, step: Any) -> dict[sympy.Basic, Any]:
        moved = dict(self.given)
        moved[TIME] += step
        for state, rate in self.rates.items():
            moved[state] += step * rate
        for symbol, rate in self.equations.input_rates.items():
            moved[symbol] += step * self.given[rate]
        return moved

    def _solved(
        self, given: dict[sympy.Basic, Any], rng: random.Random | None = None
    ) -> dict[sympy.Basic, Any]:
        """Find the algebraic variables, from a few starts, and all that follows."""
        equations = self.equations
        if not equations.algebraic:
            return self.arithmetic.follow(equations, given)
        for attempt in range(6 if rng else 1):
            start = list(self.guess)
            if attempt and rng:
                start = [mpmath.mpf(rng.uniform(-attempt, attempt)) for _ in start]
            found = self._newton(given, start)
            if found is not None:
                self.guess = found
                return self._at(given, found)[0]
        raise UnsolvedError

    def _at(self, given: dict[sympy.Basic, Any], algebraic: Sequence[Any]) -> tuple[Any, list[Any]]:
        known = {**given, **dict(zip(self.equations.algebraic, algebraic, strict=True))}
        found = self.arithmetic.follow(self.equations, known)
        return found, [self.arithmetic.value(each, found) for each in self.equations.residuals]

    def _newton(self, given: dict[sympy.Basic, Any], x: list[Any]) -> list[Any] | None:
        """Newton's method with damping, slopes by differences; None where it leads nowhere."""
        size, delta = len(x), mpmath.mpf(10) ** (-DIGITS // 2)
        try:
            here = self._at(given, x)[1]
            for _ in range(60):
                if max(map(abs, here)) < mpmath.mpf(10) ** (3 - DIGITS):
                    return x
                slopes = mpmath.matrix(size, size)
                for column in range(size):
                    nudged = [v + delta * (k == column) for k, v in enumerate(x)]
                    for row, value in enumerate(self._at(given, nudged)[1]):
                        slopes[row, column] = (value - here[row]) / delta
                step = mpmath.lu_solve(slopes, mpmath.matrix(here))
                scale = mpmath.mpf(1)
                while scale > mpmath.mpf(10) ** -6:
                    there = [v - scale * step[k] for k, v in enumerate(x)]
                    left = self._at(given, there)[1]
                    if max(map(abs, left)) < max(map(abs, here)):
                        break
                    scale /= 2
                else:
                    return None
                x, here = there, left
        # TypeError is what mpmath makes of a column of zeros
        except (ZeroDivisionError, OverflowError, ValueError, TypeError):
            return None
        return None


def values(
    plan: Plan,
    point: Point,
    modes: Mapping[str, int] | None = None,
) -> Values:
    """Return what the raw equations ask for, from derived equations at a point."""
    equations = point.equations
    graph, ports = equations.graph, equations.ports
    named = {symbol.name: symbol for symbol in point.known}
    found: dict[str, list[Any]] = {"e": [], "f": []}
    for (tail, head), bond in zip(plan.bonds, graph.bonds, strict=True):
        for letter, series in found.items():
            shared = {"e": "0", "f": "1"}[letter]
            said = [
                ports[f"{end}.{letter}"]
                for end in (tail, head)
                if plan.kind(end) == shared or plan.kind(end) not in (*JUNCTIONS, "TF", "GY")
            ]
            series.append(point.value(said[0] if said else named[f"{bond.name}.{letter}"]))
    letters = plan.storages
    state = {name: ports[f"{name}.{letter}"] for name, letter in letters.items()}
    moving = [name for name in letters if state[name] not in point.rates]
    rates = dict(zip(moving, point.change(*(state[name] for name in moving)), strict=True))
    rates |= {name: point.rates[symbol] for name, symbol in state.items() if symbol in point.rates}
    return Values(
        found["e"],
        found["f"],
        {name: point.value(symbol) for name, symbol in state.items()},
        rates,
        {name: point.known[sympy.Symbol(f"u_{name}", real=True)] for name in plan.inputs},
        modes or {},
    )


def left_over(rows: Rows, values: Values) -> tuple[Any, str]:
    """Return the largest residual of the raw equations, and whose it is."""
    found = [(abs(value), name) for name, value in rows.residuals(values)]
    return max(found, default=(mpmath.mpf(0), ""))
