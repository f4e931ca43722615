"""All that runs tell beside the eigenvalues of one operating point, gathered."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from ..graph import BondGraph
from ..simulation import CompiledModel
from ..stability.vary import Vary, as_vary
from .find import find_attractors
from .reach import reach
from .reached import Reach
from .trends import Trend, trends
from .value import Attractors

# Points of a parameter along which the own start is run.
POINTS = 13
# Seconds of the processor for each of the later parts.
BUDGET = 10.0


@dataclass(frozen=True, eq=False)
class Motions:
    """What a model ends in, and what the end of its own start depends on.

    Attributes
    ----------
    attractors : Attractors
        From several starts.
    reaches : tuple of Reach
        From the own start, along each varied parameter.
    trends : tuple of Trend
        From the own start, for a little more and less of each parameter.
    notes : tuple of str
        What was left undone.
    """

    attractors: Attractors
    reaches: tuple[Reach, ...] = ()
    trends: tuple[Trend, ...] = ()
    notes: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Return plain values: ``attractors``, ``reach``, ``trends``."""
        return {
            "attractors": self.attractors.to_json(),
            "reach": [item.to_json() for item in self.reaches],
            "trends": [item.to_json() for item in self.trends],
        }


def motions(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, float] | None = None,
    vary: Iterable[Vary | str | tuple[Any, ...]] = (),
) -> Motions:
    """Run a model from several starts, along ranges, and with each parameter moved a little.

    Parameters
    ----------
    graph : BondGraph
    parameters : mapping, optional
        Values by name or symbol, in SI or with units.
    inputs : mapping, optional
        Constant inputs, zero unless given.
    vary : iterable of Vary, str or tuple, optional
        Ranges to run the own start along, at no more than 13 points each.

    Returns
    -------
    Motions

    Raises
    ------
    BondGraphError
        For a model that cannot be run, as one without a steady state.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> found = motions(mass_on_belt.graph(), vary=["v_b=0.1:0.6:3"])
    >>> found.attractors.cycles[0].kind, [item.name for item in found.reaches]
    ('cycle', ['v_b'])
    """
    model = CompiledModel(graph)
    attractors = find_attractors(model, parameters, inputs)
    reaches = []
    for item in map(as_vary, vary):
        fewer = replace(item, n=min(item.n, POINTS))
        reaches.append(reach(model, fewer, parameters, inputs, budget=BUDGET))
    moved, notes = trends(model, parameters, inputs, budget=BUDGET)
    return Motions(attractors, tuple(reaches), moved, notes)
