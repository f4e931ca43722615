"""Nothing makes or loses power but what is made to.

At every instant the one-ports' powers sum to zero, and supplied power is the rate of stored
energy plus dissipated power: for every model in every mode, and for random graphs.
"""

import casadi
import numpy
import pytest
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bondgraph import derive
from bondgraph.codegen import Program
from bondgraph.codegen.to_casadi import to_casadi
from bondgraph.elements import OnePort, TwoPort
from bondgraph.errors import BondGraphError

from ..sketches import Sketch
from ..strategies import sketches
from .cases import Case, cases


def flows_into(equations):
    """Power into each one-port, by its own port variables and the arrow of its bond."""
    graph, ports = equations.graph, equations.ports
    found = []
    for name, _ in graph.of(OnePort):
        (bond,) = graph.bonds_of(name)
        sign = 1 if bond.head == name else -1
        found.append(sign * ports[f"{name}.e"] * ports[f"{name}.f"])
    return found


def balance(case: Case):
    """Compile powers, energies and how the energies change along the equations."""
    eq = case.equations
    energies = [energy for energy in eq.energies.values() if energy is not None]
    program = case.program(
        rates=eq.derivatives,
        stored=energies,
        supplied=eq.supplied.values(),
        dissipated=eq.dissipated.values(),
        into=flows_into(eq),
        through=[
            eq.ports[f"{name}.e_{side}"] * eq.ports[f"{name}.f_{side}"]
            for name, _ in eq.graph.of(TwoPort)
            for side in ("in", "out")
        ],
    )
    function = to_casadi(program)
    t, x, u, p, d = (casadi.SX.sym(name, len(symbols)) for name, symbols in case.arguments)
    rates, stored, supplied, dissipated, into, through = function(t, x, u, p, d)
    place = {symbol: index for index, symbol in enumerate(eq.inputs)}
    moving = [u[place[eq.input_rates[s]]] if s in eq.input_rates else 0 for s in eq.inputs]
    total = casadi.sum1(stored)
    change = casadi.jtimes(total, x, rates) + casadi.jtimes(total, t, casadi.SX(1))
    if moving:
        change += casadi.jtimes(total, u, casadi.vertcat(*moving))
    # the sizes of what is added up: rounding is measured by them
    return casadi.Function(
        "balance", [t, x, u, p, d], [change, supplied, dissipated, into, through]
    )


def check(case: Case, points) -> None:
    function = balance(case)
    for arguments in points:
        change, supplied, dissipated, into, through = (
            found.full().ravel() for found in function(*arguments)
        )
        size = numpy.abs(numpy.concatenate([supplied, dissipated, into, [1e-3]])).max()
        assert abs(into.sum()) <= 1e-11 * size
        assert abs(supplied.sum() - dissipated.sum() - change[0]) <= 1e-10 * size
        assert numpy.abs(through[::2] - through[1::2]).max(initial=0) <= 1e-11 * numpy.abs(
            through
        ).max(initial=1)


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
def test_models(case):
    assert None not in case.equations.energies.values()
    check(case, case.points(20, seed=3))


@settings(max_examples=60, deadline=None)
@given(sketch=sketches(), seed=st.integers(0, 2**31))
def test_random_graphs(sketch: Sketch, seed: int):
    try:
        equations = derive(sketch.graph())
    except BondGraphError:
        assume(False)
    case = Case("random", equations, None)
    rng = numpy.random.default_rng(seed)
    sizes = [len(symbols) for _, symbols in case.arguments]
    check(case, ([rng.normal(size=size) for size in sizes] for _ in range(3)))


@settings(max_examples=40, deadline=None)
@given(sketch=sketches(), seed=st.integers(0, 2**31))
def test_passive_linear_graphs_dissipate(sketch: Sketch, seed: int):
    """With positive resistances no R gives power, whatever the states."""
    try:
        equations = derive(sketch.graph())
    except BondGraphError:
        assume(False)
    case = Case("random", equations, None)
    function = to_casadi(case.program(taken=equations.dissipated.values()))
    rng = numpy.random.default_rng(seed)
    taken = function(*(rng.normal(size=len(symbols)) for _, symbols in case.arguments))
    assert numpy.all(taken.full() >= 0)


def test_modulated_storage_is_counted():
    """A capacitor whose plates are pulled apart: the modulation's work counts as supplied."""
    from bondgraph import C, I, One, R, Sf, Zero, assemble

    gap = C("gap", stiffness=0, initial=1)
    plates = C("plates", energy=lambda q: q**2 / 2 * (1 + gap.q**2))
    graph = assemble(
        "g", Zero("u") >> (plates, R("r", 2)), One("v") >> (gap, I("m", 3)), Sf("s", 1) >> R("x", 1)
    )
    equations = derive(graph)
    assert "plates (modulation)" in equations.supplied
    case = Case("plates", equations, None)
    rng = numpy.random.default_rng(4)
    sizes = [len(symbols) for _, symbols in case.arguments]
    check(case, ([rng.normal(size=size) for size in sizes] for _ in range(5)))


def test_the_balance_would_notice():
    """An element that makes power out of nothing breaks the second balance, not the first."""
    from bondgraph import I, One, R, assemble

    v = One("v")
    graph = assemble("g", v >> (I("m", 1), R("b", 1)))
    equations = derive(graph)
    symbol = equations.states[0]
    wrong = {**equations.energies, "m": 2 * symbol**2}
    function = to_casadi(
        Program.pruned("f", [("x", equations.states)], equations.assignments,
                       {"rate": [sympy.diff(wrong["m"], symbol) * equations.derivatives[0]],
                        "taken": equations.dissipated.values()})
    )  # fmt: skip
    rate, taken = function([1.0])
    assert abs(float(rate) + float(taken)) > 0.1
