"""Every supported function, as NumPy computes it, against sympy; whole trajectories at once."""

import itertools

import numpy
import pytest
import sympy

from bondgraph.codegen import Program
from bondgraph.codegen.to_casadi import to_casadi
from bondgraph.codegen.to_numpy import to_numpy

from .functions import CASES, x, y


def program(*expressions, assignments=()):
    return Program("f", (("v", (x, y)),), assignments, (("out", expressions),))


@pytest.mark.parametrize("expression", CASES, ids=str)
def test_values(expression):
    function = to_numpy(program(expression))
    for point in CASES[expression]:
        for other in (-2.0, 1.0):
            expected = expression.evalf(30, subs={x: sympy.Float(point, 30), y: other})
            ((found,),) = function([point, other])
            assert found == pytest.approx(float(expected), rel=1e-14, abs=1e-15)


@pytest.mark.parametrize("expression", CASES, ids=str)
def test_a_trajectory_is_one_call(expression):
    function = to_numpy(program(expression))
    points = numpy.array([[point, other] for point in CASES[expression] for other in (-2.0, 1.0)]).T
    (whole,) = function(points)
    single = [function(column)[0][0] for column in points.T]
    assert whole.shape == (1, points.shape[1])
    numpy.testing.assert_allclose(whole[0], single, rtol=1e-15, atol=0)


def test_agrees_with_casadi_on_all_at_once():
    expressions = [expression for expression, points in CASES.items() if len(points) > 5]
    first, second = to_numpy(program(*expressions)), to_casadi(program(*expressions))
    for point in ([0.4, 1.0], [-2.5, -2.0], [0.0, 0.0], [3.7, 1.0]):
        numpy.testing.assert_allclose(
            first(point)[0], second(point).full().ravel(), rtol=1e-14, atol=1e-15
        )


def test_trailing_axes_broadcast():
    p = sympy.Symbol("p")
    function = to_numpy(
        Program("f", (("x", (x, y)), ("p", (p,))), (), (("out", (x * p, sympy.S(3))), ("none", ())))
    )
    out, none = function(numpy.ones((2, 4, 5)), [2.0])
    assert out.shape == (2, 4, 5)
    assert numpy.all(out[0] == 2)
    assert numpy.all(out[1] == 3)
    assert none.shape == (0, 4, 5)


def test_empty_arguments():
    function = to_numpy(Program("f", (("t", ()), ("x", (x,))), (), (("out", (x + 1,)),)))
    assert function([], [1.0])[0].tolist() == [2.0]


def test_names_are_free():
    """Dots, brackets and words of the language are no trouble."""
    names = ["rear.mass.p", "der(x)", "lambda", "for", "a b", "v0", "numpy", "loop#1"]
    symbols = [sympy.Symbol(name, real=True) for name in names]
    total = sympy.Symbol("rear.sum")
    function = to_numpy(
        Program("f", (("x", tuple(symbols)),), ((total, sum(symbols)),), (("out", (total * 2,)),))
    )
    assert function(numpy.arange(8.0))[0].tolist() == [56.0]


def test_assignments_are_computed_once():
    chain = sympy.symbols("c:60")
    table = [(chain[0], sympy.sin(x))]
    table += [(after, before * before / 2 + before) for before, after in itertools.pairwise(chain)]
    ((found,),) = to_numpy(program(chain[-1], assignments=tuple(table)))([0.01, 0])
    expected = numpy.sin(0.01)
    for _ in chain[1:]:
        expected = expected * expected / 2 + expected
    assert found == pytest.approx(expected, rel=1e-13)


def test_what_is_not_finite_shows_in_the_result_without_a_warning(recwarn):
    ((found,), (other,)) = to_numpy(
        Program("f", (("x", (x,)),), (), (("a", (1 / x,)), ("b", (sympy.log(x),))))
    )([0.0])
    assert numpy.isinf(found)
    assert numpy.isinf(other)
    assert not recwarn.list
