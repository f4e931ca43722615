"""Runs of a model's own start at one value after another of a parameter."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy

from ..elements import DryFriction
from ..errors import BondGraphError
from ..stability.vary import Vary
from .bench import Bench
from .described import described
from .pushes import pushes
from .reached import ReachPoint
from .rest import Rest, maybe_rest, sizes_of
from .settle import clock_for, settle
from .starts import off_rest

# The first part of a run, in which sticks are counted, is so many first stages long.
FIRST_PART = 4


class Line:
    """Runs of one model along one parameter.

    Parameters
    ----------
    bench : Bench
    item : Vary
        In SI; its ends choose how long runs are, one length for all.
    parameters : dict
        Of the model, by name or symbol.
    initial : mapping, optional
        States to start from in place of the model's own.
    limits : (float or None, float, float)
        Longest time to settle, s; when to stop, in seconds of the processor; rtol.
    """

    def __init__(
        self,
        bench: Bench,
        item: Vary,
        parameters: dict[Any, Any],
        initial: Mapping[Any, float] | None,
        limits: tuple[float | None, float, float],
    ) -> None:
        self.bench, self.item, self.initial, self.limits = bench, item, initial, limits
        self.parameters = {str(getattr(k, "name", k)): v for k, v in parameters.items()}
        table = {symbol.name: row for symbol, row in bench.graph.parameters.items()}
        self.is_input = item.name in bench.inputs
        row = table.get(item.name)
        self.unit = row.unit if row is not None else input_unit(bench, item.name)
        self.units: dict[str, str] = {}
        self.last: Rest | None = None
        # one length for all points, so that counts compare
        self.span = 0.0
        refusal: BondGraphError | None = None
        for value in (item.lo, (item.lo + item.hi) / 2, item.hi):
            try:
                rest, _ = self._rest(self._values(value))
            except BondGraphError as error:  # such as a mass below zero: told at its point
                refusal = error
                continue
            poles = numpy.zeros(0) if rest is None else rest.poles
            first = clock_for(poles, limits[0], until=limits[1]).first
            self.span = max(self.span, FIRST_PART * first)
        if refusal is not None and not self.span:
            raise refusal

    def _values(self, value: float) -> dict[str, float]:
        if self.is_input:
            self.bench = self.bench.with_input(self.item.name, value)
            return self.bench.values(self.parameters)
        return self.bench.values({**self.parameters, self.item.name: value})

    def _rest(self, values: dict[str, float]) -> tuple[Rest | None, str]:
        modes = None if self.last is None else self.last.modes
        rest, reason = maybe_rest(self.bench, values, None, modes)
        if rest is None and modes is not None:
            rest, reason = maybe_rest(self.bench, values)
        self.last = rest
        return rest, reason

    def at(self, value: float) -> ReachPoint:
        """Return what the start ends in at a value of the parameter."""
        try:
            return self._at(value)
        except BondGraphError as error:
            return ReachPoint(value, "refused", note=str(error))

    def _at(self, value: float) -> ReachPoint:
        horizon, until, rtol = self.limits
        values = self._values(value)
        bench = self.bench  # with the value, where it is an input's
        own = bench.start(values, self.initial)
        rest, _ = self._rest(values)
        poles = numpy.zeros(0) if rest is None else rest.poles
        clock = clock_for(poles, horizon, until=until, rtol=rtol)
        if rest is not None and rest.growth >= 0:
            sizes = sizes_of(bench, values, numpy.array([own, rest.vector]))
            own = off_rest(own, rest, pushes(rest, own, sizes))
        first = bench.run(values, own, (0.0, self.span), rtol=rtol, seconds=clock.left)
        self.units = self.units or {n: first.unit(n) for n in bench.model.equations.outputs}
        entered = dict.fromkeys(bench.model.contact_names, 0)
        for event in first.events:
            entered[event.element] += bench.graph[event.element].code(event.to_mode) == 0
        margins = {
            name: 0.0 if entered[name] else float(numpy.abs(first[f"{name}.f"]).min())
            for name, _ in bench.graph.of(DryFriction)
            if name in entered
        }
        points = [own, first.x_end, numpy.abs(first.x).max(axis=1, initial=0.0)]
        sizes = sizes_of(bench, values, numpy.array(points))
        went = settle(bench, values, first.x_end if first.outcome.ok else own, clock, sizes)
        item = described(bench, values, went, "own")
        return ReachPoint(
            value,
            item.kind,
            None if rest is None else rest.stable,
            entered,
            margins,
            item.frequency_hz,
            dict(item.held) if item.kind == "cycle" else {},
            dict(item.amplitudes),
            "; ".join(item.notes),
        )


def input_unit(bench: Bench, name: str) -> str:
    """Return the unit of an input, empty where it has none."""
    return next((unit for s, unit in bench.graph.inputs.items() if s.name == name), "")
