"""Isolability: which effects recordings cannot tell apart, and which signals would."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy
import sympy

from ...elements import One, Zero
from ...equations import Equations
from ...graph import BondGraph
from ..screening.classes import SAME, Splitter, ambiguity_classes, splitters
from .functions import Functions
from .linear import along
from .screen import Reduced, Sketch, responses

Array = numpy.ndarray

TWIN = 1 - 1e-6  # of one effect at two sites that are the same place, of which one is kept
SEEN = 1e-9  # of a column that is left beside the others of its candidate


@dataclass(frozen=True, eq=False)
class Isolability:
    """How alike the responses of effects are.

    Attributes
    ----------
    labels : tuple of str
        ``effect at site``, in the order of the screening.
    cosines : (q, q) array
        Between what is left of the responses once the model's own parameters have done what they can;
        1 where one effect can do all that the other does.
    classes : tuple of tuple of str
        Those that cannot be told apart; of two at least.
    hidden : tuple of str
        Effects of which nothing is left.
    """

    labels: tuple[str, ...]
    cosines: Array
    classes: tuple[tuple[str, ...], ...]
    hidden: tuple[str, ...]


def isolability(sketch: Sketch, same: float = SAME) -> Isolability:
    """Compare the responses of all effects at all sites, of each its best form.

    Parameters
    ----------
    sketch : Sketch
    same : float
        Cosine from which on two are one class.

    Returns
    -------
    Isolability

    Notes
    -----
    Effects with several columns are compared by the smallest of the canonical correlations that
    they can have: sharing one column, such as friction with and without a Stribeck part, makes the
    one a case of the other; sharing one of two does not.

    References
    ----------
    Basseville, Nikiforov, Detection of Abrupt Changes, Prentice Hall 1993, ch. 7.
    """
    reduced = _finest(sketch)
    bases: dict[str, Array] = {}
    hidden = []
    for label, index in _chosen(sketch).items():
        basis = _basis(reduced, sketch, index)
        effect = label.partition(" at ")[0]
        twins = (each for name, each in bases.items() if name.partition(" at ")[0] == effect)
        if not basis.shape[1]:
            hidden.append(label)
        elif not any(_likeness(basis, other) > TWIN for other in twins):
            bases[label] = basis
    labels = tuple(bases)
    cosines = numpy.eye(len(labels))
    for i, one in enumerate(labels):
        for j in range(i):
            cosines[i, j] = cosines[j, i] = _likeness(bases[one], bases[labels[j]])
    classes = tuple(
        tuple(labels[i] for i in members)
        for members in ambiguity_classes(cosines, same)
        if len(members) > 1
    )
    return Isolability(labels, cosines, classes, tuple(hidden))


def splitting(
    sketch: Sketch, graph: BondGraph, members: Sequence[str], same: float = SAME
) -> list[Splitter]:
    """Rank signals that are not measured by how well they would split a class.

    Parameters
    ----------
    sketch : Sketch
    graph : BondGraph
        The one that was screened, without probes.
    members : sequence of str
        Labels of one class.
    same : float

    Returns
    -------
    list of Splitter
        Outputs, displacements and what junctions carry; best first, empty where none does.
    """
    known = sketch.relaxed.functions
    equations, names = _wider(known.equations, graph, known.outputs)
    functions = Functions(equations, names, known.wanted)
    found = replace(sketch.relaxed, functions=functions)
    chosen = _chosen(sketch)
    told: list[Array] = []
    own: list[Array] = []
    for course, values in zip(found.courses, sketch.columns.values, strict=True):
        count = len(found.table.used)
        nothing = numpy.zeros((len(course.record.t), len(names)))
        p = found.table.vector(found.values)
        lines, *points = along(functions, course.grid, course.x, p, nothing)
        forced, felt = responses(
            course, lines, (points[0], points[1]), values, sketch.columns, count
        )
        amounts = _mixing(sketch, [chosen[label] for label in members])
        slopes = found.table.slopes(found.values)
        steps = numpy.concatenate([forced @ amounts, lines.forced[:, :, :count] @ slopes], axis=2)
        seen = numpy.concatenate([felt @ amounts, lines.felt[:, :, :count] @ slopes], axis=2)
        moved = numpy.zeros((len(course.grid), *steps.shape[1:]))
        for k, step in enumerate(steps):
            moved[k + 1] = lines.onward[k] @ moved[k] + step
        whole = lines.seen @ moved[course.grid.samples] + seen
        told.append(whole[:, :, : len(members)])
        own.append(whole[:, :, len(members) :])
    extra, parameters = _by_signal(names, told), _by_signal(names, own)
    return splitters(range(len(members)), extra, parameters, same)


def _by_signal(names: Sequence[str], parts: Sequence[Array]) -> Mapping[str, Array]:
    whole = numpy.concatenate(parts)
    return {name: whole[:, i] for i, name in enumerate(names)}


def _finest(sketch: Sketch) -> Reduced:
    """Return what is told where the model errs least: by its runs."""
    return min(sketch.reduced, key=lambda item: item.error)


def _chosen(sketch: Sketch) -> dict[str, int]:
    """Return the best form of each effect at each site, by label."""
    best = {item.candidates[0].label: item.candidates[0].shape for item in sketch.singles}
    found: dict[str, int] = dict.fromkeys(best, -1)
    for index, item in enumerate(sketch.columns.candidates):
        if found.get(item.label, -1) < 0 or item.shape is best.get(item.label):
            found[item.label] = index
    return found


def _basis(reduced: Reduced, sketch: Sketch, index: int) -> Array:
    """Return an orthonormal basis of what a candidate does, a free constant cleared from it."""
    group = list(sketch.columns.groups[index])
    columns = reduced.factor[:, group]
    free = sketch.columns.candidates[index].floats
    if free:
        constant = columns[:, -1:]
        size = float((constant**2).sum())
        columns = columns[:, :-1]
        if size > 0:
            columns = columns - constant @ (constant.T @ columns) / size
    size = numpy.linalg.norm(columns, axis=0)
    columns = columns[:, size > 0] / size[size > 0]
    if not columns.shape[1]:
        return columns
    basis, spread, _ = numpy.linalg.svd(columns, full_matrices=False)
    return basis[:, spread > SEEN * spread[0]]


def _likeness(one: Array, other: Array) -> float:
    found = numpy.linalg.svd(one.T @ other, compute_uv=False)
    return float(min(found.min(), 1.0))


def _mixing(sketch: Sketch, chosen: Sequence[int]) -> Array:
    """Return by how much each column counts in each candidate, (c, q)."""
    mixed = numpy.zeros((len(sketch.columns.probes), len(chosen)))
    amounts = {item.candidates[0].label: item.amounts[0] for item in sketch.singles}
    for j, index in enumerate(chosen):
        group = list(sketch.columns.groups[index])
        mixed[group, j] = amounts.get(sketch.columns.candidates[index].label, 1.0)
    return mixed


def carried(graph: BondGraph) -> tuple[str, ...]:
    """Return the names of what junctions carry: the flow of each 1, the effort of each 0."""
    return tuple(
        f"{label}.{'f' if isinstance(junction, One) else 'e'}"
        for label, junction in graph.of((One, Zero))
    )


def _wider(
    equations: Equations, graph: BondGraph, measured: Sequence[str]
) -> tuple[Equations, tuple[str, ...]]:
    """Return equations with more outputs: displacements and what junctions carry."""
    found: dict[str, sympy.Expr] = {
        state.name: state for state in equations.states if state.name.endswith(".q")
    }
    found |= {name: equations.ports[name] for name in carried(graph) if name in equations.ports}
    outputs = {**equations.outputs, **found}
    names = tuple(name for name in outputs if name not in measured)
    return replace(equations, outputs=outputs), names
