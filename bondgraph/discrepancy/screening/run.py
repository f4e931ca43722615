"""`screen`: recordings and a model in, a ranking of effects and sites out."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy

from ...errors import BondGraphError
from ...graph import BondGraph
from ...simulation import CompiledModel, simulate
from ..candidates import Effect, Scale
from ..candidates.places import FLOW_JUNCTION, FLOW_PAIR, JUNCTIONS
from ..fitting.unknowns import own_parameters
from ..grafting import Site, sites
from ..measurement import Matched, Measurement, matched
from ..measurement.noise import noise_floor
from .bank import Bank, Probe, bank
from .classes import ambiguity_classes
from .segments import Record, Segmented, best_length

Array = numpy.ndarray


@dataclass(frozen=True)
class Row:
    """One effect at one site.

    Attributes
    ----------
    effect, site, coefficient : str
    gain : float
        Drop of chi squared, to first order.
    share : float
        The same as a share of what the parameters leave.
    value, std : float
        Of the coefficient; NaN where the parameters can do all that the effect can.
    physical : bool
        Whether the sign is one that such an element can have.
    alike : tuple of str
        Others that the data cannot tell from it, as ``effect at site``.
    """

    effect: str
    site: str
    coefficient: str
    gain: float
    share: float
    value: float
    std: float
    physical: bool
    alike: tuple[str, ...]

    @property
    def name(self) -> str:
        """``effect at site``."""
        return f"{self.effect} at {self.site}"


@dataclass(frozen=True, eq=False)
class Screening:
    """What each effect at each site would explain, best first.

    Attributes
    ----------
    rows : tuple of Row
    ratio : float
        Chi squared over the number of samples before: 1 where nothing is left to explain.
    length : float
        Of the segments that the recordings were followed in, s.
    noise : tuple of mapping of str to float
        Standard deviation of each signal, by recording, SI.
    free : tuple of str
        Parameters that could explain as well.
    bank : Bank
    segmented : Segmented
    warnings : tuple of str
    """

    rows: tuple[Row, ...]
    ratio: float
    length: float
    noise: tuple[Mapping[str, float], ...]
    free: tuple[str, ...]
    bank: Bank
    segmented: Segmented
    warnings: tuple[str, ...]

    def chosen(self, most: int = 3, least: float = 10.0) -> tuple[Row, ...]:
        """Return effects that explain together, each the best on what those before it leave."""
        found = self.segmented.chosen(most=most, least=least)
        named = {(row.effect, row.site, row.coefficient): row for row in self.rows}
        probes = (self.bank.probes[index] for index, _ in found)
        return tuple(named[probe.effect, probe.site, probe.coefficient] for probe in probes)


def screen(
    graph: BondGraph,
    measurements: Sequence[Measurement],
    *,
    free: Iterable[str] | None = None,
    parameters: Mapping[str, float] | None = None,
    noise: Mapping[str, float] | None = None,
    effects: Iterable[Effect] | None = None,
    lengths: Sequence[float] | None = None,
    time_budget: float = 600.0,
) -> Screening:
    """Score every effect at every site of a model on recordings.

    Parameters
    ----------
    graph : BondGraph
    measurements : sequence of Measurement
    free : iterable of str, optional
        The model's parameters that may be wrong; all that have a number of their own unless given.
    parameters : mapping, optional
        Values to use, SI, such as those of a fit.
    noise : mapping of str to float, optional
        Standard deviation of signals, SI; estimated from differences unless given.
    effects : iterable of Effect, optional
        The whole library unless given.
    lengths : sequence of float, optional
        Of segments to try, s.
    time_budget : float
        Seconds for each length.

    Returns
    -------
    Screening

    Raises
    ------
    BondGraphError
        Where the model, the recordings and their names do not go together.

    Examples
    --------
    A carriage with quadratic drag, in a model that knows of viscous drag only:

    >>> import sympy
    >>> from bondgraph import I, One, R, Samples, Se, assemble
    >>> b, push = sympy.Symbol("b", positive=True), sympy.Symbol("push")
    >>> v = One("v")
    >>> def carriage(drag):
    ...     film = R("film", effort=lambda f: b * f + drag * f * abs(f))
    ...     return assemble("carriage", Se("motor", push) >> v >> (I("m", 1), film),
    ...         parameters={b: 0.5}, inputs=[push], outputs={"speed": v.f})
    >>> t = numpy.linspace(0, 20, 1001)
    >>> force = 3 * numpy.sin(t) + 2 * numpy.sin(0.37 * t)
    >>> run = simulate(carriage(0.4), 20, inputs={"push": (t, force)}, t_eval=t)
    >>> noisy = run["speed"] + 0.01 * numpy.random.default_rng(0).normal(size=len(t))
    >>> found = screen(carriage(0), [Measurement(t, {"push": force, "speed": noisy})])
    >>> found.rows[0].name, found.rows[0].physical
    ('quadratic_drag at v', True)
    """
    fitted = [matched(measurement, graph) for measurement in measurements]
    base = CompiledModel(graph)
    probes = bank(graph, effects, scales_of(base, fitted[0], parameters))
    model = CompiledModel(probes.graph)
    own = tuple(free) if free is not None else own_parameters(base)
    records = [_record(item, noise or {}) for item in fitted]
    names = [probe.parameter for probe in probes.probes]
    found = best_length(
        model,
        records,
        own,
        names,
        lengths=lengths,
        parameters=parameters,
        time_budget=time_budget,
    )
    warnings = [word for item in fitted for word in item.warnings]
    warnings += [f"{site} takes no probe: {why}" for site, why in probes.refused]
    return Screening(
        rows=tuple(_rows(found, probes.probes)),
        ratio=found.scores().rest / max(found.count, 1),
        length=found.length,
        noise=tuple(record.noise for record in records),
        free=own,
        bank=probes,
        segmented=found,
        warnings=tuple(dict.fromkeys(warnings)),
    )


def _record(item: Matched, noise: Mapping[str, float]) -> Record:
    """Return a recording with the noise of its signals."""
    measurement = item.measurement
    spread = {}
    for name, values in item.outputs.items():
        if name in noise:
            spread[name] = noise[name]
            continue
        plain = Measurement(item.t, {name: values}, name=measurement.name)
        least = 1e-6 * float(numpy.nanstd(values)) or 1e-12  # rounding is noise too
        spread[name] = max(noise_floor(plain, name).std, least)
    return Record(item.t, item.outputs, spread, item.inputs, item.initial)


def _rows(found: Segmented, probes: Sequence[Probe]) -> list[Row]:
    scores = found.scores()
    classes = {i: c for c in ambiguity_classes(scores.correlation) for i in c}
    labels = [f"{probe.effect} at {probe.site}" for probe in probes]
    share = scores.share
    rows = []
    for i in scores.order():
        probe, value = probes[i], float(scores.coefficient[i])
        rows.append(
            Row(
                probe.effect,
                probe.site,
                probe.coefficient,
                float(scores.gain[i]),
                float(share[i]),
                value,
                float(scores.std[i]),
                probe.signed or not value < 0,
                tuple(labels[j] for j in classes[i] if j != i),
            )
        )
    return rows


def scales_of(
    model: CompiledModel, item: Matched, parameters: Mapping[str, float] | None = None
) -> dict[str, Scale]:
    """Return how large things are at each junction, along a run of the model.

    Parameters
    ----------
    model : CompiledModel
    item : Matched
        For its inputs and times.
    parameters : mapping, optional

    Returns
    -------
    dict of str to Scale
        By site; without those where nothing moves.
    """
    try:
        run = simulate(model, item.span, parameters, item.initial, item.inputs, t_eval=item.t)
    except BondGraphError:  # what is wrong is said where the recording is followed
        return {}
    found = {}
    for site in sites(model.equations.graph):
        if site.kind not in JUNCTIONS:
            continue
        signals = [_ports(run, label) for label in site.at]
        efforts = [effort for effort, _ in signals if effort is not None]
        flows = [flow for _, flow in signals if flow is not None]
        shared = flows if site.kind in (FLOW_JUNCTION, FLOW_PAIR) else efforts
        if len(shared) != len(site.at):
            continue
        scale = _scale(site, run.t, shared, efforts)
        if scale is not None:
            found[site.name] = scale
    return found


def _ports(run: Any, label: str) -> tuple[Array | None, Array | None]:
    """Effort and flow of the bonds of a junction, as far as they have names."""
    graph, names = run.model.equations.graph, run.model.equations.ports
    found: list[Array | None] = [None, None]
    for bond in graph.bonds_of(label):
        other = bond.head if bond.tail == label else bond.tail
        for place, letter in enumerate("ef"):
            if found[place] is None and f"{other}.{letter}" in names:
                found[place] = run[f"{other}.{letter}"]
    return found[0], found[1]


def _scale(site: Site, t: Array, shared: Sequence[Array], efforts: Sequence[Array]) -> Scale | None:
    moved = shared[0] - shared[1] if len(shared) == 2 else shared[0]
    felt = max((_size(effort) for effort in efforts), default=0.0)
    size, span = _size(moved), float(t[-1] - t[0])
    if not size > 0:
        return None
    if site.kind not in (FLOW_JUNCTION, FLOW_PAIR):
        return Scale(effort=size, flow=1.0, displacement=span, duration=span)
    way = numpy.concatenate([[0.0], numpy.cumsum(0.5 * (moved[1:] + moved[:-1]) * numpy.diff(t))])
    stroke = 0.5 * float(numpy.ptp(way))
    return Scale(felt or 1.0, size, stroke if stroke > 0 else size * span, span)


def _size(values: Array) -> float:
    finite = numpy.abs(values[numpy.isfinite(values)])
    size = float(numpy.quantile(finite, 0.95)) if len(finite) else 0.0
    return size if math.isfinite(size) else 0.0
