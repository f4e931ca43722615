"""What is too large is refused by name, after a fixed amount of work."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

from bondgraph import linearize, symbolic_system
from bondgraph.errors import BondGraphError
from bondgraph.symbolic import SymbolicError, expand, limits, tidy
from bondgraph.symbolic.limits import Budget

from . import graphs
from .graphs import positive


def test_twelve_cells_of_which_each_part_has_a_symbol():
    """Its characteristic polynomial has 75025 terms, a Fibonacci number: it is not written out."""
    system = symbolic_system(graphs.ladder(12, "R"))
    assert len(system.states) == 12 and len(system.parameters) == 24
    for ask in (
        system.characteristic_polynomial,
        lambda: system.transfer_function("y", "u"),
    ):
        with pytest.raises(SymbolicError, match=r"too large.*parameters=.*linearize\(\)"):
            ask()


def test_twelve_states_without_losses_are_within_the_limits():
    s = sympy.Symbol("s")
    found = symbolic_system(graphs.ladder(6, "L")).characteristic_polynomial(s)
    assert found.degree == 12
    values = {symbol: 1 for symbol in found.expression.free_symbols - {s}}
    roots = np.roots([float(sympy.sympify(item).subs(values)) for item in found.coefficients])
    # Equal cells, open end: w = 2 sin((2 k - 1) pi / (2 (2 n + 1)))
    expected = 2 * np.sin((2 * np.arange(1, 7) - 1) * np.pi / 26)
    assert np.allclose(np.sort(abs(roots.imag))[::2], expected) and np.allclose(
        roots.real, 0, atol=1e-6
    )


def test_the_remedy_helps():
    graph = graphs.ladder(12, "R")
    names = [symbol.name for symbol in graph.parameters if symbol.name != "R1"]
    values = {name: 1 + place % 3 for place, name in enumerate(names)}
    found = symbolic_system(graph, parameters=values).characteristic_polynomial()
    (first,) = found.expression.free_symbols - {found.variable}
    numbers = [float(sympy.sympify(item).subs({first: 2})) for item in found.coefficients]
    numeric = linearize(graph, {**values, "R1": 2}, inputs={"u": 0})
    assert np.allclose(numbers, np.poly(numeric.A), rtol=1e-6)


def test_too_many_states():
    with pytest.raises(
        SymbolicError, match=r"'ladder'.*21 states; 20 are the limit; use linearize"
    ):
        symbolic_system(graphs.ladder(21, "R"))


def test_too_many_operations(monkeypatch):
    monkeypatch.setattr(expand, "MAX_OPERATIONS", 5)
    with pytest.raises(SymbolicError, match=r"operations once expanded; 5 are the limit"):
        symbolic_system(graphs.oscillator())


def test_conditions_too_large():
    with pytest.raises(SymbolicError, match=r"Routh-Hurwitz conditions.*too large"):
        symbolic_system(graphs.ladder(6, "R")).routh_hurwitz()


def test_an_array_too_large_does_not_bar_its_conditions():
    found = symbolic_system(graphs.ladder(3, "RL")).routh_hurwitz()
    assert found.conditions
    with pytest.raises(SymbolicError, match="Routh's array"):
        found.array()


def test_powers_of_sums_are_not_multiplied_out():
    big = sympy.Add(*positive("a0:20")) ** 40
    assert tidy.tidy(big + 1) == big + 1


def test_the_count_is_of_products():
    budget = Budget("it", 10)
    budget.spend(10)
    with pytest.raises(BondGraphError, match="it is too large"):
        budget.spend(1)
    with pytest.raises(BondGraphError, match=f"{limits.MAX_TERMS + 1} terms"):
        budget.check(limits.MAX_TERMS + 1)
