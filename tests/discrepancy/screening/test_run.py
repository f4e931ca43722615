"""Screening of whole models: banks of probes, and effects found where they were put."""

import numpy as np
import pytest

from bondgraph import Samples, simulate
from bondgraph.discrepancy import Measurement
from bondgraph.discrepancy.candidates import EFFECTS
from bondgraph.discrepancy.grafting import graft, sites
from bondgraph.discrepancy.screening import bank, screen
from bondgraph.errors import MeasurementError

from .. import machines


@pytest.mark.parametrize("name", machines.MACHINES)
def test_a_bank_moves_as_the_model_without_it(name):
    graph = machines.MACHINES[name]()
    found = bank(graph)
    assert found.probes and not found.refused
    assert {probe.site for probe in found.probes} <= {site.name for site in sites(graph)}
    span, times = machines.RUNS[name][0], np.linspace(0, machines.RUNS[name][0], 21)
    runs = [
        simulate(g, span, inputs=machines.samples(name), t_eval=times, rtol=1e-9)
        for g in (graph, found.graph)
    ]
    for output in graph.outputs:
        size = np.ptp(runs[0][output])
        assert np.abs(runs[0][output] - runs[1][output]).max() <= 1e-6 * size


def recorded(name, effect, site, noise=0.02):
    """A recording of a machine with an effect that the model has not."""
    graph, (span, inputs) = machines.MACHINES[name](), machines.RUNS[name]
    span, size = 4 * span, 2001
    t = np.linspace(0, span, size)
    swell = 1 + 0.5 * np.sin(14 * t / span)
    drive = {key: [f(x) for x in t] * swell for key, f in inputs.items()}
    domain = next(s.domain for s in sites(graph) if s.name == site)
    truth = graft(graph, effect, site, scale=machines.scale_at(name, domain)).graph
    run = simulate(truth, span, inputs={k: Samples(t, v) for k, v in drive.items()}, t_eval=t)
    rng = np.random.default_rng(1)
    columns = {o: run[o] + noise * run[o].std() * rng.normal(size=size) for o in graph.outputs}
    return graph, Measurement(t, columns | drive, name=f"{effect} at {site}")


@pytest.mark.parametrize(
    ("name", "effect", "site"),
    [
        ("mass_spring", "coulomb_friction", "carriage"),
        ("mass_spring", "quadratic_drag", "carriage"),
        ("mass_spring", "cubic_stiffness", "carriage"),
        ("two_mass_chain", "coulomb_friction", "second"),
        ("two_mass_chain", "viscous_damping", "second"),
    ],
)
def test_the_effect_put_in_comes_first(name, effect, site):
    graph, measurement = recorded(name, effect, site)
    found = screen(graph, [measurement])
    best = found.rows[0]
    assert f"{effect} at {site}" in (best.name, *best.alike)
    assert best.physical and best.gain > 20 and found.ratio > 1


def test_a_parameter_that_is_wrong_is_no_effect():
    graph, measurement = recorded("mass_spring", "viscous_damping", "carriage")
    found = screen(graph, [measurement])
    (row,) = [row for row in found.rows if row.effect == "viscous_damping"]
    assert row.gain == 0 and np.isnan(row.value)  # the damper can do all of it
    held = screen(graph, [measurement], free=["m", "k"])
    assert held.rows[0].effect == "viscous_damping"


def test_users_bring_their_own_and_choose():
    graph, measurement = recorded("mass_spring", "coulomb_friction", "carriage")
    some = [EFFECTS["quadratic_drag"], EFFECTS["coulomb_friction"]]
    found = screen(graph, [measurement], effects=some)
    assert [row.effect for row in found.rows] == ["coulomb_friction", "quadratic_drag"]
    assert found.chosen(most=1)[0].effect == "coulomb_friction"


def test_nothing_in_common_is_refused():
    graph = machines.MACHINES["mass_spring"]()
    with pytest.raises(MeasurementError):
        screen(graph, [Measurement([0, 1, 2], {"pressure": [1, 2, 3]})])
