"""A, B, C and D against central differences of the rates, over every model in every mode."""

import numpy
import pytest

from bondgraph import derive, in_mode, linearize, models
from bondgraph.codegen.to_numpy import to_numpy
from bondgraph.modes import contacts

from .cases import Case, graph, modes


def differences(function, point):
    """Jacobian by central differences of fourth order, with the steps and how sure it is."""
    columns, doubts = [], []
    for k, value in enumerate(point):
        step = 1e-3 * (abs(value) if value else 1.0)
        moved = numpy.array([numpy.array(point, dtype=float)] * 4)
        moved[:, k] += step * numpy.array([-2, -1, 1, 2])
        values = numpy.array([function(row) for row in moved])
        columns.append((values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * step))
        doubts.append(1e-14 * numpy.abs(values).max(axis=0) / step)
    return numpy.array(columns).T, numpy.array(doubts).T


def check(found, function, point):
    if not found.size:
        return
    expected, doubt = differences(function, point)
    steps = numpy.where(point == 0, 1, numpy.abs(point))
    row = (numpy.abs(found) * steps).max(axis=1, keepdims=True) / steps
    assert (numpy.abs(found - expected) <= 1e-8 * row + doubt).all()


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
    for point in case.points(3, seed=5):
        check_at(case, point, rates, outputs)


def check_at(case, point, rates, outputs):
    t, x, u, p, d = point
    eq = case.equations
    at = dict(zip((state.name for state in eq.states), map(float, x), strict=True))
    inputs = dict(zip((symbol.name for symbol in eq.inputs), map(float, u), strict=True))
    system = linearize(graph(case.name), at=at, inputs=inputs, modes=case.modes)
    assert system.states == tuple(at)
    check(system.A, lambda y: rates(t, y, u, p, d)[0], x)
    check(system.B, lambda v: rates(t, x, v, p, d)[0], u)
    check(system.C, lambda y: outputs(t, y, u, p, d)[0], x)
    check(system.D, lambda v: outputs(t, x, v, p, d)[0], u)


def test_every_model_with_contacts_is_tried_in_each_mode():
    assert len(modes("bicycle_brake")) == 3 ** len(contacts(graph("bicycle_brake")))
