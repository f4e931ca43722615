"""Steps made again with their derivatives, on models written by hand: no bond graph is involved."""

from __future__ import annotations

import time

import casadi as ca
import numpy as np
import pytest

from bondgraph.errors import SimulationError
from bondgraph.simulation.forward.native import NativeReplay
from bondgraph.simulation.forward.project import Projector
from bondgraph.simulation.forward.replay import PythonReplay
from bondgraph.simulation.forward.tangents import TangentTable
from bondgraph.simulation.forward.value import Travelled, Undefined
from bondgraph.simulation.hybrid import integrate
from bondgraph.simulation.inputs import at
from bondgraph.simulation.native import compiler
from bondgraph.simulation.problem import InputTable, Options, Problem
from bondgraph.simulation.table import ModeFunctions, ModeTable

WAYS = [NativeReplay, PythonReplay] if compiler.find_compiler() else [PythonReplay]


def caught(k=1):
    """Masses m on belts of speed w + u, pushed by springs c; friction F, F_s; 5 k parameters."""

    def provider(mask):
        t, x, u, p, s = (
            ca.SX.sym(*of) for of in (("t",), ("x", 2 * k), ("u", 1), ("p", 5 * k), ("s", k))
        )
        rates, g, a = [x[k + i] for i in range(k)], [], []
        for i in range(k):
            m, c, w, kinetic, static = ca.vertsplit(p[5 * i : 5 * i + 5])
            slip, pull = w + u - x[k + i], c * x[i]
            stuck = mask >> i & 1
            law = kinetic + (static - kinetic) * ca.exp(-s[i] * slip)
            rates.append(0 if stuck else (s[i] * law - pull) / m)
            g.append(static - ca.fabs(pull) if stuck else s[i] * slip)
            a.append(pull if stuck else slip)
        given = [t, x, u, p, s]
        return ModeFunctions(
            ca.Function(f"rhs{mask}", given, [ca.vertcat(*rates, 0, 0)]),
            ca.Function(f"guard{mask}", given, [ca.vertcat(*g, *a)]),
        )

    return ModeTable(2 * k, 1, k, provider)


def replay(way, modes, p, x0, until, inputs, seeds, start, t_eval=None, noise=1e-9):
    """Run and replay; return the run and what was found."""
    given = InputTable(*inputs)
    problem = Problem(modes, p, x0, (0, until), inputs=given)
    backend = "native" if way is NativeReplay else "vm"
    run = integrate(problem, Options(rtol=1e-9, t_eval=t_eval, record=True, backend=backend))
    assert run.outcome.ok
    end = np.concatenate([[run.t_end, 0, len(run.events)], run.x_end])
    events = np.array([event[1:4] for event in run.events], dtype=int).reshape(-1, 3)
    codes = run.codes_end.astype(float)
    for switch, before, _ in events[::-1]:
        codes[switch] = before
    travelled = Travelled(
        np.concatenate([run.record, end[None]]),
        events,
        codes,
        problem.parameters,
        given,
        None if t_eval is None else np.array(t_eval),
        len(run.t),
        np.array(seeds, dtype=float),
        np.array(start, dtype=float),
        noise,
    )
    table = TangentTable(modes)
    project = Projector(table, problem.parameters, lambda t: at(given, np.array([t]))[:, 0])
    return run, way(table, travelled, project).to_the_end(time.monotonic() + 60, TimeoutError)


@pytest.mark.parametrize("way", WAYS)
def test_what_sticks_at_a_jump_of_an_input_forgets_its_speed(way):
    """A force of 1 N brings 1 kg to 1 m/s in 1 s, when the belt jumps from 2 to just that speed."""
    inputs = [0.0, 1.0], [[0.0], [-1.0]], [0]
    seeds, start = np.zeros((5, 2)), np.array([[0, 0], [0, 1]])
    seeds[3:, 0] = 1  # by both forces, and by the speed at the start
    run, found = replay(
        way, caught(), [1, 0, 2, 1, 1], [0, 0], 2, inputs, seeds, start, [0.5, 1, 2]
    )
    assert [event.t for event in run.events] == [1.0]
    expected = [[[0.125, 0.5], [0.5, 1]], [[0.5, 1], [0, 0]], [[0.5, 1], [0, 0]]]
    assert found.rows == pytest.approx(np.array(expected), abs=1e-12)
    assert found.end == pytest.approx(np.array(expected[-1]), abs=1e-12)
    assert not found.events.any()


@pytest.mark.parametrize("way", WAYS)
def test_a_crossing_slower_than_asked_for_is_grazing(way):
    inputs = [0.0], [[0.0]], [0]
    seeds, start = np.eye(5), np.zeros((2, 5))
    p, x0 = [1, 100, 0.5, 8, 12], [0, 0.0]
    replay(way, caught(), p, x0, 1, inputs, seeds, start)
    with pytest.raises(Undefined) as raised:
        replay(way, caught(), p, x0, 1, inputs, seeds, start, noise=1e6)
    assert raised.value.why == "grazing" and raised.value.switch == 0


@pytest.mark.skipif(len(WAYS) < 2, reason="no compiler")
@pytest.mark.parametrize("q", [1, 3, 4, 8, 9, 15])
@pytest.mark.parametrize("t_eval", [None, np.linspace(0, 4, 333)])
def test_compiled_and_python_give_the_same_bits(q, t_eval):
    rng = np.random.default_rng(q)
    modes = caught(3)
    p = rng.uniform(0.8, 1.2, (3, 5)) * [1, 100, 0.5, 8, 12]
    inputs = np.linspace(0, 3.5, 8), rng.uniform(-0.1, 0.3, (8, 1)), [q % 2]
    seeds, start = rng.normal(size=(15, q)), rng.normal(size=(6, q))
    seeds[rng.random(15) < 0.3] = 0
    given = modes, p.ravel(), np.zeros(6), 4, inputs, seeds, start, t_eval
    (run, one), (_, other) = (replay(way, *given) for way in WAYS)
    assert len(run.events) > 10
    assert np.array_equal(one.rows, other.rows)
    assert np.array_equal(one.events, other.events)
    assert np.array_equal(one.end, other.end)


def test_models_of_python_functions_are_refused():
    modes = ModeTable(1, 0, 0, lambda mask: ModeFunctions(lambda t, x, u, p, s: np.zeros(3)))
    with pytest.raises(SimulationError, match="CasADi"):
        TangentTable(modes)
