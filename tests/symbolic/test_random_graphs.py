"""Random bond graphs: exact polynomials against sympy's own matrices, and against residues."""

from __future__ import annotations

import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bondgraph import symbolic_system
from bondgraph.errors import BondGraphError
from tests.sketches import Sketch
from tests.strategies import sketches

S = sympy.Symbol("s")
POINT = sympy.Rational(17, 13)


def analysed(sketch: Sketch, symbolic: bool):
    outputs = [
        f"{name}.{'e' if kind == '0' else 'f'}"
        for name, (kind, _) in sketch.elements.items()
        if kind in "01"
    ]
    try:
        system = symbolic_system(sketch.graph(symbolic), outputs=outputs[:2])
    except BondGraphError:
        assume(False)
    assume(len(system.states) <= 6 and system.sources)
    return system


@settings(deadline=None, max_examples=30)
@given(sketches(junctions=4, loops=1, chain=1))
def test_numbers(sketch):
    system = analysed(sketch, symbolic=False)
    assert system.characteristic_polynomial(S).expression == system.A.charpoly(S).as_expr()
    resolvent = POINT * sympy.eye(len(system.states)) - system.A
    assume(resolvent.det() != 0)
    whole = system.C * resolvent.LUsolve(system.B) + system.D if system.states else system.D
    for row, output in enumerate(system.outputs):
        for source in system.sources:
            column = [symbol.name for symbol in system.inputs].index(source.name)
            expected, rate, power = whole[row, column], source, 1
            while rate in system.input_rates:
                rate = system.input_rates[rate]
                expected += POINT**power * whole[row, system.inputs.index(rate)]
                power += 1
            found = system.transfer_function(output, source, S)
            assert found.expression.subs(S, POINT) == expected
            above, below = (
                sympy.Poly(item.expression, S) for item in (found.numerator, found.denominator)
            )
            assert above.is_zero or sympy.gcd(above, below).degree() == 0


@settings(deadline=None, max_examples=20)
@given(sketches(junctions=3, loops=1, ones=2, chain=1), st.randoms(use_true_random=False))
def test_symbols(sketch, draw):
    """With symbols first and numbers then, the result is that with numbers first."""
    system = analysed(sketch, symbolic=True)
    found = system.characteristic_polynomial(S).expression
    values = {symbol: sympy.Rational(draw.randint(1, 9), 7) for symbol in system.parameters}
    matrix = system.A.subs(values)
    assume(not matrix.has(sympy.zoo, sympy.nan))
    expected = matrix.charpoly(S).as_expr()
    assert sympy.expand(found.subs(values) - expected) == 0
