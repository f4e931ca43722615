"""Slopes along a course against difference quotients of the same model's rates."""

import numpy
import pytest
import sympy

from bondgraph import C, One, R, Se, Zero, assemble, derive
from bondgraph.discrepancy.latent.functions import AT_ONCE, Functions
from bondgraph.errors import SimulationError
from bondgraph.simulation import CompiledModel
from bondgraph.values import parameter_values

from ..machines import MACHINES
from .made import drives, run, times

STEP = 1e-6


def _values(graph, equations):
    table = parameter_values(equations, {}, CompiledModel(graph).resolver)
    return numpy.array([table[symbol.name] for symbol in equations.parameters])


@pytest.fixture(params=["quarter_car", "thermal_brake", "rlc"])
def case(request):
    machine = request.param
    graph = MACHINES[machine]()
    equations = derive(graph)
    wanted = [symbol.name for symbol in equations.parameters][:3]
    functions = Functions(equations, tuple(graph.outputs), wanted)
    t = times(machine, 7)
    inputs = drives(machine, t)
    found = run(graph, t, inputs)
    x = numpy.array([found[state.name] for state in equations.states]).T
    u = numpy.array([inputs[symbol.name][1] for symbol in equations.inputs]).T
    return functions, t, x, u, _values(graph, equations), found


def test_outputs_are_those_of_a_run(case):
    functions, t, x, u, p, found = case
    points = functions.at(t, x, u, p)
    for row, name in zip(points.outputs.T, functions.outputs, strict=True):
        assert numpy.allclose(row, found[name], rtol=1e-9, atol=1e-12)


def test_slopes_are_difference_quotients(case):
    functions, t, x, u, p, _ = case
    points = functions.at(t, x, u, p)
    for j in range(x.shape[1]):
        step = STEP * max(numpy.abs(x[:, j]).max(), 1e-6) * numpy.eye(x.shape[1])[j]
        up, down = functions.at(t, x + step, u, p), functions.at(t, x - step, u, p)
        for slope, high, low in (
            (points.rates_x, up.rates, down.rates),
            (points.outputs_x, up.outputs, down.outputs),
        ):
            quotient = (high - low) / (2 * step[j])
            near = 1e-6 * numpy.abs(quotient).max() + 1e-9
            assert numpy.allclose(slope[:, :, j], quotient, rtol=1e-6, atol=near)
    names = [symbol.name for symbol in functions.equations.parameters]
    for j, name in enumerate(functions.wanted):
        step = numpy.zeros(len(p))
        step[names.index(name)] = STEP * p[names.index(name)]
        up, down = functions.at(t, x, u, p + step), functions.at(t, x, u, p - step)
        quotient = (up.rates - down.rates) / (2 * step.max())
        near = 1e-6 * numpy.abs(quotient).max() + 1e-9
        assert numpy.allclose(points.rates_p[:, :, j], quotient, rtol=1e-6, atol=near)


def test_more_points_than_are_evaluated_at_once_are_the_same_points(case):
    functions, t, x, u, p, _ = case
    many = 3 * AT_ONCE // len(t)
    tiled = functions.at(*(numpy.concatenate([rows] * many) for rows in (t, x, u)), p)
    once = functions.at(t, x, u, p)
    assert numpy.array_equal(tiled.rates, numpy.concatenate([once.rates] * many))
    assert numpy.array_equal(tiled.rates_x, numpy.concatenate([once.rates_x] * many))


def test_signals_rise_as_the_model_moves():
    graph = MACHINES["quarter_car"]()
    equations = derive(graph)
    speed = graph.elements["body"].symbols["f"]
    functions = Functions(equations, (), (), {"speed": speed})
    t = times("quarter_car", 2001)
    inputs = drives("quarter_car", t)
    found = run(graph, t, inputs)
    x = numpy.array([found[state.name] for state in equations.states]).T
    u = numpy.array([inputs[symbol.name][1] for symbol in equations.inputs]).T
    said, rising = functions.signals(t, x, u, _values(graph, equations))
    assert numpy.allclose(said[:, 0], found["body_speed"], atol=1e-9)
    quotient = numpy.gradient(found["body_speed"], t)
    assert numpy.allclose(rising[2:-2, 0], quotient[2:-2], atol=2e-4 * numpy.abs(quotient).max())


def test_an_unknown_parameter_is_refused():
    with pytest.raises(SimulationError, match="stray"):
        Functions(derive(MACHINES["rlc"]()), (), ("stray",))


def _fed():
    """A tank behind a pipe without inertia, whose flow no formula gives: R f + k f |f| = p0 - p."""
    supply, resistance, drag = sympy.Symbol("p0"), *sympy.symbols("R k", positive=True)
    line, tank = One("line"), Zero("tank")
    pipe = R("pipe", effort=lambda f: resistance * f + drag * f * abs(f))
    return assemble(
        "fed",
        Se("pump", supply) >> line >> pipe,
        line >> tank >> (C("store", 2.0), R("out", flow=lambda e: 0.3 * e)),
        parameters={resistance: 1.5, drag: 2.0},
        inputs=[supply],
        outputs={"p": tank.e, "q": line.f},
    )


def test_algebraic_variables_are_solved_for_at_each_point():
    equations = derive(_fed())
    assert equations.algebraic
    names = [symbol.name for symbol in equations.parameters]
    functions = Functions(equations, ("p", "q"), ("R", "k"))
    rng = numpy.random.default_rng(1)
    t, x, u = numpy.arange(40.0), 3 * rng.normal(size=(40, 1)), 2 * rng.normal(size=(40, 1))
    p = numpy.array([{"R": 1.5, "k": 2.0}[name] for name in names])
    points = functions.at(t, x, u, p)
    push = u[:, 0] - x[:, 0] / 2.0  # of the compliance
    flow = numpy.sign(push) * (-1.5 + numpy.sqrt(1.5**2 + 8 * abs(push))) / 4
    assert points.outputs[:, 1] == pytest.approx(flow, rel=1e-9)
    # R dq + 2 k |q| dq = dp0 - dp, and so on for R and k
    steep = 1 / (1.5 + 4 * abs(flow))
    assert points.outputs_x[:, 1, 0] == pytest.approx(-steep / 2.0, rel=1e-9)
    assert points.outputs_p[:, 1, 0] == pytest.approx(-flow * steep, rel=1e-9, abs=1e-12)
    assert points.outputs_p[:, 1, 1] == pytest.approx(
        -flow * abs(flow) * steep, rel=1e-9, abs=1e-12
    )
