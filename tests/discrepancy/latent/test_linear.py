"""A linear model's step along a course against the exponential of the block matrix of its inputs."""

import numpy
import pytest
from scipy.linalg import expm
from scipy.signal import cont2discrete

from bondgraph import derive
from bondgraph.discrepancy.latent.functions import Functions
from bondgraph.discrepancy.latent.grid import grid_of
from bondgraph.discrepancy.latent.linear import along
from bondgraph.simulation import CompiledModel, Samples
from bondgraph.values import parameter_values

from ..machines import MACHINES


def _matrices(machine):
    """A and B of a linear machine, by differences."""
    graph = MACHINES[machine]()
    equations = derive(graph)
    functions = Functions(equations, tuple(graph.outputs), ())
    table = parameter_values(equations, {}, CompiledModel(graph).resolver)
    p = numpy.array([table[symbol.name] for symbol in equations.parameters])
    n, m = len(equations.states), len(equations.inputs)

    def rates(x, u):
        return functions.at(numpy.zeros(1), x[None], u[None], p).rates[0]

    a = numpy.array([rates(row, numpy.zeros(m)) for row in numpy.eye(n)]).T
    b = numpy.array([rates(numpy.zeros(n), row) for row in numpy.eye(m)]).T
    return functions, p, a, b


def _along(machine, hold, even):
    functions, p, a, b = _matrices(machine)
    slow = 1 / numpy.abs(numpy.linalg.eigvals(a)).max()
    rng = numpy.random.default_rng(5)
    t = 3 * slow * numpy.arange(9.0)
    t = t if even else numpy.cumsum(slow * rng.uniform(0.1, 4, 9))
    u = rng.normal(size=(9, b.shape[1]))
    names = [symbol.name for symbol in functions.equations.inputs]
    inputs = {name: Samples(t, u[:, i], hold) for i, name in enumerate(names)}
    grid = grid_of(functions.equations, t, inputs)
    x = rng.normal(size=(9, len(a)))
    measured = numpy.zeros((9, len(functions.outputs)))
    return along(functions, grid, x, p, measured)[0], t, x, u, a, b


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("machine", ["two_tanks", "rlc", "quarter_car"])
def test_steps_with_held_inputs_are_exact(machine, even):
    found, t, x, u, a, b = _along(machine, "zero", even)
    for k, h in enumerate(numpy.diff(t)):
        onward, gain, *_ = cont2discrete((a, b, numpy.eye(len(a)), 0), h, "zoh")
        expected = onward @ x[k] + gain @ u[k]
        assert numpy.allclose(found.onward[k], onward, rtol=1e-8, atol=1e-10)
        assert numpy.allclose(x[k + 1] - found.broken[k], expected, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("machine", ["two_tanks", "rlc", "quarter_car"])
def test_steps_with_straight_inputs_are_exact(machine, even):
    found, t, x, u, a, b = _along(machine, "linear", even)
    n, m = b.shape
    for k, h in enumerate(numpy.diff(t)):
        slope = (u[k + 1] - u[k]) / h
        block = numpy.zeros((n + 2 * m, n + 2 * m))
        block[:n, :n], block[:n, n : n + m], block[n : n + m, n + m :] = a, b, numpy.eye(m)
        expected = (expm(h * block) @ numpy.concatenate([x[k], u[k], slope]))[:n]
        assert numpy.allclose(x[k + 1] - found.broken[k], expected, rtol=1e-6, atol=1e-8)


def test_a_held_push_moves_as_a_step_response():
    found, t, _, _, a, b = _along("rlc", "zero", True)
    push = numpy.broadcast_to(b[None], (len(t), *b.shape))
    moved = found.pushed(push, push)
    gain = cont2discrete((a, b, numpy.eye(len(a)), 0), t[1] - t[0], "zoh")[1]
    assert numpy.allclose(moved, gain[None], rtol=1e-9, atol=1e-12)
