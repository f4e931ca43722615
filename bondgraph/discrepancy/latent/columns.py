"""Columns: what each form of each effect at each site would do to the recordings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy
import sympy

from ..candidates import Effect, Scale
from ..candidates.features import Shape, Signals, turned
from ..candidates.places import OUTPUT, SOURCE
from ..grafting import Site
from .functions import Functions
from .probes import Probe, Probed
from .relax import Relaxed

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Candidate:
    """One form of an effect at a site.

    Attributes
    ----------
    effect : Effect
    site : Site
    shape : Shape
    signals : Signals
        Of the site, in all recordings.
    probe : int
        Which of the probes.
    pair : tuple of str
        The two junctions between which the site is, where it is such a place.
    floats : bool
        Whether a constant stands beside its columns: nothing tells where its displacement begins.
    """

    effect: Effect
    site: Site
    shape: Shape
    signals: Signals
    probe: int
    pair: tuple[str, ...] = ()
    floats: bool = False

    @property
    def label(self) -> str:
        """``effect at site``."""
        return f"{self.effect.name} at {self.site.name}"

    @property
    def scale(self) -> Scale:
        """How large things are at the site."""
        signals = self.signals
        way = signals.displacement - signals.displacement.mean()
        effort, flow, displacement = (
            float(numpy.quantile(numpy.abs(values), 0.95)) if numpy.isfinite(values).all() else 0.0
            for values in (signals.effort, signals.flow, way)
        )
        return Scale(effort or 1.0, flow or 1.0, displacement or 1.0, signals.duration)

    @property
    def signed(self) -> tuple[bool, ...]:
        """Whether amounts below zero are physical, by column."""
        own = [self.shape.signed] * len(self.shape.features)
        return (*own, True) if self.floats else tuple(own)

    def starts(self, amounts: Sequence[float]) -> dict[str, float]:
        """Return the coefficients that amounts of the columns tell."""
        return dict(self.shape.starts(list(map(float, amounts)), self.signals))


@dataclass(frozen=True, eq=False)
class Columns:
    """What candidates do at each time of the courses.

    Attributes
    ----------
    candidates : tuple of Candidate
    groups : tuple of tuple of int
        Columns of each candidate.
    probes : (c,) array of int
        Which probe a column works through.
    rates : (c,) array of bool
        Columns of which the time derivative acts.
    values : tuple of (before, after)
        By course: (nt, c) arrays, just before and after each time.
    """

    candidates: tuple[Candidate, ...]
    groups: tuple[tuple[int, ...], ...]
    probes: Array
    rates: Array
    values: tuple[tuple[Array, Array], ...]


def columns_of(found: Relaxed, probed: Probed, effects: Iterable[Effect]) -> Columns:
    """Evaluate the features of all effects at all sites along courses.

    Parameters
    ----------
    found : Relaxed
        Of the probed graph.
    probed : Probed
    effects : iterable of Effect

    Returns
    -------
    Columns
    """
    known = tuple(effects)
    wanted = {
        f"{i}.{key}": expression
        for i, probe in enumerate(probed.probes)
        for key, expression in probe.signals.items()
        if expression is not sympy.nan
    }
    functions = Functions(found.functions.equations, (), (), wanted)
    tables = {
        side: _evaluated(found, functions, side, list(wanted)) for side in ("before", "after")
    }
    candidates: list[Candidate] = []
    groups: list[tuple[int, ...]] = []
    where: list[int] = []
    rates: list[bool] = []
    parts: dict[str, list[list[Array]]] = {"before": [], "after": []}
    for i, probe in enumerate(probed.probes):
        fitting = [effect for effect in known if probe.site.fits(effect)]
        sides = ("before", "after") if probe.site.kind == SOURCE else ("after",)
        signals = {side: _signals(found, tables[side], i, probe) for side in sides}
        if not all(signals.values()):
            continue
        for effect in fitting:
            for shape in effect.forms:
                if shape.turning and not any(turned(s.displacement) for s in signals["after"]):
                    continue
                made = {side: _features(shape, signals[side]) for side in sides}
                if not all(numpy.isfinite(part).all() for rows in made.values() for part in rows):
                    continue
                if not any(numpy.abs(part).max(initial=0.0) > 0 for part in made["after"]):
                    continue
                floats = shape.floating and not _anchored(found, probe)
                if floats:
                    made = {
                        side: [numpy.column_stack([rows, numpy.ones(len(rows))]) for rows in parts_]
                        for side, parts_ in made.items()
                    }
                first = len(where)
                width = len(shape.features) + floats
                groups.append(tuple(range(first, first + width)))
                where += [i] * width
                rates += [*(feature.rate for feature in shape.features), *([False] * floats)]
                for side in ("before", "after"):
                    parts[side].append(made.get(side, made["after"]))
                whole = signals["after"][0].whole
                assert whole is not None
                candidates.append(Candidate(effect, probe.site, shape, whole, i, floats=floats))
    values = []
    for number, course in enumerate(found.courses):
        empty = numpy.zeros((len(course.grid), 0))
        before, after = (
            numpy.hstack([empty, *(rows[number] for rows in parts[side])])
            for side in ("before", "after")
        )
        values.append((before, after))
    return Columns(
        tuple(candidates),
        tuple(groups),
        numpy.array(where, dtype=int),
        numpy.array(rates, dtype=bool),
        tuple(values),
    )


def _anchored(found: Relaxed, probe: Probe) -> bool:
    """Whether something tells where a site's displacement begins: a state that is felt or said."""
    way = probe.signals.get("displacement")
    if way is None:
        return False
    equations = found.functions.equations
    states = way.xreplace(equations.own_symbols).free_symbols
    used: set[sympy.Basic] = set()
    for expression in (
        *equations.derivatives,
        *(equations.outputs[name] for name in found.functions.outputs),
    ):
        used |= equations.substituted(expression).free_symbols
    return bool(states & used & set(equations.states))


def _evaluated(
    found: Relaxed, functions: Functions, side: str, names: list[str]
) -> list[dict[str, Array]]:
    """Return signals by course."""
    p = found.table.vector(found.values)
    tables = []
    for course in found.courses:
        u = course.grid.before if side == "before" else course.grid.after
        said, rising = functions.signals(course.grid.t, course.x, u, p)
        table = dict(zip(names, said.T, strict=True))
        tables.append(table | {f"{name}'": row for name, row in zip(names, rising.T, strict=True)})
    return tables


def _signals(
    found: Relaxed, tables: list[dict[str, Array]], number: int, probe: Probe
) -> tuple[Signals, ...]:
    """Return the signals of a site by course; none where nothing is known of it."""
    parts = []
    ways: dict[str, float] = {}
    for course, table in zip(found.courses, tables, strict=True):
        given = {
            key: table[f"{number}.{key}"] for key in probe.signals if f"{number}.{key}" in table
        }
        for key, rate in (("flow", "rate"), ("effort", "effort_rate")):
            # what a sensor says late is what it said, not what the model would have it say
            if f"{number}.{key}'" in table and probe.site.kind != OUTPUT:
                given[rate] = table[f"{number}.{key}'"]
        if not given:
            return ()
        made = Signals.of(course.grid.t, **given)
        if "displacement" not in given and "flow" in given:
            # sections of one recording go on where the one before ended
            begun = ways.get(course.record.name, 0.0)
            ways[course.record.name] = begun + float(made.displacement[-1])
            made = Signals.of(course.grid.t, **given, displacement=made.displacement + begun)
        parts.append(made)
    return Signals.together(parts)


def _features(shape: Shape, parts: Sequence[Signals]) -> list[Array]:
    with numpy.errstate(all="ignore"):
        return [
            numpy.column_stack([feature.evaluate(part) for feature in shape.features])
            for part in parts
        ]
