"""LaTeX of symbolic results: balanced, readable by a TeX parser, and free of internal names."""

from __future__ import annotations

import re

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.mathtext import MathTextParser

from bondgraph import models, symbolic_system
from bondgraph.models import LIBRARY
from bondgraph.modes import contacts
from bondgraph.symbolic import Polynomial, TransferFunction, routh_hurwitz

from . import graphs
from .graphs import u

ENVIRONMENT = re.compile(r"\\(begin|end)\{(\w+\*?)\}(?:\{[^}]*\})?")
FORBIDDEN = ["Dummy", "loop#", "_Dummy", "**", "sqrt(", "zoo", "nan", "Symbol", "Matrix(", "None"]
COMMAND = re.compile(r"\\[a-zA-Z]+")


def check(text, parse=True):
    """Fail unless braces, environments, \\left and \\right match; also read each formula, which is slow."""
    assert text
    for word in FORBIDDEN:
        assert word not in text, word
    opened = []
    for kind, name in ((match[1], match[2]) for match in ENVIRONMENT.finditer(text)):
        if kind == "begin":
            opened.append(name)
        else:
            assert opened.pop() == name
    assert not opened
    depth = 0
    for letter in re.sub(r"\\[{}]", "", text):
        depth += (letter == "{") - (letter == "}")
        assert depth >= 0
    assert depth == 0
    assert text.count(r"\left") == text.count(r"\right")
    # MathJax and amsmath know these; anything else would be a name that slipped through
    for command in COMMAND.findall(text.replace(BREAK, " ")):
        assert command[1:] in KNOWN, command
    for formula in formulas(text) if parse else ():
        # an ampersand in a name is right in TeX, but not known to this parser
        MathTextParser("path").parse(f"${formula}$".replace(r"\&", "n"))


BREAK = "\\\\"  # two backslashes
KNOWN = {
    *("begin", "end", "left", "right", "frac", "sqrt", "mathrm", "dot", "ddot", "quad", "text"),
    *("displaystyle", "operatorname", "to", "exp", "sin", "cos", "tanh", "log"),
    *("mu", "omega", "tau", "zeta", "theta", "lambda", "sigma", "pi", "alpha", "beta"),
}


def formulas(text):
    """Take environments apart into what stands between & and line ends."""
    bare = text.replace(r"\left[\begin{matrix}", " & ").replace(r"\end{matrix}\right]", " ")
    bare = re.sub(r"\\text\{[^}]*\}", "", ENVIRONMENT.sub("", bare)).replace(r"\displaystyle", "")
    for line in bare.removeprefix("$").removesuffix("$").split(BREAK):
        for cell in re.split(r"(?<!\\)&", line):
            cell = cell.strip().removeprefix(r"\quad").strip()
            if cell and cell not in ("=", "> 0"):
                yield cell


@pytest.fixture(scope="module", params=[*sorted(LIBRARY), "motor", "pendulum", "implicit", "odd"])
def system(request):
    name = request.param
    if name == "odd":
        return symbolic_system(odd_names())
    graph = getattr(models if name in LIBRARY else graphs, name)
    graph = graph.graph() if name in LIBRARY else graph()
    return symbolic_system(graph, modes=dict.fromkeys(contacts(graph), "slip+"))


def odd_names():
    """Names that clash, or hold what TeX reads as a command."""
    from bondgraph import C, I, One, R, Se, assemble

    k_1, k1, mu = sympy.symbols("k_1 k1 mu_50%", positive=True)
    v = One("a_b{c}")
    spring = C("spring&co", stiffness=k1)
    return assemble(
        "odd",
        Se("push", u) >> v >> (I("m#1", k_1), spring, R("r", mu)),
        inputs=[u],
        outputs={"x_max%": spring.q},
    )


def test_system(system):
    check(system.to_latex())
    assert system._repr_latex_() == system.to_latex()


def test_every_state_has_its_dot(system):
    assert system.to_latex().count(r"\dot{") >= len(system.states)


def test_polynomial(system):
    check(system.characteristic_polynomial().to_latex())


def test_transfer_functions(system):
    for source in system.sources:
        for output in system.outputs:
            found = system.transfer_function(output, source)
            check(found.to_latex())
            check(found._repr_latex_())


def test_conditions_and_array(system):
    found = system.routh_hurwitz()
    check(found.to_latex())
    if found.polynomial.degree < 5:
        check(found.array().to_latex())


def test_names_that_clash_are_told_apart():
    system = symbolic_system(odd_names())
    assert len(set(system.names.values())) == len(system.names) == 6
    text = system.to_latex()
    assert r"\mathrm{k\ 1}" in text and "k_{1}" in text and r"\mathrm{50\%}" in text


@pytest.mark.parametrize("numbers, rows", [((1, 2, 3, 1), 1), ((1, 0, 3), 1)])
def test_words_where_there_are_no_conditions(numbers, rows):
    text = routh_hurwitz(numbers).to_latex()
    check(text)
    assert text.count(r"\text{") == rows


SYMBOLS = sympy.symbols("k_f zeta_f rear.mass.p loop.f V0 x", real=True)
COEFFICIENTS = st.recursive(
    st.one_of(st.integers(-9, 9).map(sympy.Integer), st.sampled_from(SYMBOLS)),
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(lambda pair: pair[0] + pair[1]),
        st.tuples(inner, inner).map(lambda pair: pair[0] * pair[1]),
        inner.map(lambda item: item / (1 + SYMBOLS[0] ** 2)),
        inner.map(lambda item: sympy.exp(-item / SYMBOLS[4]) if item.free_symbols else item),
        inner.map(lambda item: sympy.sqrt(item**2 + 1)),
    ),
    max_leaves=5,
)


@settings(deadline=None, max_examples=40)
@given(
    st.lists(COEFFICIENTS, min_size=1, max_size=4), st.lists(COEFFICIENTS, min_size=1, max_size=3)
)
def test_any_coefficients(below, above):
    s = sympy.Symbol("s")
    denominator, numerator = Polynomial((sympy.S.One, *below), s), Polynomial(tuple(above), s)
    check(TransferFunction("x_max", "u", numerator, denominator).to_latex(), parse=False)
    check(routh_hurwitz((1, *below)).to_latex(), parse=False)
