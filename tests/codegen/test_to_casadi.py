"""Every supported function, as CasADi computes it, against sympy at 30 digits."""

import itertools

import casadi
import numpy
import pytest
import sympy

from bondgraph.codegen import Program
from bondgraph.codegen.program import ProgramError
from bondgraph.codegen.to_casadi import FUNCTIONS, to_casadi

from .functions import CASES, x, y

a, b = sympy.symbols("a b")


def compiled(*expressions, arguments=(("v", (x, y)),), assignments=()):
    return to_casadi(Program("f", arguments, assignments, (("out", expressions),)))


@pytest.mark.parametrize("expression", CASES, ids=str)
def test_values(expression):
    function = compiled(expression)
    for point in CASES[expression]:
        for other in (-2.0, 1.0):
            expected = expression.evalf(30, subs={x: sympy.Float(point, 30), y: other})
            assert float(function([point, other])) == pytest.approx(
                float(expected), rel=1e-14, abs=1e-15
            )


def test_every_function_in_the_table_is_tried():
    used = {node.func for expression in CASES for node in sympy.preorder_traversal(expression)}
    assert set(FUNCTIONS) <= used


def test_derivatives_come_from_casadi():
    function = compiled(sympy.exp(x) * sympy.sin(y))
    jacobian = function.jacobian()([0.5, 0.25], 0)
    expected = [numpy.exp(0.5) * numpy.sin(0.25), numpy.exp(0.5) * numpy.cos(0.25)]
    assert jacobian.full().ravel() == pytest.approx(expected, rel=1e-14)


def test_names_sizes_and_empty_vectors():
    function = to_casadi(
        Program(
            "f", (("t", ()), ("x", (x, y))), (), (("none", ()), ("out", (x + y, x, sympy.S(2))))
        )
    )
    assert (function.name(), function.name_in(), function.name_out()) == (
        "f",
        ["t", "x"],
        ["none", "out"],
    )
    none, out = function([], [1, 2])
    assert none.shape == (0, 1)
    assert out.full().ravel().tolist() == [3, 1, 2]


def test_results_are_dense():
    out = compiled(sympy.S.Zero, x)([1, 2])
    assert out.is_dense()
    assert out.full().ravel().tolist() == [0, 1]


def test_assignments_are_shared():
    """An intermediate result used a hundred times is computed once."""
    chain = sympy.symbols("c:100")
    table = [(chain[0], sympy.sin(x))]
    table += [(after, before * before + before) for before, after in itertools.pairwise(chain)]
    function = compiled(chain[-1], assignments=tuple(table))
    assert function.n_nodes() < 500


def test_equal_subexpressions_are_shared():
    same = sympy.exp(x * y)
    single, double = compiled(same), compiled(same + sympy.sin(same))
    assert double.n_nodes() <= single.n_nodes() + 2


def test_unknown_functions_are_refused_by_name():
    with pytest.raises(ProgramError, match="no CasADi form of gamma"):
        compiled(sympy.gamma(x))
    with pytest.raises(ProgramError, match="no CasADi form of f"):
        compiled(sympy.Function("f")(x))


def test_c_code_can_be_generated():
    generator = casadi.CodeGenerator("code.c")
    generator.add(compiled(*CASES))
    assert "sin(" in generator.dump()
