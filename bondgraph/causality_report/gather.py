"""From equations to the report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import networkx

from ..causality import CausalGraph, Reason, Stroke
from ..elements import C, Junction, One, Storage
from ..equations import Equations, derive
from ..graph import BondGraph
from .constraints import Constraints
from .mode_table import mode_table, possible_modes
from .remedies import remedy
from .value import (
    BondCausality,
    CausalityReport,
    JunctionDecision,
    LoopReport,
    Reduction,
    StorageCausality,
)


def report_causality(
    graph: BondGraph | CausalGraph | Equations, *, modes: bool = True
) -> CausalityReport:
    """Gather all that causality decided, why, and what was done about it.

    Parameters
    ----------
    graph : BondGraph, CausalGraph or Equations
        What is not derived yet is derived.
    modes : bool
        Whether to derive the modes of switching elements one by one.

    Returns
    -------
    CausalityReport

    Raises
    ------
    BondGraphError
        Where the equations cannot be derived.

    References
    ----------
    Karnopp, Margolis, Rosenberg, System Dynamics, ch. 5: causality, derivative
    causality and algebraic loops.

    Examples
    --------
    >>> from bondgraph import I, One, R, Se, assemble
    >>> v = One("v")
    >>> pair = assemble("pair", Se("F", 1) >> v >> (I("a", 2), I("b", 3), R("r", 1)))
    >>> report = report_causality(pair)
    >>> report.junctions[0].decided_by, report.dependent[0].expanded, report.reductions[0].value
    ('a', 3*a.p/2, 5)
    """
    equations = graph if isinstance(graph, Equations) else derive(graph)
    causal, plain = equations.causal, equations.graph
    strokes = _strokes(causal)
    constraints = Constraints(equations)
    bound = {name: _bound_by(equations, constraints, name) for name in equations.dependent}
    reductions = constraints.reductions(bound)
    return CausalityReport(
        model=plain.name,
        bonds=tuple(_bonds(causal)),
        junctions=tuple(_junctions(causal, strokes)),
        storages=tuple(
            _storage(
                equations, constraints, strokes[name][0], name, bound.get(name, ()), reductions
            )
            for name, _ in plain.of(Storage)
        ),
        reductions=reductions,
        loops=tuple(
            LoopReport(
                loop.kind,
                loop.variables,
                loop.tearing,
                loop.solved,
                remedy(equations, strokes, loop),
            )
            for loop in equations.loops
        ),
        signals=plain.signals,
        input_rates=tuple((s.name, rate.name) for s, rate in equations.input_rates.items()),
        turned=plain.notes,
        parts=_parts(plain),
        modes=mode_table(equations) if modes else (),
        possible_modes=possible_modes(equations),
    )


def _bonds(causal: CausalGraph) -> Iterator[BondCausality]:
    for bond, stroke in zip(causal.graph.bonds, causal.strokes, strict=True):
        yield BondCausality(
            bond.name,
            bond.tail,
            bond.head,
            stroke.effort_out_of,
            stroke.flow_out_of,
            stroke.reason.value,
            stroke.because,
        )


def _strokes(causal: CausalGraph) -> dict[str, list[Stroke]]:
    """Return the strokes of each element's bonds, in the order written."""
    found: dict[str, list[Stroke]] = {name: [] for name in causal.graph.elements}
    for bond, stroke in zip(causal.graph.bonds, causal.strokes, strict=True):
        found[bond.tail].append(stroke)
        found[bond.head].append(stroke)
    return found


def _junctions(
    causal: CausalGraph, strokes: Mapping[str, list[Stroke]]
) -> Iterator[JunctionDecision]:
    """Find the one bond of each junction that brings what it shares."""
    for name, junction in causal.graph.of(Junction):
        # the effort of a 0 comes out of the other end, the flow of a 1 as well
        stroke = next(
            stroke
            for stroke in strokes[name]
            if (stroke.effort_out_of == name) == isinstance(junction, One)
        )
        because = stroke.because
        own = f"through {junction.kind} {name!r}"
        if stroke.reason is Reason.PROPAGATED and because.startswith(own):
            because = f"all other bonds take it, so this one has to decide; {because}"
        yield JunctionDecision(
            name,
            junction.kind,
            junction.shared,
            stroke.bond,
            _other(stroke, name),
            because,
            tuple(_other(other, name) for other in strokes[name] if other is not stroke),
        )


def _other(stroke: Stroke, name: str) -> str:
    return stroke.flow_out_of if stroke.effort_out_of == name else stroke.effort_out_of


def _state_name(equations: Equations, name: str) -> str:
    letter = "q" if isinstance(equations.graph.elements[name], C) else "p"
    return equations.ports[f"{name}.{letter}"].name


def _bound_by(equations: Equations, constraints: Constraints, name: str) -> tuple[str, ...]:
    return constraints.bound_by(equations.dependent[name], besides=[name])


def _storage(
    equations: Equations,
    constraints: Constraints,
    stroke: Stroke,
    name: str,
    bound_by: tuple[str, ...],
    reductions: tuple[Reduction, ...],
) -> StorageCausality:
    element = equations.graph.elements[name]
    assert isinstance(element, Storage)
    state, bond, because = _state_name(equations, name), stroke.bond, stroke.because
    if name not in equations.dependent:
        return StorageCausality(name, element.kind, state, True, bond, because)
    constraint = equations.dependent[name]
    expanded = constraints.expanded(constraint)
    itself = equations.ports[state]
    return StorageCausality(
        name,
        element.kind,
        state,
        False,
        bond,
        because,
        None if constraint == itself else constraint,
        None if expanded == itself else expanded,
        bound_by,
        _done(equations, name, state, reductions),
        element.initial != 0,
    )


def _done(equations: Equations, name: str, state: str, reductions: tuple[Reduction, ...]) -> str:
    """Say what the equations do about a dependent storage."""
    conjugate = "f" if isinstance(equations.graph.elements[name], C) else "e"
    answer, rate = equations.ports[f"{name}.{conjugate}"], f"der({state})"
    said = [f"the rate {rate} is worked out from the constraint, and is {answer}"]
    if state in map(str, equations.algebraic):
        said = [f"{state} is kept as an algebraic variable; {answer} is its rate {rate}"]
    for loop in equations.loops:
        if rate in loop.variables:
            how = "solved for" if loop.solved == "linear" else "kept implicit in"
            said.append(f"this closes a loop of rates, {how} {', '.join(loop.tearing)}")
    for reduction in reductions:
        if name in reduction.carried:
            said.append(
                f"seen from {reduction.storage} all together are one {reduction.quantity} of {reduction.value}"
            )
    return "; ".join(said)


def _parts(graph: BondGraph) -> tuple[tuple[str, ...], ...]:
    """Return the elements of each part that neither bonds nor signals join to the rest."""
    network = networkx.Graph()
    network.add_nodes_from(graph.elements)
    network.add_edges_from((bond.tail, bond.head) for bond in graph.bonds)
    network.add_edges_from((signal.source, signal.target) for signal in graph.signals)
    parts = list(networkx.connected_components(network))
    if len(parts) < 2:
        return ()
    return tuple(tuple(name for name in graph.elements if name in part) for part in parts)
