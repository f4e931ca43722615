"""A, B, C and D against central differences of the rates, over every model in every mode."""

import numpy
import pytest

from bondgraph import derive, in_mode, linearize, models
from bondgraph.codegen.to_numpy import to_numpy
from bondgraph.modes import contacts

from .cases import Case, graph, modes


def differences(function, point):
    """Jacobian by central differences of fourth order, with steps scaled to the point."""
    columns = []
    for k, value in enumerate(point):
        step = 1e-3 * (abs(value) if value else 1.0)
        values = []
        for times in (-2, -1, 1, 2):
            moved = numpy.array(point, dtype=float)
            moved[k] += times * step
            values.append(function(moved))
        columns.append((values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * step))
    return numpy.array(columns).T


@pytest.mark.parametrize(
    ("name", "chosen"),
    [(name, chosen) for name in models.LIBRARY for chosen in modes(name)],
    ids=lambda value: value if isinstance(value, str) else ",".join(value.values()) or "smooth",
)
def test_matrices_are_the_slopes_of_the_equations(name, chosen):
    equations = derive(in_mode(graph(name), chosen))
    case = Case(name, equations, chosen)
    rates, outputs = (
        to_numpy(case.program(found=found))
        for found in (equations.derivatives, equations.outputs.values())
    )
    for t, x, u, p, d in case.points(3, seed=5):
        at = dict(zip((state.name for state in equations.states), map(float, x), strict=True))
        inputs = dict(zip((symbol.name for symbol in equations.inputs), map(float, u), strict=True))
        system = linearize(graph(name), at=at, inputs=inputs, modes=chosen)
        assert system.states == tuple(at)
        for by_state, by_input, function in (
            (system.A, system.B, rates),
            (system.C, system.D, outputs),
        ):
            # bound as defaults: the loop moves on before the lambdas are forgotten
            moved_x = differences(lambda y, f=function: f(t, y, u, p, d)[0], x)
            moved_u = differences(lambda v, f=function: f(t, x, v, p, d)[0], u)
            for found, expected in ((by_state, moved_x), (by_input, moved_u)):
                size = numpy.abs(found).max(axis=1, initial=0, keepdims=True)
                scaled = numpy.abs(x) if found is by_state else numpy.ones(len(u))
                worst = numpy.abs(found - expected.reshape(found.shape)) * scaled
                assert (
                    worst
                    <= 1e-7
                    * ((numpy.abs(found) * scaled).max(axis=1, initial=0, keepdims=True) + 1e-300)
                ).all(), size


def test_every_model_with_contacts_is_tried_in_each_mode():
    assert len(modes("bicycle_brake")) == 3 ** len(contacts(graph("bicycle_brake")))
