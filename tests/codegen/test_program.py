"""Program: straight-line code that knows what it needs."""

import pytest
import sympy

from bondgraph.codegen import Program
from bondgraph.codegen.program import ProgramError

a, b, c, x, y = sympy.symbols("a b c x y")


def program(arguments=(("x", (x,)),), assignments=((y, x + 1),), results=(("out", (y,)),)):
    return Program("f", arguments, assignments, results)


def test_a_good_program_is_taken():
    assert program().operations == 1


@pytest.mark.parametrize("name", ["", "a b", "1f", "f-g", "a.b"])
def test_a_name_is_an_identifier(name):
    with pytest.raises(ProgramError, match="no identifier"):
        Program(name, (), (), ())


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"arguments": (("x", (x,)), ("z", (x,)))}, "argument x of 'z' stands twice"),
        ({"assignments": ((y, x), (y, x + 1))}, "y is assigned twice"),
        ({"assignments": ((x, sympy.S.One),)}, "x is assigned twice"),
        ({"assignments": ((y, a + x),)}, "assignment of y: a not known"),
        ({"assignments": ((y, c), (c, x))}, "assignment of y: c not known"),
        ({"results": (("out", (a, b)),)}, "result 'out': a not known"),
    ],
)
def test_what_cannot_run_is_refused(changes, said):
    with pytest.raises(ProgramError, match=said):
        program(**changes)


def test_operations_count_every_expression():
    made = program(assignments=((y, x * x + 1), (a, y * x)), results=(("out", (a + 1, y)),))
    assert made.operations == sum(map(sympy.count_ops, (x * x + 1, y * x, a + 1)))


class TestPruned:
    assignments = ((a, x + 1), (b, a * 2), (c, sympy.sin(x)), (y, b + x))

    def kept(self, *results):
        made = Program.pruned("f", [("x", [x])], self.assignments, {"out": results})
        return [symbol for symbol, _ in made.assignments]

    def test_keeps_what_the_results_need_in_order(self):
        assert self.kept(y) == [a, b, y]
        assert self.kept(c) == [c]
        assert self.kept(x) == []
        assert self.kept(c + b) == [a, b, c]

    def test_takes_numbers_and_iterators(self):
        made = Program.pruned(
            "f", iter([("x", iter([x]))]), iter(self.assignments), {"out": iter([1, b])}
        )
        assert made.results == (("out", (sympy.S.One, b)),)
        assert [symbol for symbol, _ in made.assignments] == [a, b]
