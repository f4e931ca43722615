"""Rates: time derivatives of variables, by the chain rule along their assignments.

Dependent storages need the rate of a variable that follows from states. It is built as
further variables, ``der(x)``, that share intermediate results like all others.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, MutableMapping

import sympy

from .errors import LawError, owners
from .graph import TIME
from .terms import slopes

MAX_ORDER = 3


class Rates:
    """Adds variables for rates to a table of assignments on demand.

    What dependent storages answer counts as constant here: junctions, TF and GY
    make no power, so that the states of dependent storages do not depend on their
    answers. These stand in the assignments all the same, where they cancel. What
    comes by a signal does not cancel: that, and any other use, takes `full`.

    Parameters
    ----------
    explicit, implicit : mutable mapping of Symbol to Expr
        The tables of `bondgraph.blocks.order_and_solve`; extended in place
        while the equations are being built.
    states : mapping of Symbol to Symbol
        State to the variable that is its rate.
    inputs : collection of Symbol
        Inputs; their rates become inputs in turn.
    answers : collection of Symbol
        What dependent storages answer.
    signals : mapping of Symbol to Symbol
        Stand-ins by which laws hear of other variables, and the variable.

    Attributes
    ----------
    full : Rates
        Rates without the exception for answers, named ``rate(x)``.
    input_rates : dict of Symbol to Symbol
        Input to its rate, for the rates that were needed.
    """

    def __init__(
        self,
        explicit: MutableMapping[sympy.Symbol, sympy.Expr],
        implicit: MutableMapping[sympy.Symbol, sympy.Expr],
        states: Mapping[sympy.Symbol, sympy.Symbol],
        inputs: Collection[sympy.Symbol],
        answers: Collection[sympy.Symbol] = (),
        signals: Mapping[sympy.Symbol, sympy.Symbol] | None = None,
    ) -> None:
        self._explicit = explicit
        self._implicit = implicit
        self._states = states
        self._inputs = inputs
        self._answers = answers
        self._signals = signals or {}
        self._word = "der"
        self._known: dict[sympy.Symbol, sympy.Expr] = {}
        self._order: dict[sympy.Symbol, int] = {}
        self._pending: list[sympy.Symbol] = []
        self._made: set[sympy.Symbol] = set()  # rates asked for, written or not yet
        self.input_rates: dict[sympy.Symbol, sympy.Symbol] = {}
        self.full = self
        if answers:
            self.full = Rates(explicit, implicit, states, inputs, signals=signals)
            self.full._word = "rate"
            self.full.input_rates = self.input_rates
            self.full._made = self._made

    def of(self, expression: sympy.Expr) -> sympy.Expr:
        """Return the total time derivative of an expression, in known variables and rates.

        Raises
        ------
        LawError
            When the equations ask for derivatives of ever higher order.
        """
        rate = self._chain(expression)
        self.finish()
        return rate

    def later(self, symbol: sympy.Symbol) -> sympy.Expr:
        """Return the rate of a variable at once; what it is follows with `finish`.

        Where rates are needed of variables that are themselves given by rates, all must be
        asked for before any is worked out.
        """
        return self._rate(symbol)

    def finish(self) -> None:
        """Write the assignments of the rates asked for, until none is left."""
        while self._pending or self.full._pending:
            work, symbol = self._next()
            work._pending.remove(symbol)
            rate = work._known[symbol]
            assert isinstance(rate, sympy.Symbol)
            table = self._explicit if symbol in self._explicit else self._implicit
            table[rate] = work._chain(table[symbol])

    def _next(self) -> tuple[Rates, sympy.Symbol]:
        """Return what to work out next: the last asked for that is itself written."""
        return next(
            (work, symbol)
            for work in (self, self.full)
            for symbol in reversed(work._pending)
            if symbol in self._explicit or symbol in self._implicit
        )

    def _chain(self, expression: sympy.Expr) -> sympy.Expr:
        terms = []
        symbols = sorted(expression.free_symbols, key=lambda item: item.name)
        inner = {symbol: self._rate(symbol) for symbol in symbols}
        moving = [symbol for symbol in symbols if inner[symbol] != 0]
        for symbol, slope in slopes(expression, moving).items():
            if slope.has(
                sympy.DiracDelta
            ):  # where a law jumps it has no rate that a number could tell
                slope = slope.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero)
            terms.append(slope * inner[symbol])
        return sympy.Add(*terms)

    def _rate(self, symbol: sympy.Symbol) -> sympy.Expr:
        """Return the rate of one symbol, as zero, one or a symbol."""
        if symbol in self._answers:
            return sympy.S.Zero
        if symbol in self._signals:
            return self.full._rate(self._signals[symbol])
        if symbol in self._known:
            return self._known[symbol]
        if symbol == TIME:
            return sympy.S.One
        if symbol in self._states:
            return self._states[symbol]
        if symbol in self._inputs or symbol in self.input_rates.values():
            return self._new_input_rate(symbol)
        # a rate asked for but not written yet is no constant
        if symbol in self._explicit or symbol in self._implicit or symbol in self._made:
            return self._new_rate(symbol)
        return sympy.S.Zero

    def _new_input_rate(self, symbol: sympy.Symbol) -> sympy.Symbol:
        rate = sympy.Symbol(f"der({symbol.name})", real=True)
        self._known[symbol] = rate
        self.input_rates[symbol] = rate
        return rate

    def _new_rate(self, symbol: sympy.Symbol) -> sympy.Symbol:
        order = self._order.get(symbol, 0) + 1
        if order > MAX_ORDER:
            raise LawError(
                f"the equations ask for derivatives of ever higher order (at {symbol.name}); "
                f"a dependent storage hangs on another: add a compliance or resistance between them",
                elements=owners([symbol.name]),
            )
        rate = sympy.Symbol(f"{self._word}({symbol.name})", real=True)
        self._known[symbol] = rate
        self._made.add(rate)
        self._order[rate] = order
        self._pending.append(symbol)
        return rate
