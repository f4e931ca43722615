"""A parameter table at many points: rows that vary are arrays, the others stay numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy
import sympy

from ...codegen.program import Program
from ...codegen.to_numpy import to_numpy
from ...equations import Equations
from ...errors import ParameterError
from ...parameters import Parameter
from ...resolver import Resolver
from ...smooth import in_dependence

Array = numpy.ndarray
Values = dict[str, Any]  # by name: a number, or an (m,) array

# What a symbol may assume, and what its values then satisfy.
_RULES = (
    ("is_positive", lambda value: value > 0, "positive"),
    ("is_negative", lambda value: value < 0, "negative"),
    ("is_nonnegative", lambda value: value >= 0, "at least zero"),
    ("is_nonzero", lambda value: value != 0, "different from zero"),
    ("is_integer", lambda value: value == numpy.floor(value), "a whole number"),
)


@dataclass(frozen=True, eq=False)
class Refusal:
    """Which of the points are refused, and why the first of them is.

    Attributes
    ----------
    at : (m,) array of bool
    reason : str
        Empty where none is.
    """

    at: Array
    reason: str


class Table:
    """A graph's parameter table, evaluated at many points.

    Parameters
    ----------
    equations : Equations
    overrides : mapping
        Parameters that are the same at all points, by name or symbol; not looked at where
        they vary.
    varied : sequence of str
        Parameters that vary.

    Attributes
    ----------
    names : tuple of str
        Parameters that have a value.

    Raises
    ------
    ParameterError
        For what `bondgraph.resolver.Resolver` refuses in the rows that do not vary, and for
        a parameter without a value.

    Examples
    --------
    >>> from bondgraph import derive
    >>> from bondgraph.models import mass_on_belt
    >>> table = Table(derive(mass_on_belt.graph()), {}, ["k"])
    >>> values, refusal = table.at({"k": numpy.array([100.0, -1.0])}, 2)
    >>> values["m"], refusal.at.tolist(), refusal.reason
    (1.0, [False, True], "parameter 'k' is -1; it must be positive")
    """

    def __init__(
        self, equations: Equations, overrides: Mapping[Any, Any], varied: Sequence[str]
    ) -> None:
        rows = equations.graph.parameters
        self._symbols = {symbol.name: symbol for symbol in rows}
        open_rows = {
            symbol: Parameter(None, row.unit) if symbol.name in varied else row
            for symbol, row in rows.items()
        }
        same = {
            key: value
            for key, value in overrides.items()
            if str(getattr(key, "name", key)) not in varied
        }
        self._fixed = Resolver(open_rows)(same, partial=True)
        self._varied = tuple(varied)
        known = {*self._fixed, *varied}
        following = []
        derived = [
            symbol for symbol, row in rows.items() if row.derived and symbol.name not in known
        ]
        for symbol in in_dependence(derived, rows):
            if {item.name for item in rows[symbol].value.free_symbols} <= known:
                following.append((symbol, rows[symbol].value))
                known.add(symbol.name)
        self._following = tuple(symbol.name for symbol, _ in following)
        self._given = tuple(name for name in known if name not in self._following)
        program = Program.pruned(
            "following",
            [("p", [self._symbols[name] for name in self._given])],
            following,
            {"values": [symbol for symbol, _ in following]},
        )
        self._follow = to_numpy(program)
        _check_complete(equations, known)
        self.names = tuple(name for name in self._symbols if name in known)

    def at(self, points: Mapping[str, Array], size: int) -> tuple[Values, Refusal]:
        """Evaluate the table.

        Parameters
        ----------
        points : mapping of str to (m,) array
            Varied parameters, SI.
        size : int
            m.

        Returns
        -------
        values : dict of str to float or (m,) array
        refusal : Refusal
            Points at which a value is not finite or not admissible.
        """
        values: Values = {**self._fixed, **{name: points[name] for name in self._varied}}
        if self._following:
            # a row for each given value, alike in shape: numbers stay numbers by broadcasting
            wide = [numpy.broadcast_to(values[name], (size,)) for name in self._given]
            found = self._follow(numpy.array(wide).reshape(len(wide), size))[0]
            values |= dict(zip(self._following, found, strict=True))
        refused, reason = numpy.zeros(size, dtype=bool), ""
        for name in (*self._varied, *self._following):
            bad, words = _refused(self._symbols[name], values[name])
            refused |= bad
            reason = reason or words
        return values, Refusal(refused, reason)


def _refused(symbol: sympy.Symbol, values: Array) -> tuple[Array, str]:
    """Return where values are not what their symbol assumes, and the first such place in words."""
    rules: list[tuple[Callable[[Any], Any], str]] = [(numpy.isfinite, "a finite number")]
    rules += [
        (rule, words)
        for assumption, rule, words in _RULES
        if getattr(symbol, assumption) and (assumption != "is_nonzero" or symbol.is_real)
    ]
    bad = ~numpy.logical_and.reduce([rule(values) for rule, _ in rules])
    if not bad.any():
        return bad, ""
    first = values[int(numpy.argmax(bad))]
    words = next(words for rule, words in rules if not rule(first))
    return bad, f"parameter {symbol.name!r} is {first:g}; it must be {words}"


def _check_complete(equations: Equations, known: set[str]) -> None:
    missing = [symbol.name for symbol in equations.parameters if symbol.name not in known]
    if missing:
        raise ParameterError(
            f"model {equations.name!r} needs a value for {', '.join(missing)}; give it in "
            f"parameters={{...}}, or vary it"
        )
