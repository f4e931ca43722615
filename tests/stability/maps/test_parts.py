"""The parts of a map: the table, the explicit equations of rest, the batched search."""

import numpy
import pytest
import sympy

from bondgraph import C, I, One, Parameter, R, Se, Zero, assemble, derive, in_mode, models
from bondgraph.errors import ParameterError
from bondgraph.resolver import resolve
from bondgraph.stability.maps.explicit import explicit_rest
from bondgraph.stability.maps.newton import newton
from bondgraph.stability.maps.table import Table

a, b = sympy.symbols("a b", positive=True)


def tabled(rows):
    v = One("v")
    return derive(assemble("g", Se("F", 1) >> v >> (I("m", a), R("r", b)), parameters=rows))


class TestTable:
    def test_values_are_those_of_the_scalar_table(self):
        graph = models.bicycle_brake.graph()
        equations = derive(graph)
        rng = numpy.random.default_rng(0)
        points = {"k_f": rng.uniform(1e5, 5e5, 7), "V0": rng.uniform(0.3, 1.5, 7)}
        values, refusal = Table(equations, {"mu_s": 0.45}, list(points)).at(points, 7)
        assert not refusal.at.any()
        for place in range(7):
            own = {name: float(column[place]) for name, column in points.items()}
            expected = resolve(graph.parameters, {"mu_s": 0.45, **own})
            for name, value in expected.items():
                assert numpy.broadcast_to(values[name], 7)[place] == pytest.approx(value, rel=1e-15)

    def test_a_derived_parameter_that_is_given_keeps_its_number(self):
        equations = derive(models.bicycle_brake.graph())
        table = Table(equations, {"m_f": 0.2}, ["k_f"])
        values, _ = table.at({"k_f": numpy.array([1e5, 2e5])}, 2)
        assert values["m_f"] == 0.2
        assert values["b_f"] == pytest.approx(0.1 * numpy.sqrt(numpy.array([1e5, 2e5]) * 0.2))

    def test_what_varies_goes_before_what_is_given(self):
        equations = derive(models.bicycle_brake.graph())
        table = Table(equations, {"V0": 3.0, "r_r": 0.1}, ["V0"])
        values, _ = table.at({"V0": numpy.array([1.0, 2.0])}, 2)
        assert values["omega_t"].tolist() == [10.0, 20.0]

    def test_a_derived_value_that_is_not_admissible_is_refused(self):
        rows = {a: Parameter(sympy.sqrt(b - 1)), b: Parameter(2.0)}
        _, refusal = Table(tabled(rows), {}, ["b"]).at({"b": numpy.array([2.0, 0.5, 1.0])}, 3)
        assert refusal.at.tolist() == [False, True, True]
        assert "'a'" in refusal.reason

    def test_a_missing_value_is_named(self):
        with pytest.raises(ParameterError, match="needs a value for a"):
            Table(tabled({a: Parameter(None), b: Parameter(2.0)}), {}, ["b"])


class TestExplicit:
    def rest(self, graph, **modes):
        return explicit_rest(derive(in_mode(graph, modes)))

    def test_the_brake_needs_no_search(self):
        assert self.rest(models.bicycle_brake.graph(), friction="slip+") is not None

    def test_a_law_that_is_not_affine_in_what_it_decides_is_left_to_newton(self):
        v = One("v")
        spring = C("k", effort=lambda q: q + q**3)
        assert self.rest(assemble("duffing", Se("F", 1) >> v >> (I("m", 1), spring))) is None

    def test_a_free_position_is_left_to_newton(self):
        v = One("v")
        assert (
            self.rest(assemble("free", v >> (I("m", 1), R("b", 1), C("at", stiffness=0)))) is None
        )

    def test_linear_blocks_are_solved(self):
        node = Zero("n")
        loop = Se("E", 10) >> One("in") >> (R("r1", 2), node)
        mesh = assemble("mesh", loop, node >> (R("r2", 3), C("c", 5)))
        program = self.rest(mesh)
        assert program is not None
        known = {}
        for symbol, expression in program.assignments:
            known[symbol] = expression.xreplace(known)
        (x,) = dict(program.results)["x"]
        assert x.xreplace(known) == 30  # 10 V over 2 and 3 ohm: 6 V at 5 F


class TestNewton:
    def test_each_point_has_its_own_root_and_damping(self):
        targets = numpy.array([0.5, 2.0, 30.0, 0.01])

        def functions(x, points):
            return numpy.arctan(x - targets[points]), (1 / (1 + (x - targets[points]) ** 2)).T[
                :, :, None
            ]

        x, found, isolated = newton(functions, numpy.full((1, 4), 3.0))
        assert found.all() and isolated.all()
        assert x[0] == pytest.approx(targets, rel=1e-12)

    def test_no_root_is_said(self):
        def functions(x, points):
            del points
            return x**2 + 1, (2 * x.T)[:, :, None]

        assert not newton(functions, numpy.array([[1.0, -2.0]]))[1].any()

    def test_a_line_of_roots_is_not_isolated(self):
        matrix = numpy.array([[1.0, 1.0], [2.0, 2.0]])

        def functions(x, points):
            return matrix @ x - numpy.array([[1.0], [2.0]]), numpy.repeat(
                matrix[None], len(points), axis=0
            )

        x, _, isolated = newton(functions, numpy.zeros((2, 3)))
        assert not isolated.any()
        assert x == pytest.approx(numpy.full((2, 3), 0.5), abs=1e-12)
