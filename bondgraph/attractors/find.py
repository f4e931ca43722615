"""`find_attractors`: runs from several starts, each until it has settled, and what they end in."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy

from ..cycles import PeriodicOrbit
from ..errors import BondGraphError
from ..graph import BondGraph
from ..simulation import CompiledModel
from ..smooth import Smooth
from .basin import edge_along
from .bench import Bench
from .described import among_many, described, merged, same
from .going_round import verdict
from .pushes import Push, push_along, pushes
from .rest import Rest, maybe_rest, sizes_of
from .settle import Clock, Settled, clock_for, settle
from .starts import off_rest, starts_of
from .value import Attractor, Attractors, Point
from .words import in_words

Array = numpy.ndarray


def find_attractors(
    graph: BondGraph | CompiledModel,
    parameters: Mapping[Any, Any] | None = None,
    inputs: Mapping[Any, float] | None = None,
    *,
    starts: Mapping[str, Mapping[Any, float]] | None = None,
    horizon: float | None = None,
    budget: float = 20.0,
    rtol: float = 1e-8,
    floquet: bool = True,
    edge: bool | Mapping[str, float] = True,
) -> Attractors:
    """Find what a model ends in, from several starts: steady states and cycles.

    Starts are the model's own; its steady state pushed along each oscillation, slightly and as far
    as the next contact or beyond the growth that averaging foresees; the steady state with its
    sliding contacts seized, and with all momentum gone; and those given.

    Parameters
    ----------
    graph : BondGraph or CompiledModel
    parameters : mapping, optional
        Values by name or symbol, in SI or with units.
    inputs : mapping, optional
        Constant inputs, zero unless given.
    starts : mapping of str to mapping, optional
        Further starts by name: states by name to numbers, others as at the model's own start.
    horizon : float, optional
        Longest time a run gets to settle, s of the model; chosen from the eigenvalues unless
        given. Runs in which contacts go on changing their modes get more.
    budget : float
        Seconds of the processor for all of it. What is left undone then is told in `notes`.
    rtol : float
        Of the runs.
    floquet : bool
        Whether to close each cycle by Newton, which gives its multipliers and a sharp period.
    edge : bool or mapping of str to float
        Whether to look for the smallest push that leaves a stable steady state for a cycle: along
        its least damped mode, or along the changes of states given by name.

    Returns
    -------
    Attractors

    Raises
    ------
    BondGraphError
        For a model that cannot be run as asked, and for one whose sources depend on time.

    Notes
    -----
    What no start leads to is not found: that there is one attractor only is not proved.

    Examples
    --------
    >>> from bondgraph.models import bicycle_brake
    >>> found = find_attractors(bicycle_brake.graph(), {"mu_s": 0.5, "tau": 0.02}, edge=False)
    >>> [item.kind for item in found.found], found.beside
    (['cycle', 'steady', 'cycle'], True)
    >>> [round(item.frequency_hz, 2) for item in found.cycles]
    [143.32, 108.63]
    """
    bench = Bench(graph, inputs)
    values = bench.values(parameters)
    until = time.process_time() + budget
    own = bench.start(values)
    rest, reason = maybe_rest(bench, values)
    drift = ", ".join(sorted(bench.free))
    notes = [f"{drift}: drives nothing and may drift, so it was left aside"] if drift else []
    notes += [] if rest is not None else [f"no linear verdict: {reason}"]
    clock = clock_for(_poles(bench, values, rest, own), horizon, until=until, rtol=rtol)
    along = (
        ()
        if rest is None
        else pushes(rest, own, sizes_of(bench, values, numpy.array([own, rest.vector])))
    )
    begins = starts_of(bench, values, rest, along, starts)
    begins = _nudged(begins, rest, along, notes)
    points = [*begins.values(), *([] if rest is None else [rest.vector])]
    sizes = sizes_of(bench, values, numpy.array(points))
    found: list[Attractor] = []
    known: list[tuple[int, PeriodicOrbit]] = []
    ends: dict[str, int] = {}
    for name, x in begins.items():
        if clock.left <= 0:
            left = [other for other in begins if other not in ends]
            notes.append(
                f"the {budget:g} s allowed were used up before the starts {', '.join(left)}; raise budget"
            )
            break
        try:
            went = settle(bench, values, x, clock, sizes, [orbit for _, orbit in known], floquet)
        except BondGraphError as error:
            notes.append(f"start {name!r} could not be run: {error}")
            continue
        ends[name] = _placed(bench, (values, rest), (found, known), went, name, sizes)
    _said(found, rest, notes)
    knock = None
    if edge and rest is not None:
        if not isinstance(edge, bool):
            along = (push_along(rest, edge, own, sizes),)
        knock = _knock(bench, rest, along, (found, known), (clock, sizes), notes)
    result = Attractors(
        model=bench.graph.name,
        parameters=dict(values),
        inputs=dict(bench.inputs),
        point=None if rest is None else _point(rest),
        found=tuple(found),
        starts={
            name: dict(zip(bench.names, map(float, x), strict=True)) for name, x in begins.items()
        },
        ends=ends,
        edge=knock,
        notes=tuple(notes),
        words="",
    )
    return replace(result, words=in_words(result))


def _placed(
    bench: Bench,
    given: tuple[dict[str, float], Rest | None],
    so_far: tuple[list[Attractor], list[tuple[int, PeriodicOrbit]]],
    went: Settled,
    name: str,
    sizes: Array,
) -> int:
    """Put where a run went among the attractors found, and return its place."""
    (values, rest), (found, known) = given, so_far
    place = known[went.known][0] if went.known is not None else None
    if place is None:
        item = among_many(described(bench, values, went, name), rest)
        place = next((i for i, old in enumerate(found) if same(bench, old, item, sizes)), None)
        if place is None:
            found.append(item)
            if went.orbit is not None and verdict(went.orbit) == "stable":
                known.append((len(found) - 1, went.orbit))
            return len(found) - 1
    found[place] = merged(found[place], name)
    return place


def _poles(bench: Bench, values: dict[str, float], rest: Rest | None, own: Array) -> Array:
    """Return the eigenvalues that tell how long runs take; of the start where nothing is steady."""
    if rest is not None:
        return rest.poles
    from ..steady import first_modes

    try:
        modes = first_modes(bench.graph, values, None, {})
        chart = bench.chart(modes, values)
        smooth: Smooth = chart.smooth
        named = dict(zip(bench.names, own, strict=True))
        u = [bench.inputs.get(symbol.name, 0.0) for symbol in chart.equations.inputs]
        p = smooth.vector(values)
        x = smooth.consistent(
            [named[name] for name in chart.states],
            u,
            p,
            numpy.zeros(len(chart.equations.algebraic)),
        )
        if x is None:
            return numpy.zeros(0)
        matrix = smooth.state_matrix(x, u, p)[numpy.ix_(chart.moving, chart.moving)]
        return numpy.linalg.eigvals(matrix) if matrix.size else numpy.zeros(0)
    except (BondGraphError, TypeError, numpy.linalg.LinAlgError):
        return numpy.zeros(0)


def _nudged(
    begins: dict[str, Array], rest: Rest | None, along: tuple[Push, ...], notes: list[str]
) -> dict[str, Array]:
    """Move starts off a steady state that is unstable, where a run would stay for ever."""
    moved = {}
    for name, x in begins.items():
        moved[name] = off_rest(x, rest, along)
        if moved[name] is not x:
            notes.append(
                f"the start {name!r} is the steady state itself, which does not attract; it was pushed "
                f"slightly along its {along[0].label} mode"
            )
    return moved


def _said(found: list[Attractor], rest: Rest | None, notes: list[str]) -> None:
    for item in found:
        if item.kind == "unsettled":
            notes.append(f"from {', '.join(item.starts)}: {item.notes[0]}")
        if item.kind == "stopped":
            notes.append(f"runs from {', '.join(item.starts)} stopped: {item.notes[0]}")
    if rest is not None and rest.growth == 0:
        notes.append(
            "a mode of the steady state neither grows nor decays: the linear part does not decide"
        )


def _knock(
    bench: Bench,
    rest: Rest,
    along: tuple[Push, ...],
    so_far: tuple[list[Attractor], list[tuple[int, PeriodicOrbit]]],
    how: tuple[Clock, Array],
    notes: list[str],
) -> Any:
    (found, known), (clock, sizes) = so_far, how
    others = [item for item in found if item.kind in ("cycle", "unbounded")]
    if not others or rest.growth >= 0 or not along:
        return None
    if clock.left <= 0:
        notes.append("no seconds were left to look for the smallest push that leaves; raise budget")
        return None
    return edge_along(bench, rest, along[0], found, known, clock, sizes)


def _point(rest: Rest) -> Point:
    return Point(
        dict(rest.states),
        dict(rest.outputs),
        dict(rest.modes),
        rest.stable,
        rest.isolated,
        tuple(complex(pole) for pole in rest.poles),
    )
