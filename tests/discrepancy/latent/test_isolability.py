"""Classes of effects that recordings cannot tell apart, against runs of grown graphs and on paper."""

import numpy
import pytest

from bondgraph.discrepancy.candidates import EFFECTS
from bondgraph.discrepancy.grafting import graft
from bondgraph.discrepancy.latent import probed, relaxed, sketched
from bondgraph.discrepancy.latent.isolability import isolability, splitting
from bondgraph.simulation import CompiledModel

from ..machines import MACHINES
from .made import drives, recording, run, times


def _sketch(machine, names, outputs, count=400):
    nominal = MACHINES[machine]()
    known = [EFFECTS[name] for name in names]
    probes = probed(nominal, known)
    found = relaxed(
        CompiledModel(probes.graph),
        [recording(machine, nominal, 0.003, count, outputs)],
        outputs,
        [symbol.name for symbol in nominal.parameters],
        [probe.parameter for probe in probes.probes],
        [probe.errs for probe in probes.probes],
        runs=CompiledModel(nominal),
    )
    return sketched(found, probes, known)


FORCE, OFFSET = "effort_bias at carriage", "sensor_bias at output x"


@pytest.fixture(scope="module")
def biased():
    names = ("sensor_bias", "effort_bias", "quadratic_drag", "cubic_stiffness")
    return _sketch("mass_spring", names, ("x",))


def test_an_offset_and_a_force_are_one_class_where_only_the_position_is_known(biased):
    """k x = F at rest, and how the run starts is open."""
    found = isolability(biased)
    assert found.classes == (tuple(sorted((FORCE, OFFSET), key=found.labels.index)),)
    at = [found.labels.index(label) for label in (FORCE, OFFSET)]
    assert found.cosines[at[0], at[1]] > 0.98
    assert numpy.allclose(found.cosines, found.cosines.T)


def test_the_true_position_would_split_them(biased):
    assert "spring.q" in [
        item.signal for item in splitting(biased, MACHINES["mass_spring"](), (FORCE, OFFSET))
    ]


def test_a_weaker_demand_makes_larger_classes(biased):
    assert not isolability(biased, 1.0).classes
    (whole,) = isolability(biased, -1.0).classes
    assert set(whole) == set(isolability(biased).labels)


def test_cosines_are_those_of_runs_of_grown_graphs():
    """Two drags on a chain whose own numbers are known: columns by differences of simulations."""
    machine, outputs = "two_mass_chain", ("v1", "v2")
    little = {
        "viscous_damping at first": ("viscous_damping", "first", {"damping": 1e-4}),
        "viscous_damping at second": ("viscous_damping", "second", {"damping": 1e-4}),
        "quadratic_drag at second": ("quadratic_drag", "second", {"drag": 1e-4}),
    }
    nominal = MACHINES[machine]()
    known = [EFFECTS["viscous_damping"], EFFECTS["quadratic_drag"]]
    probes = probed(nominal, known)
    record = recording(machine, nominal, 0.05, 400)  # runs count, not how the model may err
    start = dict.fromkeys((s.name for s in CompiledModel(nominal).equations.states), 0.0)
    record = type(record)(**{**vars(record), "initial": start})
    found = relaxed(
        CompiledModel(probes.graph),
        [record],
        outputs,
        [],
        [probe.parameter for probe in probes.probes],
        [probe.errs for probe in probes.probes],
        runs=CompiledModel(nominal),
    )
    told = isolability(sketched(found, probes, known))
    t = times(machine, 400)
    inputs = drives(machine, t, 0.5)
    plain = run(nominal, t, inputs)
    columns = {}
    for label, (name, site, values) in little.items():
        other = run(graft(nominal, name, site, parameters=values).graph, t, inputs)
        columns[label] = numpy.concatenate(
            [
                (other[key] - plain[key]) / std
                for key, std in zip(outputs, record.noise, strict=True)
            ]
        )
    for one in columns:
        for other in columns:
            a, b = columns[one], columns[other]
            expected = abs(a @ b) / numpy.sqrt((a @ a) * (b @ b))
            cosine = told.cosines[told.labels.index(one), told.labels.index(other)]
            assert cosine == pytest.approx(expected, abs=0.02)
