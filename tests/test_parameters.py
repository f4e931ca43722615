"""Parameters: the forms in which they are given."""

import math

import numpy
import pint
import pytest
import sympy

from bondgraph import Parameter
from bondgraph.errors import ParameterError
from bondgraph.parameters import as_parameter, check_unit
from bondgraph.resolver import resolve

k, m, f, n = sympy.symbols("k m f n", positive=True)
Quantity = pint.UnitRegistry().Quantity


class TestForms:
    @pytest.mark.parametrize("given", [3, 3.0, sympy.Integer(3), numpy.float64(3), numpy.array(3)])
    def test_numbers(self, given):
        row = as_parameter("k", given)
        assert (row.value, row.unit, row.derived) == (3, "", False)

    def test_tuples(self):
        row = as_parameter("k", (350, "N/mm", "stiffness", "a book"))
        assert row == Parameter(350, "N/mm", "stiffness", "a book")

    def test_quantities(self):
        row = as_parameter("k", Quantity(350, "N/mm"))
        assert resolve({k: row}) == {"k": pytest.approx(350e3)}

    def test_expressions(self):
        row = as_parameter("k", 0.5 * m)
        assert row.derived
        assert row.value == m / 2

    def test_a_constant_expression_is_a_number(self):
        row = as_parameter("k", 2 * sympy.pi)
        assert row.value == pytest.approx(2 * math.pi)
        assert not row.derived

    @pytest.mark.parametrize(
        "given",
        [
            *("3", [3], True, math.nan, math.inf, 1j, pytest.param(object(), id="object")),
            *((3,), (3, 4), (3, "N", "a", "b", "c"), (3, None)),
            *(Parameter("3"), Quantity(numpy.array([1, 2]), "N")),
        ],
        ids=repr,
    )
    def test_anything_else_is_refused(self, given):
        with pytest.raises(ParameterError):
            as_parameter("k", given)


def test_units_are_checked_with_the_parameter_s_name():
    check_unit("k", "N/mm", "N/m")
    with pytest.raises(ParameterError, match=r"'k'.*does not measure"):
        check_unit("k", "kg", "N/m")
