"""Matrices of expressions: inverses that invert, symmetry told from numbers."""

from __future__ import annotations

import itertools
import random

import pytest
import sympy

from bondgraph.elements.matrices import inverse_of, is_symmetric

a, b, c = sympy.symbols("a b c", real=True)


def product_at_numbers(first, second):
    """The product of two matrices, with numbers for their symbols."""
    draw = random.Random(3)
    symbols = sorted(first.free_symbols | second.free_symbols, key=str)
    values = {symbol: sympy.Rational(draw.randint(2, 99), 7) for symbol in symbols}
    return (first.xreplace(values) * second.xreplace(values)).applyfunc(lambda x: x.evalf(20))


MATRICES = {
    "numbers": [[2, 1], [1, 2]],
    "ill-conditioned": [[sympy.Rational(1, i + j + 1) for j in range(8)] for i in range(8)],
    "no pivot": [[0, 1], [1, 0]],
    "symbols": [[a, b], [b, c]],
    "ratios": [[1 / a + 1 / b, -1 / b], [-1 / b, 1 / b]],
    "roots": [[sympy.sqrt(a), sympy.sqrt(2)], [sympy.sqrt(2), sympy.pi]],
    "functions": [[sympy.exp(a), sympy.Piecewise((b, a < 1), (1, True))], [sympy.Abs(b), 2]],
    "a high power of a sum": [[(a + b + c) ** 200, 1], [1, 2]],
    "a long product": [[sympy.prod(a + k * b + c for k in range(1, 60)), 1], [1, a]],
    "four symbolic ports": [
        [sympy.Symbol(f"m{min(i, j)}{max(i, j)}") for j in range(4)] for i in range(4)
    ],
}


@pytest.mark.parametrize("name", MATRICES)
def test_a_matrix_times_its_inverse_is_one(name):
    matrix = sympy.Matrix(MATRICES[name])
    found = product_at_numbers(matrix, inverse_of(matrix))
    for i, j in itertools.product(range(matrix.rows), repeat=2):
        assert abs(found[i, j] - int(i == j)) < 1e-12


@pytest.mark.parametrize(
    "rows",
    [
        [[1, 2], [2, 4]],
        [[a**2, a], [a, 1]],
        [[2, sympy.sqrt(2)], [sympy.sqrt(2), 1]],
        [[0, 0], [0, a]],
    ],
)
def test_what_has_no_inverse_is_said(rows):
    assert inverse_of(sympy.Matrix(rows)) is None


def test_fractions_are_cancelled_where_they_are_small():
    inertance = sympy.Matrix([[a + b, b], [b, b]])
    assert inverse_of(inertance)[0, 0] == 1 / a


@pytest.mark.parametrize(
    "upper, lower, same",
    [
        (a * (a + b), a**2 + a * b, True),
        (sympy.sin(a) ** 2, 1 - sympy.cos(a) ** 2, True),
        (sympy.sqrt(a**2), sympy.Abs(a), True),
        (a, b, False),
        (a, a + sympy.Rational(1, 10**9), False),
        (a, -a, False),
        (1, 2, False),
    ],
)
def test_symmetry(upper, lower, same):
    assert is_symmetric(sympy.Matrix([[1, upper], [lower, 1]])) is same
