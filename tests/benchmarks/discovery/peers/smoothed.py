"""PySINDy given what this framework's smoother makes of the recordings: signals along courses that a
latent effort at every site keeps near the data, instead of noisy ones."""

from __future__ import annotations

import functools
import json
from pathlib import Path
from typing import Any

import numpy

from bondgraph.discrepancy import Measurement
from bondgraph.discrepancy.candidates.table import effects
from bondgraph.discrepancy.discovery.prepare import prepared
from bondgraph.discrepancy.fitting.unknowns import own_parameters
from bondgraph.discrepancy.latent import probed, relaxed
from bondgraph.simulation import CompiledModel

from ..machines import MACHINES
from . import sindy
from .setups import Columns


def solve(folder: Path) -> dict[str, Any]:
    """Return PySINDy's strongest term beyond the nominal model's, from smoothed signals."""
    return sindy.solve(folder, latent)


@functools.lru_cache
def latent(folder: Path, label: str) -> Columns:
    """Return the measured signals of a recording as the smoother has them."""
    case = json.loads((folder / "case.json").read_text(encoding="utf-8"))
    graph = MACHINES[case["model"]]()
    measurement = Measurement.read(folder / f"{label}.csv", holds=case.get("holds"))
    row, _ = prepared(measurement, graph)
    model, signals = CompiledModel(graph), list(row.signals)
    probes = probed(graph, effects())
    found = relaxed(
        CompiledModel(probes.graph),
        [row.record(signals)],
        signals,
        own_parameters(model),
        [probe.parameter for probe in probes.probes],
        [probe.errs for probe in probes.probes],
        None,
        model,
    )
    t = numpy.concatenate([course.grid.t[course.grid.samples] for course in found.courses])
    outputs = numpy.concatenate([found.said(course) for course in found.courses])
    return {
        name: numpy.interp(measurement.t, t, outputs[:, place])
        for place, name in enumerate(found.functions.outputs)
    }
