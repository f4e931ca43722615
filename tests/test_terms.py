"""Products, sums and renamings are those that sympy itself would write."""

import itertools

import pytest
import sympy

from bondgraph.terms import product, renamed, signed_sum, slopes

a, b, c, s = sympy.symbols("a b c s", real=True)
same = sympy.Dummy("a", real=True)
noncommutative = sympy.Symbol("n", commutative=False)
FACTORS = [sympy.sympify(n) for n in (0, 1, -1, 2, "-2/3", 0.5)] + [sympy.pi, sympy.sqrt(2)]
FACTORS += [a, same, a + 1, 1 / a, 1 / (2 * a), a / s, 3 * a * b, noncommutative]
QUANTITIES = [s, a, s**2, 1 / s, s + a, s * a, 2 * s, sympy.sin(s)]
QUANTITIES += [
    sympy.S(3),
    sympy.S.Zero,
    sympy.S.One,
    2 * s**2 / b,
    noncommutative,
    s * noncommutative,
]


@pytest.mark.parametrize("factor", FACTORS, ids=str)
@pytest.mark.parametrize("quantity", QUANTITIES, ids=str)
def test_products(factor, quantity):
    expected = factor * quantity
    assert product(factor, quantity) == expected
    assert product(factor, quantity).args == expected.args
    assert product(b, factor, quantity) == sympy.Mul(b, factor, quantity)


@pytest.mark.parametrize("symbols", list(itertools.permutations([a, b, c, same])))
@pytest.mark.parametrize("count", range(5))
def test_sums(symbols, count):
    expected = sympy.Add(*symbols[:count], *(-symbol for symbol in symbols[count:]))
    assert signed_sum(symbols[:count], symbols[count:]) == expected
    assert signed_sum(symbols[:count], symbols[count:]).args == expected.args


def test_sums_in_which_terms_meet():
    assert signed_sum([a, a], [b]) == 2 * a - b
    assert signed_sum([a, b], [a]) == b
    assert signed_sum([], []) == 0
    assert signed_sum([], [a]) == -a


@pytest.mark.parametrize("name", [a, -a, a**2, 2 * a, a + 1, sympy.S(3)], ids=str)
@pytest.mark.parametrize(
    "law", [*QUANTITIES, s / 2, -(s**2), s**2 * a / 3, s / (2 * a * b), 2 * (s + 1)], ids=str
)
def test_renaming(law, name):
    assert renamed(law, {s: name}) == law.xreplace({s: name})


@pytest.mark.parametrize(
    "expression",
    [*QUANTITIES, 3 * s - a / 2 + s * a**2, sympy.exp(s * a) + s, (s + a) * (s - b), -s, b],
    ids=str,
)
def test_slopes(expression):
    expected = {symbol: sympy.diff(expression, symbol) for symbol in (s, a)}
    assert slopes(expression, [s, a]) == expected
