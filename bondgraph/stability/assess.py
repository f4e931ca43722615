"""Assessment: from a graph to everything that is known about its stability."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ..errors import ParameterError
from ..graph import BondGraph
from ..linear import LinearSystem, Mode, linearize_at, modal_table
from ..smooth import Smooth
from ..steady import SteadyState, steady_state
from ..views import HtmlView
from .advice import advice
from .continuation import Boundary, boundaries
from .derivatives import Forms
from .edges import Edge
from .locus import Locus, trace
from .margins import SPAN, Margin, affordable, margins
from .sensitivity import Sensitivities, sensitivities
from .slopes import incremental_resistances
from .vary import Vary, as_vary
from .verdict import along, critical, is_stable, reasons, verdict

SCHEMA = 1


@dataclass(frozen=True, eq=False)
class StabilityResult(HtmlView):
    """What is known about the stability of a steady state.

    Attributes
    ----------
    graph : BondGraph
    overrides : dict of str to value
        Parameters as the user gave them.
    system : LinearSystem
    rows : tuple of Mode
        The modal table: one an eigenvalue, in the order of ``system.poles()``.
    sensitivities : Sensitivities
        How each eigenvalue moves with each parameter.
    margins : tuple of Margin
        How far each parameter is from its edge, nearest first; empty where not asked for.
    loci : tuple of Locus
    boundaries : tuple of Boundary
        Edges followed in the planes asked for.
    verdict : str
        Two plain sentences, a line each: whether it is stable, and how far the edge is.
    reasons : tuple of str
        Sentences: what decides it.
    advice : tuple of str
        Sentences: what to change.
    warnings : tuple of str
    """

    graph: BondGraph
    overrides: dict[str, Any]
    system: LinearSystem
    rows: tuple[Mode, ...]
    sensitivities: Sensitivities
    margins: tuple[Margin, ...]
    loci: tuple[Locus, ...]
    boundaries: tuple[Boundary, ...]
    verdict: str
    reasons: tuple[str, ...]
    advice: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def model(self) -> str:
        """The model's name."""
        return self.graph.name

    @property
    def point(self) -> SteadyState:
        """The operating point."""
        return self.system.at

    @property
    def stable(self) -> bool:
        """Whether every mode decays."""
        return is_stable(self.rows)

    @property
    def critical(self) -> Mode | None:
        """The mode that decides; None without states."""
        return critical(self.rows) if self.rows else None

    @property
    def edges(self) -> tuple[Edge, ...]:
        """Edges of stability along all varied parameters."""
        return tuple(edge for locus in self.loci for edge in locus.edges)

    def to_json(self) -> dict[str, Any]:
        """Return the result as plain values.

        Returns
        -------
        dict
            Schema 1: model, operating_point, states, eigenvalues, stable, A and
            edges; besides, modes of the contacts, carriers, energies and feeds
            of each eigenvalue, verdict and warnings. All SI; what is not a finite
            number is None.
        """
        return {
            "schema": SCHEMA,
            "model": self.model,
            "operating_point": {**self.point.states, **self.point.outputs},
            "states": list(self.system.states),
            "eigenvalues": [_eigenvalue(mode) for mode in self.rows],
            "stable": self.stable,
            "A": self.system.A.tolist(),
            "edges": [_edge(edge) | _slopes(edge.point) for edge in self.edges],
            "modes": dict(self.point.modes),
            "carriers": [dict(mode.carriers) for mode in self.rows],
            "energies": [dict(mode.energies) for mode in self.rows],
            "feeds": [dict(mode.feeds) for mode in self.rows],
            "sensitivities": self.sensitivities.to_json(),
            "margins": [_margin(item) for item in self.margins],
            "boundaries": [item.to_json() for item in self.boundaries],
            "verdict": self.verdict,
            "reasons": list(self.reasons),
            "advice": list(self.advice),
            "warnings": list(self.warnings),
        }


def assess(
    graph: BondGraph,
    parameters: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, float] | None = None,
    modes: Mapping[str, str] | None = None,
    vary: Iterable[Vary | str | tuple[Any, ...]] = (),
    guess: Mapping[Any, float] | None = None,
    planes: Iterable[tuple[str, str]] = (),
    span: float | None = SPAN,
) -> StabilityResult:
    """Assess the stability of a graph's steady state.

    Parameters
    ----------
    graph : BondGraph
    parameters : mapping, optional
        Values by name or symbol, in SI or with units.
    inputs : mapping, optional
        Constant inputs, zero unless given.
    modes : mapping of str to str, optional
        Modes of the contacts; found unless given.
    vary : iterable of Vary, str or tuple, optional
        Ranges to follow the eigenvalues over: ``("V0", 0.25, 1.5, 200)`` or
        ``"V0=0.25:1.5:200"``.
    guess : mapping, optional
        Start of the search for the operating point, by state.
    planes : iterable of (str, str), optional
        Pairs of varied parameters in whose plane to follow the edges.
    span : float or None
        How far to look for each parameter's edge, as a factor; None not to.

    Returns
    -------
    StabilityResult

    Raises
    ------
    SteadyStateError
        Where the operating point is not found.
    ParameterError
        For unknown or inadmissible parameters and ranges.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> result = assess(bicycle_brake.graph(), {"v_s": 0.2}, vary=["V0=0.9:1.2:50"])
    >>> result.stable, round(result.edges[0].value, 6)
    (False, 1.012035)
    """
    ranges = [as_vary(item) for item in vary]
    point = steady_state(graph, parameters, inputs, modes, guess)
    smooth = Smooth(point.equations, graph, held=point.parameters)
    system = linearize_at(smooth, point)
    overrides = {getattr(key, "name", key): value for key, value in (parameters or {}).items()}
    table = modal_table(system)
    moves = sensitivities(system, Forms(smooth), overrides)
    loci = tuple(trace(graph, point, item, parameters) for item in ranges)
    curves, notes = _boundaries(graph, loci, planes, overrides)
    far: tuple[Margin, ...] | None = None
    left: list[str] = []
    if span is not None:
        names, left = _followed(table, moves)
        far = margins(graph, point, parameters, names, span)
    return StabilityResult(
        graph,
        overrides,
        system,
        table,
        moves,
        far or (),
        loci,
        curves,
        verdict(system, table, far),
        (*reasons(table, incremental_resistances(point)), *map(along, loci)),
        advice(table, moves, far or ()),
        (*_warnings(point, loci), *moves.notes, *notes, *left),
    )


def _followed(modes: tuple[Mode, ...], moves: Sensitivities) -> tuple[tuple[str, ...], list[str]]:
    """Return the parameters to follow to their edges; of very many the strongest."""
    names = moves.moving()
    most = affordable(len(modes))
    if len(names) <= most:
        return names, []
    index = list(modes).index(critical(modes))
    ranked = [item.parameter for item in moves.ranked(index, derived=False, by="growth")]
    return tuple(ranked[:most]), [
        f"margins: {len(names)} parameters move eigenvalues, the {most} that move the critical mode "
        f"most were followed to their edges; vary others by name"
    ]


def _boundaries(
    graph: BondGraph,
    loci: tuple[Locus, ...],
    planes: Iterable[tuple[str, str]],
    overrides: Mapping[str, Any],
) -> tuple[tuple[Boundary, ...], list[str]]:
    """Follow the edges of the loci in the planes asked for."""
    by_name = {locus.name: locus for locus in loci}
    found: list[Boundary] = []
    notes: list[str] = []
    for plane in planes:
        for name in plane:
            if name not in by_name:
                raise ParameterError(
                    f"the plane {' and '.join(plane)} needs a range of {name!r}; vary it"
                )
        ranges = tuple(by_name[name].range for name in plane)
        edges = {name: by_name[name].edges for name in plane}
        curves, said = boundaries(graph, edges, (ranges[0], ranges[1]), overrides)
        found += curves
        notes += said
    return tuple(found), notes


def _warnings(point: SteadyState, loci: Iterable[Locus]) -> tuple[str, ...]:
    said = list(point.equations.warnings)
    if not point.isolated:
        said.append(
            "the operating point is not the only one near by: a state is free to stand anywhere"
        )
    if point.modes:
        said.append(
            "the verdict holds for small motions in which contacts keep their modes; a stick-slip "
            "cycle may live beside a stable steady state: simulate from several starts"
        )
    for locus in loci:
        said += [f"{locus.name}: {text}" for text in _gaps(locus)]
    return tuple(said)


def _gaps(locus: Locus) -> list[str]:
    """Tell of gaps, one sentence for each reason."""
    reasons: dict[str, list[float]] = {}
    for gap in locus.gaps:
        reasons.setdefault(gap.reason, []).append(gap.value)
    return [
        f"left out at {len(values)} of {len(locus.values)} points, from {min(values):.4g} to "
        f"{max(values):.4g} (SI): {reason}"
        for reason, values in reasons.items()
    ]


def _eigenvalue(mode: Mode) -> dict[str, float | None]:
    return {
        "real": mode.eigenvalue.real,
        "imag": mode.eigenvalue.imag,
        "frequency_hz": mode.frequency_hz,
        "damping_ratio": mode.damping_ratio,
    }


def _slopes(point: SteadyState) -> dict[str, dict[str, float | None]]:
    found = incremental_resistances(point)
    return {"slopes": {k: v if math.isfinite(v) else None for k, v in found.items()}}


def _margin(margin: Margin) -> dict[str, Any]:
    return {
        "parameter": margin.parameter,
        "value": margin.value,
        "below": None if margin.below is None else _edge(margin.below),
        "above": None if margin.above is None else _edge(margin.above),
        "ends": list(margin.ends),
    }


def _edge(edge: Edge) -> dict[str, Any]:
    return {
        "kind": edge.kind,
        "parameter": edge.parameter,
        "value": edge.value,
        "frequency_hz": edge.frequency_hz,
        "first_lyapunov": edge.first_lyapunov,
        "onset": None if edge.onset is None else edge.onset.kind,
    }
