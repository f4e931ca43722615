"""State equations and eigenvalues of many graphs against balances written by hand."""

import numpy as np
import pytest

from bondgraph import derive, linearize

from .collection import circuits, listed, machines
from .collection.case import vanishes

MODULES = (listed, circuits, machines)
WRITTEN_OUT = {"cart_pendulum", "triangle_of_capacitors"}  # sympy simplifies these for seconds
CASES = {make.__name__: make for module in MODULES for make in module.CASES}


def rates(name, equations):
    """Rate of each state, simplified where that is quick."""
    if name not in WRITTEN_OUT:
        return equations.explicit()
    return dict(
        zip(equations.states, map(equations.substituted, equations.derivatives), strict=True)
    )


@pytest.mark.parametrize("name", CASES)
def test_state_equations(name):
    case = CASES[name]()
    equations = derive(case.graph)
    assert not equations.algebraic
    found = {state.name: rate for state, rate in rates(name, equations).items()}
    expected = case.rates()
    assert set(found) == set(expected)
    for state, rate in expected.items():
        assert vanishes(found[state] - rate), state


@pytest.mark.parametrize("name", CASES)
def test_eigenvalues(name):
    case = CASES[name]()
    for rest in case.rests:
        numbers = {**dict.fromkeys((*case.x, *case.graph.inputs), 0), **case.values, **rest}
        at = {state: float(meaning.subs(numbers)) for state, meaning in case.states.items()}
        inputs = {symbol: float(rest.get(symbol, 0)) for symbol in case.graph.inputs}
        found = linearize(case.graph, case.values, at=at, inputs=inputs).poles()
        expected = case.poles(rest)
        assert len(found) == len(expected) == len(case.states)
        # each to its own size, and a pole at zero to the size of the others
        apart = np.abs(found[:, None] - expected)
        size = np.maximum(np.abs(expected), 1e-3 * np.abs(expected).max())
        assert (apart.min(axis=0) < 1e-9 * size).all()
        assert (apart / size).min(axis=1).max() < 1e-9
