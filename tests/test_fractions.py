"""Fractions: assignments in lowest terms, against sympy's own simplification and the collection."""

import pytest
import sympy

from bondgraph import derive
from bondgraph.equations.fractions import fractions

from .collection import circuits, machines

a, b, x, y, z = sympy.symbols("a b x y z")


def test_what_cancels_is_gone():
    steps = [(y, a * x / (1 + b)), (z, y * (1 + b) - a * x + 3)]
    assert fractions(steps, [z, y / x]) == [3, a / (b + 1)]


def test_functions_are_quantities_of_their_own():
    steps = [(y, x + 1), (z, sympy.exp(y) ** 2 / sympy.exp(y))]
    assert fractions(steps, [z]) == [sympy.exp(x + 1)]


def test_roots_and_powers():
    steps = [(y, sympy.sqrt(x)), (z, y**3 / y)]
    (found,) = fractions(steps, [z])
    assert sympy.simplify(found - x) == 0


def test_too_many_quantities():
    many = sympy.symbols("q0:60")
    assert fractions([(y, sympy.Add(*many))], [y]) is None


@pytest.mark.parametrize("case", [circuits.triangle_of_capacitors, machines.cart_pendulum])
def test_what_is_shown_is_what_is_derived(case):
    """At rational points, in exact arithmetic but for sines."""
    equations = derive(case().graph)
    shown = equations.explicit()
    for state, rate in zip(equations.states, equations.derivatives, strict=True):
        difference = equations.substituted(rate) - shown[state]
        symbols = sorted(difference.free_symbols, key=str)
        for shift in range(3):
            at = {s: sympy.Rational(2 * i + 3 + shift, 7) for i, s in enumerate(symbols)}
            assert abs(difference.subs(at).evalf(30, chop=True)) < 1e-25
