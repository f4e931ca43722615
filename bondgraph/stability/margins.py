"""Margins: how far each parameter is from the nearest edge of stability."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..errors import BondGraphError
from ..graph import BondGraph
from ..smooth import Smooth
from ..steady import SteadyState
from .continuation import follow_path
from .derivatives import Forms
from .edges import Edge
from .family import Family

# A parameter is followed down to its value over this and up to its value times this.
SPAN = 10.0
# Of the way to an end of that range.
STEP = 0.1
# Following one parameter takes so many seconds, by the number of states: what a few seconds pay for
# is counted rather than timed, so that the same is done on every machine.
SECONDS, ALWAYS, PER_STATE_CUBED, PER_PARAMETER = 5.0, 5, 6e-7, 0.02


@dataclass(frozen=True, eq=False)
class Margin:
    """How far one parameter may go, all others kept, until stability is lost or won.

    Attributes
    ----------
    parameter : str
    value : float
        At the operating point, SI.
    unit : str
        The parameter's own, for display.
    meaning : str
    below, above : Edge or None
        The first edge of stability on the branch of the operating point when the parameter is
        lowered, and raised. A branch may turn round before it meets its edge.
    ends : (str, str)
        Why the search ended below and above where it found no edge; see `Path`.
    """

    parameter: str
    value: float
    unit: str
    meaning: str
    below: Edge | None = field(repr=False)
    above: Edge | None = field(repr=False)
    ends: tuple[str, str]

    @property
    def nearest(self) -> Edge | None:
        """That of both which takes the smaller factor."""
        found = [edge for edge in (self.below, self.above) if edge is not None]
        return min(found, key=self._distance, default=None)

    @property
    def factor(self) -> float | None:
        """The nearest edge's value over the parameter's; None where there is no edge."""
        edge = self.nearest
        return None if edge is None else edge.value / self.value

    @property
    def distance(self) -> float:
        """Size of the logarithm of `factor`; infinite where there is no edge."""
        edge = self.nearest
        return math.inf if edge is None else self._distance(edge)

    def _distance(self, edge: Edge) -> float:
        ratio = edge.value / self.value
        return abs(math.log(ratio)) if ratio > 0 else math.inf


def margins(
    graph: BondGraph,
    point: SteadyState,
    parameters: Mapping[Any, Any] | None = None,
    names: Iterable[str] | None = None,
    span: float = SPAN,
) -> tuple[Margin, ...]:
    """Follow each parameter from an operating point to its first edge of stability, both ways.

    Parameters
    ----------
    graph : BondGraph
    point : SteadyState
    parameters : mapping, optional
        Those that the point was found with.
    names : iterable of str, optional
        Which to follow; unless given all parameters that no table derives from others, and
        inputs. What is zero has no factor and is left out.
    span : float
        Search from the value over this to the value times this.

    Returns
    -------
    tuple of Margin
        Nearest edge first.

    Raises
    ------
    ParameterError
        For a name that is neither parameter nor input.

    Examples
    --------
    >>> from bondgraph import steady_state
    >>> from bondgraph.models import bicycle_brake
    >>> graph = bicycle_brake.graph()
    >>> found = margins(graph, steady_state(graph), names=["V0", "v_s"])
    >>> [(item.parameter, round(item.nearest.value, 6)) for item in found]
    [('V0', 0.322324), ('v_s', 0.172881)]
    """
    overrides = {getattr(key, "name", key): value for key, value in (parameters or {}).items()}
    forms = Forms(Smooth(point.equations, graph, held=overrides))
    chosen = list(names) if names is not None else _free(graph, point, overrides)
    found = []
    for name in chosen:
        own = forms if name in forms.smooth.names or name in point.inputs else None
        family = Family(graph, point, [name], overrides, own)
        if family.at[0]:
            found.append(_margin(family, span))
    return tuple(sorted(found, key=lambda item: item.distance))


def affordable(states: int) -> int:
    """Return how many parameters are followed unless they are named, by the number of states.

    Examples
    --------
    >>> affordable(5), affordable(120)
    (249, 5)
    """
    return max(ALWAYS, int(SECONDS / (PER_PARAMETER + PER_STATE_CUBED * states**3)))


def _free(graph: BondGraph, point: SteadyState, overrides: Mapping[str, Any]) -> list[str]:
    """Return the parameters with a value of their own that the equations rest on, and inputs."""
    used = {symbol.name for symbol in point.equations.parameters}
    waiting = [symbol for symbol in graph.parameters if symbol.name in used]
    while waiting:
        symbol = waiting.pop()
        used.add(symbol.name)
        row = graph.parameters[symbol]
        if row.derived and symbol.name not in overrides:
            waiting += [item for item in row.value.free_symbols if item.name not in used]
    names = [
        symbol.name
        for symbol, row in graph.parameters.items()
        if symbol.name in used and (not row.derived or symbol.name in overrides)
    ]
    return [*names, *point.inputs]


def _margin(family: Family, span: float) -> Margin:
    name, value = family.names[0], float(family.at[0])
    row = family.table.get(name)
    edges: list[Edge | None] = []
    ends: list[str] = []
    near, far = sorted((value / span, value * span))
    for sense, (low, high) in ((-1, (near, value)), (1, (value, far))):
        try:
            path = follow_path(family, low, high, only_first=True, senses=[sense], step=STEP)
        except BondGraphError as error:  # a parameter's own rule, or no Jacobian, on the way
            edges.append(None)
            ends.append(str(error))
            continue
        first = [edge for edge in path.first if edge is not None]
        edges.append(first[0] if first else None)
        ends.append(path.ends[0 if sense < 0 else 1])
    return Margin(
        name,
        value,
        family.units[0],
        "" if row is None else row.meaning,
        edges[0],
        edges[1],
        (ends[0], ends[1]),
    )
