"""Fits that let the model err less and less, from starts that are 30 % off."""

import numpy
import pytest

from bondgraph import simulate
from bondgraph.discrepancy.fitting import fit
from bondgraph.discrepancy.grafting import graft
from bondgraph.discrepancy.latent import Record, eased
from bondgraph.discrepancy.measurement import Measurement
from bondgraph.simulation import CompiledModel, Samples
from bondgraph.values import parameter_values

from ..discovery.recordings import drives
from ..machines import MACHINES


def _off(true, seed):
    rng = numpy.random.default_rng(seed)
    return {name: value * 1.3 ** rng.choice([-1, 1]) for name, value in true.items()}


def test_a_stiffness_is_found_over_many_cycles():
    """32 cycles: a run whose frequency is 14 % off is out of step for most of them."""
    graph = MACHINES["mass_spring"]()
    t = numpy.linspace(0, 10, 1001)
    push = 8 * numpy.sin(9 * t)
    true = {"m": 2.0, "k": 800.0, "b": 0.6}
    inputs = {"push": (t, push)}
    run = simulate(graph, 10, true, inputs=inputs, t_eval=t, rtol=1e-9, atol=1e-12)
    names = ["x", "v"]
    clean = numpy.array([run[name] for name in names]).T
    std = 0.02 * clean.std(axis=0)
    measured = clean + std * numpy.random.default_rng(4).normal(size=clean.shape)
    start = {"m": 2.0, "k": 800 * 1.3, "b": 0.6 * 1.3}
    record = Record("bench", t, measured, std, inputs)
    model = CompiledModel(graph)
    found = eased(model, [record], names, ["k", "b"], start, {("mass.p", "mass.p"): 100.0})
    values = found.table.given(found.values)
    assert values["k"] == pytest.approx(800, rel=0.005)

    columns = {"push": push, **dict(zip(names, measured.T, strict=True))}
    bench = Measurement(t, columns, initial={"spring.q": 0.01, "mass.p": 0.0})
    then = fit(model, bench, ["k", "b"], parameters=values, segments=None, loss="linear")
    assert then.values["k"] == pytest.approx(800, rel=1e-3)
    assert then.values["b"] == pytest.approx(0.6, rel=0.05)


@pytest.mark.parametrize("seed", [0, 5])
def test_slack_and_stiffness_of_a_belt_are_found_with_the_drives_own_parameters(seed):
    """Recorded by the leapfrog of `drives`, the law written out there."""
    (measurement,), _ = drives.simulate(3)
    names = ["w1", "w2"]
    measured = numpy.array([measurement.columns[name] for name in names]).T
    volts = Samples(measurement.t, measurement.columns["volts"], "zero")
    std = 0.01 * measured.std(axis=0)
    record = Record("belt", measurement.t, measured, std, {"volts": volts})
    grown = graft(drives.graph(), "dead_zone", "stretch")
    model = CompiledModel(grown.graph)
    true = dict(drives.EXPECTED.truth) | {
        grown.parameters["stiffness"]: drives.STIFFER,
        grown.parameters["width"]: drives.SLACK,
    }
    start = parameter_values(model.equations, {}, model.resolver) | _off(true, seed)
    ways = {("rotor.p", "rotor.p"): 1.0, ("pulley.p", "pulley.p"): 1.0}
    found = eased(model, [record], names, list(true), start, ways)
    values = found.table.given(found.values)
    assert {name: values[name] / true[name] for name in true} == pytest.approx(
        dict.fromkeys(true, 1.0), abs=0.05
    )
