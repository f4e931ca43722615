"""Small machines with something missing, recorded with noise."""

from __future__ import annotations

import numpy

from bondgraph import BondGraph, simulate
from bondgraph.discrepancy import Measurement, graft

from ..machines import MACHINES

Array = numpy.ndarray


def push(t: Array, seed: int) -> Array:
    """Four tones about the resonance of `mass_spring`, of about 10 N."""
    rng = numpy.random.default_rng(seed)
    tones = [9.0, 15.0, 21.0, 33.0]
    phases = rng.uniform(0, 2 * numpy.pi, 4)
    return numpy.sum([5 * numpy.sin(w * t + a) for w, a in zip(tones, phases, strict=True)], axis=0)


def lacking(
    effect: str | None = None, site: str = "carriage", values: dict | None = None
) -> BondGraph:
    graph = MACHINES["mass_spring"]()
    return graft(graph, effect, site, parameters=values).graph if effect else graph


def recorded(
    graph: BondGraph,
    seed: int = 0,
    noise: float = 0.01,
    columns: tuple[str, ...] = ("x", "v"),
    span: float = 4.0,
    count: int = 401,
    parameters: dict | None = None,
    name: str | None = None,
) -> Measurement:
    t = numpy.linspace(0, span, count)
    force = push(t, seed)
    run = simulate(
        graph, span, parameters or {}, inputs={"push": (t, force)}, t_eval=t, rtol=1e-8, atol=1e-10
    )
    assert len(run.t) == count
    rng = numpy.random.default_rng(seed + 100)
    noisy = {key: run[key] + noise * run[key].std() * rng.normal(size=count) for key in columns}
    return Measurement(t, {"push": force, **noisy}, name=name or f"run {seed}")
