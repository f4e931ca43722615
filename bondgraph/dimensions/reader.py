"""Reading dimensions off expressions.

Every symbol has a dimension: port variables that of their region, parameters
and inputs that of their unit. Where terms of a sum, arguments of functions or
a law and its variable must agree, the reader writes down a `Claim`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

import sympy
from sympy.core.relational import Relational
from sympy.functions.elementary.hyperbolic import HyperbolicFunction, InverseHyperbolicFunction
from sympy.functions.elementary.trigonometric import (
    InverseTrigonometricFunction,
    TrigonometricFunction,
)

from .forms import Form, raised, times

# Factors of geometry and calculus, as in pi d^4 / 32; any other number may hide a unit (9.81).
_PLAIN_NUMBERS = frozenset({1, 2, 3, 4, 6, 8, 12, 16, 32, 64, 128})
# Functions of a pure number, giving a pure number.
_PURE = (
    sympy.exp,
    sympy.log,
    sympy.erf,
    TrigonometricFunction,
    InverseTrigonometricFunction,
    HyperbolicFunction,
    InverseHyperbolicFunction,
)
# Functions that give a pure number of anything.
_COUNTS = (sympy.sign, sympy.Heaviside)


@dataclass(frozen=True)
class Claim:
    """Two forms that must have one dimension, and who says so.

    Attributes
    ----------
    left, right : Form
    origin : str
        Element, parameter or output, with the units it rests on.
    words : str
        What is wrong where they differ, with ``<left>`` and ``<right>``.
    firm : bool
        An element's law; other claims decide only where no law does.
    two_port : bool
        A ratio between two regions.
    """

    left: Form
    right: Form
    origin: str
    words: str
    firm: bool = False
    two_port: bool = False


@dataclass(frozen=True)
class Value:
    """The dimension of an expression, and whether a unit that somebody declared is in it."""

    form: Form
    anchored: bool


class Lookup:
    """What the reader asks about symbols."""

    def symbol(self, symbol: sympy.Basic) -> Value | None:
        """Return the dimension of a symbol; None where it is not known."""
        raise NotImplementedError


class Reader:
    """Walks the expressions of one element, parameter or output.

    Attributes
    ----------
    claims : list of Claim
        Written down while walking.
    """

    def __init__(self, lookup: Lookup, origin: str) -> None:
        self.lookup = lookup
        self.origin = origin
        self.claims: list[Claim] = []

    def claim(self, left: Form, right: Form, words: str, **marks: bool) -> None:
        """Ask that two forms agree."""
        self.claims.append(Claim(left, right, self.origin, words, **marks))

    def read(self, expression: sympy.Basic) -> Value | None:
        """Return the dimension of an expression; None where it is not known."""
        if expression.is_Symbol:
            return self.lookup.symbol(expression)
        if expression.is_number:
            return Value({}, False) if is_plain(expression) else None
        if isinstance(expression, sympy.Mul):
            return self._product(expression)
        if isinstance(expression, _PURE):
            for argument in expression.args:
                self._must_be_pure(argument, f"the argument of {expression.func.__name__}")
            return Value({}, False)
        if isinstance(expression, sympy.Pow):
            return self._power(expression)
        if isinstance(expression, sympy.Abs):
            return self.read(expression.args[0])
        if isinstance(expression, sympy.Add | sympy.Min | sympy.Max):
            return self._alike(expression.args)
        if isinstance(expression, sympy.atan2):
            self._alike(expression.args)
            return Value({}, False)
        if isinstance(expression, _COUNTS):
            return Value({}, False)
        if isinstance(expression, sympy.Piecewise):
            return self._piecewise(expression)
        return None

    def _product(self, expression: sympy.Mul) -> Value | None:
        values = [self.read(factor) for factor in expression.args]
        known = [value for value in values if value is not None]
        if len(known) < len(values):
            return None
        anchored = any(value.anchored for value in known)
        if not anchored and expression.as_coeff_Mul()[0] not in (1, -1):
            return None
        return Value(times(*(value.form for value in known)), anchored)

    def _power(self, expression: sympy.Pow) -> Value | None:
        base, exponent = expression.args
        if isinstance(exponent, sympy.Rational):
            value = self.read(base)
            power = Fraction(int(exponent.p), int(exponent.q))
            return None if value is None else Value(raised(value.form, power), value.anchored)
        self._must_be_pure(exponent, f"the exponent {plain_text(exponent)}")
        if base.is_number:
            return Value({}, False)
        value = self.read(base)
        return value if value is not None and not value.form else None

    def _must_be_pure(self, argument: sympy.Basic, what: str) -> None:
        value = self.read(argument)
        if value is not None and value.anchored:
            self.claim(value.form, {}, f"has {what} in <left>, where a pure number is wanted")

    def _alike(self, terms: Iterable[sympy.Basic]) -> Value | None:
        """Return the dimension that all terms of a sum have."""
        known = [(term, value) for term in terms if (value := self.read(term)) is not None]
        firm = [(term, value) for term, value in known if value.anchored]
        for term, value in firm[1:]:
            if value.form != firm[0][1].form:
                first = plain_text(firm[0][0])
                words = f"joins {first} in <left> to {plain_text(term)} in <right>"
                self.claim(firm[0][1].form, value.form, words)
        if firm:
            return firm[0][1]
        return next((value for term, value in known if not term.is_number), None)

    def _piecewise(self, expression: sympy.Piecewise) -> Value | None:
        for _, condition in expression.args:
            for relation in sorted(condition.atoms(Relational), key=str):
                self._alike(relation.args)
        return self._alike([value for value, _ in expression.args])


def plain_text(expression: sympy.Basic) -> str:
    """Write an expression with the plain names of port variables.

    Examples
    --------
    >>> plain_text(2 * sympy.Dummy("spring.q"))
    '2*spring.q'
    """
    dummies = expression.atoms(sympy.Dummy)
    return str(expression.xreplace({dummy: sympy.Symbol(dummy.name) for dummy in dummies}))


def is_plain(number: sympy.Expr) -> bool:
    """Whether a number is one of geometry and calculus, which carry no unit.

    Examples
    --------
    >>> is_plain(sympy.pi / 32), is_plain(sympy.Rational(981, 100))
    (True, False)
    """
    rational, rest = number.as_coeff_Mul()
    if not isinstance(rational, sympy.Rational) or rational.q not in _PLAIN_NUMBERS:
        return False
    bases = [factor.as_base_exp()[0] for factor in sympy.Mul.make_args(rest)]
    return abs(rational.p) in {0, *_PLAIN_NUMBERS} and all(
        base in (1, 2, 3, sympy.pi) for base in bases
    )
