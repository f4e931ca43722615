"""What a column does along a run, against difference quotients of runs of the grown graph.

The chain of probe, column and linearised model has to say what the element itself does when a little of
it is grown into the graph and the graph is simulated.
"""

import numpy
import pytest

from bondgraph.discrepancy.candidates import EFFECTS
from bondgraph.discrepancy.grafting import graft
from bondgraph.discrepancy.latent.columns import columns_of
from bondgraph.discrepancy.latent.screen import responses

from ..machines import MACHINES
from .made import alone, drives, run, times

COUNT = 601
# machine, effect, site, coefficient that is a little off its absence, how little
CASES = [
    ("mass_spring", "viscous_damping", "carriage", {"damping": 1e-4}),
    ("two_mass_chain", "viscous_damping", "between first and second", {"damping": 1e-4}),
    ("two_mass_chain", "effort_bias", "second", {"effort": 1e-4}),
    ("dc_motor", "quadratic_drag", "wheel", {"drag": 1e-7}),
    ("mass_spring", "cubic_stiffness", "carriage", {"cubic": 1.0}),
    ("two_tanks", "leakage", "first", {"conductance": 1e-12}),
    ("two_tanks", "leakage", "between first and second", {"conductance": 1e-12}),
    ("two_tanks", "flow_bias", "second", {"flow": 1e-10}),
    ("mass_spring", "sensor_bias", "output x", {"offset": 1e-6}),
    ("rlc", "nonlinear_inertance", "inertia coil", {"cubic": 1.0}),
    ("two_mass_chain", "added_inertia", "second", {"inertance": 1e-6}),
    ("dc_motor", "linear_stiffness", "wheel", {"stiffness": 1e-5}),
]


@pytest.mark.parametrize(
    ("machine", "name", "site", "little"), CASES, ids=[f"{c[1]}-{c[2]}" for c in CASES]
)
def test_a_column_does_what_the_element_does(machine, name, site, little):
    effect = EFFECTS[name]
    found, probes = alone(machine, [effect], COUNT)
    columns = columns_of(found, probes, [effect])
    number = next(i for i, c in enumerate(columns.candidates) if c.site.name == site)
    ((course, lines, before, after),) = found.linear()
    forced, felt = responses(course, lines, (before, after), columns.values[0], columns, 0)
    at = columns.groups[number][0]  # a spring of unknown rest has a constant beside
    moved = numpy.zeros(course.x.shape)
    for k in range(len(course.grid) - 1):
        moved[k + 1] = lines.onward[k] @ moved[k] + forced[k, :, at]
    there = course.grid.samples
    said = numpy.einsum("kij,kj->ki", lines.seen, moved[there]) + felt[:, :, at]
    ((amount,),) = (little.values(),)
    expected = amount * said

    graph = MACHINES[machine]()
    t = times(machine, COUNT)
    inputs = drives(machine, t)
    plain = run(graph, t, inputs)
    grown = graft(graph, effect, site, parameters=little)
    other = run(grown.graph, t, inputs)
    quotient = numpy.array([other[key] - plain[key] for key in graph.outputs]).T
    size = numpy.abs(quotient).max(axis=0)
    assert size.max() > 0
    for column, (one, two) in enumerate(zip(expected.T, quotient.T, strict=True)):
        assert numpy.abs(one - two).max() <= 0.02 * size[column] + 1e-12, graph.outputs
