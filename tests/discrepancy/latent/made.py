"""Machines along their own runs, as the smoother takes them, and recordings of machines that lack something."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy

from bondgraph import BondGraph, derive, simulate
from bondgraph.discrepancy.candidates import Effect
from bondgraph.discrepancy.latent.functions import Functions
from bondgraph.discrepancy.latent.grid import grid_of
from bondgraph.discrepancy.latent.probes import Probed, probed
from bondgraph.discrepancy.latent.relax import Course, Record, Relaxed
from bondgraph.discrepancy.latent.table import Table
from bondgraph.simulation import CompiledModel

from ..machines import MACHINES, RUNS

Array = numpy.ndarray


def times(machine: str, count: int) -> Array:
    return numpy.linspace(0, RUNS[machine][0], count)


def drives(machine: str, t: Array, swing: float = 0.0) -> dict[str, tuple[Array, Array]]:
    """Inputs as tables with straight lines between; a second tone where asked for."""
    span, inputs = RUNS[machine]
    found = {}
    for name, function in inputs.items():
        first = numpy.array([function(each) for each in t])
        second = numpy.array([function(0.37 * each + 0.1 * span) for each in t])
        found[name] = (t, first + swing * second)
    return found


def run(graph: BondGraph, t: Array, inputs: Mapping[str, object], **options: object) -> object:
    found = simulate(
        graph, (t[0], t[-1]), inputs=inputs, t_eval=t, rtol=1e-9, atol=1e-12, **options
    )
    assert len(found.t) == len(t)
    return found


def alone(machine: str, effects: Iterable[Effect], count: int) -> tuple[Relaxed, Probed]:
    """Return a machine with probes along its own run, nothing free."""
    graph = MACHINES[machine]()
    probes = probed(graph, effects)
    t = times(machine, count)
    inputs = drives(machine, t)
    model = CompiledModel(probes.graph)
    outputs = tuple(graph.outputs)
    wanted = [probe.parameter for probe in probes.probes]
    functions = Functions(derive(probes.graph), outputs, wanted)
    grid = grid_of(functions.equations, t, inputs)
    found = run(graph, t, inputs)
    measured = numpy.array([found[name] for name in outputs]).T
    record = Record(machine, t, measured, numpy.ones(len(outputs)), inputs)
    names = [state.name for state in functions.equations.states]
    x = numpy.array([found[name] for name in names]).T
    course = Course(record, grid, x, x[0])
    table = Table(model, (), {})
    return Relaxed(
        functions, table, table.start, (course,), 1.0, numpy.eye(len(names)), 0.0
    ), probes


def recording(
    machine: str,
    graph: BondGraph,
    noise: float,
    count: int,
    outputs: Sequence[str] = (),
    swing: float = 0.5,
    seed: int = 1,
) -> Record:
    """Return what a graph does, with noise as a share of each signal's deviation."""
    t = times(machine, count)
    inputs = drives(machine, t, swing)
    found = run(graph, t, inputs)
    names = list(outputs or graph.outputs)
    clean = numpy.array([found[name] for name in names]).T
    std = noise * clean.std(axis=0)
    dirt = numpy.random.default_rng(seed).normal(size=clean.shape)
    return Record(machine, t, clean + std * dirt, std, inputs)
