"""Trends: what a tenth more or less of each parameter does to the model's own start."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..errors import BondGraphError, SimulationError
from ..graph import BondGraph
from ..parameters import unknown_name
from ..simulation import CompiledModel
from ..stability.vary import Vary
from .bench import Bench
from .line import Line, input_unit
from .reached import ReachPoint
from .value import number

CHANGE = 0.1
# Of the least slip now, or of the largest swing: what changes less does not change.
SAME = 1e-3
ENDS_WELL, ENDS_BADLY = "steady", ("cycle", "unbounded")


@dataclass(frozen=True)
class Trend:
    """What becomes of the model's own start when one parameter is lowered and raised.

    Attributes
    ----------
    parameter : str
    value : float
        SI.
    unit : str
        The parameter's own, for display.
    meaning : str
    change : float
        By what share it is lowered and raised.
    lower, here, upper : ReachPoint
        What the start ends in at each of the three values.
    """

    parameter: str
    value: float
    unit: str
    meaning: str
    change: float
    lower: ReachPoint = field(repr=False)
    here: ReachPoint = field(repr=False)
    upper: ReachPoint = field(repr=False)

    @property
    def furthers(self) -> int:
        """Which way leads towards vibration: 1 raising it, -1 lowering it, 0 neither or not told.

        First what the start ends in tells; where that is alike, how near contacts come to
        sticking; where they stick either way, how far outputs swing in the end.
        """
        return (
            _sense(_badly(self.lower), _badly(self.upper), 0.0)
            or -_sense(_slip(self.lower), _slip(self.upper), SAME * (_slip(self.here) or 0.0))
            or self._swing()
        )

    @property
    def swings(self) -> tuple[str, float, float, float] | None:
        """The output whose swing changes most, and its swing at the three values, SI."""
        found: tuple[str, float, float, float] | None = None
        most = 0.0
        for name, here in self.here.amplitudes.items():
            sides = [point.amplitudes.get(name) for point in (self.lower, self.upper)]
            low, high = (None if side is None else side.peak_to_peak for side in sides)
            if low is None or high is None or here.peak_to_peak <= 0:
                continue
            moved = abs(high - low) / here.peak_to_peak
            if moved > most:
                found, most = (name, low, here.peak_to_peak, high), moved
        return found

    def _swing(self) -> int:
        if self.swings is None:
            return 0
        _, low, here, high = self.swings
        return _sense(low, high, SAME * here)

    def to_json(self) -> dict[str, Any]:
        """Return plain values in SI; None for what is no number."""
        return {
            "parameter": self.parameter,
            "value": number(self.value),
            "change": self.change,
            "furthers": self.furthers,
            "lower": self.lower.to_json(),
            "here": self.here.to_json(),
            "upper": self.upper.to_json(),
        }


def _badly(point: ReachPoint) -> float | None:
    if point.outcome == ENDS_WELL:
        return 0.0
    return 1.0 if point.outcome in ENDS_BADLY else None


def _slip(point: ReachPoint) -> float | None:
    """Return how near any contact comes to sticking; None where there are none."""
    return min(point.margins.values(), default=None)


def _sense(low: float | None, high: float | None, same: float) -> int:
    if low is None or high is None or abs(high - low) <= same:
        return 0
    return 1 if high > low else -1


def trends(
    graph: BondGraph | CompiledModel,
    parameters: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, float] | None = None,
    names: Iterable[str] | None = None,
    *,
    change: float = CHANGE,
    budget: float = 20.0,
    rtol: float = 1e-8,
) -> tuple[tuple[Trend, ...], tuple[str, ...]]:
    """Run the model's own start with each parameter lowered and raised by a share.

    Eigenvalues tell nothing of how fast a load comes on or how a motion begins; these runs do.

    Parameters
    ----------
    graph : BondGraph or CompiledModel
    parameters : mapping, optional
        Values by name or symbol, in SI or with units.
    inputs : mapping, optional
        Constant inputs, zero unless given.
    names : iterable of str, optional
        Parameters and inputs to move; unless given all parameters with a value that no table
        derives from others. What is zero is left out.
    change : float
        By what share.
    budget : float
        Seconds of the processor for all of it; what is left undone then is told.
    rtol : float
        Of the runs.

    Returns
    -------
    found : tuple of Trend
        In the order of the table.
    notes : tuple of str

    Raises
    ------
    BondGraphError
        For an unknown name, and a model that cannot be run as asked.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> found, notes = trends(bicycle_brake.graph(), names=["tau", "F_k", "V0", "k_f"])
    >>> {item.parameter: item.furthers for item in found}
    {'tau': -1, 'F_k': 1, 'V0': -1, 'k_f': -1}
    """
    if not 0 < change < 1:
        raise SimulationError(f"change is {change!r}; give a share between 0 and 1, such as 0.1")
    bench = Bench(graph, inputs)
    given = {str(getattr(key, "name", key)): value for key, value in (parameters or {}).items()}
    values = bench.values(given)
    table = {symbol.name: row for symbol, row in bench.graph.parameters.items()}
    free = [name for name, row in table.items() if not row.derived or name in given]
    until = time.process_time() + budget
    found: list[Trend] = []
    notes: list[str] = []
    for name in free if names is None else names:
        if name not in table and name not in bench.inputs:
            raise unknown_name("parameter", name, [*table, *bench.inputs])
        value = values.get(name, bench.inputs.get(name))
        if not value:
            continue
        if time.process_time() > until:
            notes.append(f"the {budget:g} s allowed were used up before {name}; raise budget")
            break
        ends = Vary(name, value * (1 - change), value * (1 + change), 2)
        try:
            line = Line(bench, ends, given, None, (None, until, rtol))
        except BondGraphError as error:
            notes.append(f"{name}: {error}")
            continue
        lower, here, upper = (line.at(at) for at in (ends.lo, value, ends.hi))
        row = table.get(name)
        unit = row.unit if row is not None else input_unit(bench, name)
        meaning = "" if row is None else row.meaning
        found.append(Trend(name, value, unit, meaning, change, lower, here, upper))
    return tuple(found), tuple(notes)
