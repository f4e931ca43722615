"""Ordering of assignments, and loops solved in their own block."""

import itertools
import random

import networkx
import pytest
import sympy

from bondgraph.blocks import AlgebraicLoop, SingularLoopError, expansion, order_and_solve
from bondgraph.blocks.components import components
from bondgraph.blocks.elimination import Affine, Elimination, Names
from bondgraph.blocks.residues import Residues
from bondgraph.blocks.tearing import around, in_order, tear
from bondgraph.errors import AlgebraicLoopError

a, b, u, w, x, y, z = sympy.symbols("a b u w x y z", real=True)


def check_order(ordered, given):
    """Each assignment uses what is given and what stands before it."""
    known = set(given) | set(ordered.algebraic)
    for symbol, expression in ordered.assignments:
        assert expression.free_symbols <= known
        assert symbol not in known
        known.add(symbol)
    for residual in ordered.residuals:
        assert residual.free_symbols <= known
    assert len(ordered.residuals) == len(ordered.algebraic)


def solved(ordered, symbol):
    known = expansion(ordered.assignments, [symbol])
    return sympy.cancel(known[symbol])


class TestComponents:
    @pytest.mark.parametrize("seed", range(50))
    def test_as_networkx_has_them(self, seed):
        rng = random.Random(seed)
        size, density = rng.randint(1, 15), rng.choice([0.05, 0.1, 0.2, 0.4])
        needs = [[j for j in range(size) if rng.random() < density] for _ in range(size)]
        network = networkx.DiGraph()
        network.add_nodes_from(range(size))
        network.add_edges_from((need, i) for i, wanted in enumerate(needs) for need in wanted)
        expected = {frozenset(group) for group in networkx.strongly_connected_components(network)}
        groups = components(needs)
        assert {frozenset(group) for group in groups} == expected
        assert len(groups) == len(expected)
        known = set()
        for group in groups:
            known |= set(group)
            assert group == sorted(group)
            assert all(known.issuperset(needs[member]) for member in group)

    def test_long_chains_do_not_recurse(self):
        size = 5000
        assert components([[i + 1] for i in range(size - 1)] + [[]]) == [
            [i] for i in reversed(range(size))
        ]


class TestOrder:
    def test_dependencies_come_first(self):
        ordered = order_and_solve({x: y + u, y: 2 * z, z: u}, {})
        assert [symbol for symbol, _ in ordered.assignments] == [z, y, x]
        assert ordered.loops == ordered.algebraic == ()

    def test_long_chains_keep_their_order_and_cost_little(self):
        chain = sympy.symbols("c:2000")
        table = {after: before + 1 for before, after in itertools.pairwise(chain)}
        shuffled = dict(random.Random(1).sample(list(table.items()), len(table)))
        ordered = order_and_solve(shuffled, {})
        assert [symbol for symbol, _ in ordered.assignments] == list(chain[1:])

    def test_tables_are_not_changed(self):
        explicit, implicit = {x: u - y, y: 2 * x}, {z: z - x}
        order_and_solve(explicit, implicit)
        assert explicit == {x: u - y, y: 2 * x}
        assert implicit == {z: z - x}


class TestLinearLoops:
    def test_two_variables(self):
        ordered = order_and_solve({x: u - a * y, y: b * x}, {})
        check_order(ordered, [u, a, b])
        assert sympy.cancel(solved(ordered, x) - u / (1 + a * b)) == 0
        assert sympy.cancel(solved(ordered, y) - b * u / (1 + a * b)) == 0
        (loop,) = ordered.loops
        assert (set(loop.variables), loop.solved) == ({"x", "y"}, "linear")

    def test_a_variable_that_depends_on_itself(self):
        ordered = order_and_solve({x: u + x / 3}, {})
        assert solved(ordered, x) == 3 * u / 2

    def test_implicit_variables(self):
        ordered = order_and_solve({y: x + 1}, {x: a * x + y - u})
        check_order(ordered, [u, a])
        assert sympy.cancel(solved(ordered, x) - (u - 1) / (a + 1)) == 0

    def test_only_the_loop_is_solved(self):
        ordered = order_and_solve({w: u**2, x: w - y, y: 2 * x, z: sympy.sin(x)}, {})
        check_order(ordered, [u])
        assert dict(ordered.assignments)[w] == u**2
        assert dict(ordered.assignments)[z] == sympy.sin(x)
        assert ordered.loops[0].variables in {("x", "y"), ("y", "x")}

    def test_coefficients_may_be_any_function_of_what_is_known(self):
        ordered = order_and_solve({x: u - sympy.sin(w) * y, y: sympy.exp(a) * x}, {})
        expected = u / (1 + sympy.sin(w) * sympy.exp(a))
        assert sympy.simplify(solved(ordered, x) - expected) == 0

    def test_terms_that_only_look_nonlinear(self):
        ordered = order_and_solve({x: u - ((y + 1) ** 2 - y**2), y: 2 * x}, {})
        assert ordered.algebraic == ()
        assert sympy.cancel(solved(ordered, x) - (u - 1) / 5) == 0

    def test_exact_arithmetic(self):
        tenth = sympy.Rational(1, 10)
        ordered = order_and_solve({x: tenth * u - 3 * tenth * y, y: 7 * tenth * x}, {})
        assert solved(ordered, x) == u * tenth / (1 + 21 * tenth**2)

    @pytest.mark.parametrize("seed", range(5))
    def test_dense_random_loops(self, seed):
        rng = random.Random(seed)
        size = 7
        unknowns = sympy.symbols(f"v:{size}")
        matrix = sympy.Matrix(size, size, lambda i, j: sympy.Rational(rng.randint(-5, 5), 7))
        right = sympy.Matrix([rng.randint(-3, 3) * u + rng.randint(-3, 3) for _ in unknowns])
        rows = matrix * sympy.Matrix(unknowns) + right
        ordered = order_and_solve(dict(zip(unknowns, rows, strict=True)), {})
        check_order(ordered, [u])
        expected = (sympy.eye(size) - matrix).LUsolve(right)
        for unknown, value in zip(unknowns, expected, strict=True):
            assert sympy.cancel(solved(ordered, unknown) - value) == 0

    def test_symbolic_coefficients_that_cancel_are_seen(self):
        """A pivot that is zero for all parameters must not be divided by."""
        table = {x: u - a * y + a * b * z, y: (a + b) * z - b * z - a * z + x, z: w - x}
        ordered = order_and_solve(table, {})
        assert sympy.cancel(solved(ordered, x) - (u + a * b * w) / (1 + a + a * b)) == 0

    def test_long_loops_do_not_swell(self):
        """A ladder of resistors is one loop; its code stays proportional to its length."""

        def size(cells):
            flows, efforts = sympy.symbols(f"f:{cells}"), sympy.symbols(f"e:{cells + 1}")
            rs = sympy.symbols(f"r:{cells}", positive=True)
            table = {}
            for k in range(cells):
                table[flows[k]] = (efforts[k] - efforts[k + 1]) / rs[k]
                if k:
                    table[efforts[k]] = a * (flows[k - 1] - flows[k])
            ordered = order_and_solve(table, {})
            check_order(ordered, [a, efforts[0], efforts[-1], *rs])
            return sum(sympy.count_ops(value) for _, value in ordered.assignments)

        assert size(60) < 2.2 * size(30)


class TestNonlinearLoops:
    def test_are_kept_as_algebraic_variables(self):
        ordered = order_and_solve({x: u - y, y: x**3}, {})
        check_order(ordered, [u])
        assert len(ordered.algebraic) == 1
        (loop,) = ordered.loops
        assert loop.solved == "algebraic"
        assert loop.tearing == (ordered.algebraic[0].name,)

    def test_residuals_vanish_at_the_solution(self):
        ordered = order_and_solve({x: u - y, y: x**3, z: x + y}, {})
        values = {u: 2, x: 1, y: 1, z: 2}
        assert all(residual.subs(values) == 0 for residual in ordered.residuals)
        assert all((symbol - value).subs(values) == 0 for symbol, value in ordered.assignments)

    def test_the_linear_part_of_the_graph_stays_explicit(self):
        ordered = order_and_solve({x: u - y, y: x**3, w: u - z, z: 2 * w}, {})
        assert len(ordered.algebraic) == 1
        assert [loop.solved for loop in ordered.loops].count("linear") == 1

    @pytest.mark.parametrize(
        "law",
        [
            sympy.Piecewise((x, x > 0), (2 * x, True)),
            sympy.Abs(x),
            sympy.Min(x, 1),
            sympy.exp(x) * sympy.sin(x),
            sympy.Heaviside(x),
        ],
        ids=str,
    )
    def test_laws_of_any_kind_are_kept(self, law):
        ordered = order_and_solve({x: u - y, y: law}, {})
        check_order(ordered, [u])
        assert len(ordered.algebraic) == 1

    def test_a_lone_implicit_nonlinear_variable(self):
        ordered = order_and_solve({}, {x: sympy.tanh(x) - u})
        assert (ordered.algebraic, ordered.residuals) == ((x,), (sympy.tanh(x) - u,))
        assert ordered.loops[0].solved == "algebraic"


class TestSingularLoops:
    def test_undetermined(self):
        with pytest.raises(
            AlgebraicLoopError, match=r"through .* has no unique solution"
        ) as caught:
            order_and_solve({x: y, y: x}, {})
        assert set(caught.value.elements) <= {"x", "y"}
        assert caught.value.bound == frozenset()

    def test_what_it_binds_is_told_in_given_symbols(self):
        with pytest.raises(SingularLoopError) as caught:
            order_and_solve({w: 2 * u, x: y + w, y: x - z}, {})
        assert caught.value.bound == {u, z}

    def test_zero_pivots_are_seen_through_symbols(self):
        with pytest.raises(AlgebraicLoopError):
            order_and_solve({x: (a + b) ** 2 * y, y: x / (a**2 + 2 * a * b + b**2)}, {})


class TestElimination:
    def solve(self, *rows):
        names = Names()
        return Elimination(rows, names), names

    def test_the_sparsest_row_goes_first(self):
        elimination, _ = self.solve(
            Affine({x: a, y: b, z: sympy.S.One}, u),
            Affine({y: a, z: b}, sympy.S.Zero),
            Affine({z: a}, u),
        )
        assert [symbol for symbol, _ in elimination.solved] == [z, y, x]

    def test_no_fill_in_along_a_chain(self):
        chain = sympy.symbols("c:80")
        rows = [Affine({chain[0]: sympy.S.One}, -u)]
        rows += [
            Affine({before: a, after: b}, sympy.S.One)
            for before, after in itertools.pairwise(chain)
        ]
        random.Random(3).shuffle(rows)
        elimination, _ = self.solve(*rows)
        assert len(elimination.solved) == 80
        assert all(len(form.terms) <= 1 for _, form in elimination.solved)

    def test_rows_left_over_tell_what_they_ask_for(self):
        elimination, _ = self.solve(
            Affine({x: sympy.S.One}, u), Affine({x: a}, sympy.S.Zero), Affine({x: b}, u * b)
        )
        assert len(elimination.solved) == 1
        assert elimination.left == [-a * u, 0]

    def test_large_coefficients_are_named_once(self):
        names = Names()
        large = sum(sympy.symbols("k:60"))
        name = names.named(large)
        assert names.assignments == [(name, large)]
        assert names.named(a + b) == a + b

    def test_fractions_do_not_grow_without_end(self):
        chain = sympy.symbols("c:300")
        rows = [Affine({chain[0]: sympy.S.One}, -u)]
        rows += [
            Affine({before: sympy.Rational(k + 2, k + 7), after: sympy.Rational(17, k + 3)}, u)
            for k, (before, after) in enumerate(itertools.pairwise(chain))
        ]
        elimination, names = self.solve(*rows)
        code = names.assignments + elimination.code()
        numbers = set().union(*(value.atoms(sympy.Rational) for _, value in code))
        assert max(len(str(number)) for number in numbers) < 200
        known = expansion(code, [chain[-1]])[chain[-1]]
        exact = u
        for k in range(299):
            exact = -(sympy.Rational(k + 2, k + 7) * exact + u) * sympy.Rational(k + 3, 17)
        assert sympy.expand(known - exact) == 0

    def test_zero_is_seen_through_names(self):
        names = Names()
        large = sum(sympy.symbols("k:60"))
        first, second = names.named(large), names.named(large + 0)
        assert names.is_zero(first - second)
        assert names.tidied(first * a - second * a) == 0
        assert not names.is_zero(first - 2 * second)


class TestResidues:
    @pytest.mark.parametrize(
        "zero",
        [
            (a + b) * (a - b) - a**2 + b**2,
            1 / (a * b) - 1 / a / b,
            a / (a + b) + b / (a + b) - 1,
            sympy.sin(a) ** 2 + sympy.cos(a) ** 2 - 1,
            sympy.exp(a) * b - b * sympy.exp(a) / 2 - b * sympy.exp(a) / 2,
            (1 + a) ** 5 - sympy.expand((1 + a) ** 5),
        ],
        ids=str,
    )
    def test_zero(self, zero):
        assert Residues().is_zero(zero)
        assert not Residues().is_zero(zero + sympy.Rational(1, 10**6))

    @pytest.mark.parametrize(
        "value",
        [a, a - b, sympy.pi, sympy.sin(a) - sympy.sin(b), 1 / (a - a * b), sympy.sqrt(a) - b],
        ids=str,
    )
    def test_not_zero(self, value):
        assert not Residues().is_zero(value)

    def test_a_division_by_zero_is_no_zero(self):
        hidden = (a + b) ** 2 - a**2 - 2 * a * b - b**2
        assert not Residues().is_zero(1 / hidden)

    def test_names_stand_for_what_they_name(self):
        residues = Residues()
        residues.define(w, a + b)
        assert residues.is_zero(w - a - b)


class TestTearing:
    def check(self, table):
        tears = tear(table, table)
        left = {symbol: value for symbol, value in table.items() if symbol not in tears}
        assert len(in_order(left, left)) == len(left)
        return tears

    def test_nothing_to_tear(self):
        assert self.check({x: y + 1, y: z, z: u}) == []

    def test_the_busiest_is_torn(self):
        assert self.check({x: y + z, y: 2 * x, z: 3 * x}) == [x]

    def test_what_depends_on_itself_is_always_torn(self):
        assert self.check({x: x + y, y: x}) == [x]

    def test_random_networks_are_left_without_loops(self):
        rng = random.Random(7)
        for _ in range(50):
            members = sympy.symbols(f"v:{rng.randint(2, 30)}")
            self.check(
                {item: sympy.Add(*rng.sample(members, min(len(members), 2))) for item in members}
            )

    def test_the_cost_of_long_ladders_is_theirs(self):
        cells = 1000
        flows, efforts = sympy.symbols(f"f:{cells}"), sympy.symbols(f"e:{cells}")
        table = {}
        for k in range(1, cells - 1):
            table[flows[k]] = efforts[k] - efforts[k + 1]
            table[efforts[k]] = flows[k - 1] - flows[k]
        assert cells / 3 < len(self.check(table)) <= cells

    def test_a_walk_round_the_loop(self):
        table = {x: z + w, y: x, z: y, w: u}
        assert set(around([x, y, z], table)[:3]) == {x, y, z}


class TestReport:
    def test_a_loop_is_told_variable_by_variable(self):
        loop = AlgebraicLoop(("x", "y"), ("x",), "linear")
        assert str(loop) == "algebraic loop x -> y -> x; solved symbolically for x"
        kept = AlgebraicLoop(("x", "y"), ("x",), "algebraic")
        assert str(kept).endswith("kept as algebraic variables: x")

    def test_loops_of_rates_are_called_so(self):
        assert str(AlgebraicLoop(("der(x)", "y"), ("y",), "linear")).startswith(
            "loop of dependent rates"
        )

    def test_long_loops_are_cut(self):
        names = tuple(f"v{k}" for k in range(20))
        assert "v7 -> ...;" in str(AlgebraicLoop(names, ("v0",), "linear"))

    def test_variables_are_told_in_the_order_of_dependence(self):
        (loop,) = order_and_solve({x: z, y: x + u, z: -y}, {}).loops
        around = loop.variables + loop.variables[:1]
        needs = {"y": "x", "z": "y", "x": "z"}
        assert all(needs[after] == before for before, after in itertools.pairwise(around))


def test_expansion_goes_only_where_it_must():
    assignments = [(x, u + 1), (y, x**2), (z, y + w), (w, sympy.sin(y))]
    assert expansion(assignments[:2], [y]) == {x: u + 1, y: (u + 1) ** 2}
    assert expansion(assignments[:2], [u]) == {}
