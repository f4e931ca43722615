"""LaTeX: names become symbols, and what comes out can be read by a TeX parser."""

from __future__ import annotations

import re

import pytest
import sympy
from matplotlib.mathtext import MathTextParser

from bondgraph.codegen.program import Program
from bondgraph.codegen.to_latex import align, latex, latex_name, latex_names, to_latex

x, y = sympy.symbols("x y", real=True)
BODY = re.compile(r"\\begin\{align\*\}\n(.*)\n\\end\{align\*\}", re.DOTALL)


def parse(formula):
    """Fail unless matplotlib's parser of TeX formulas takes it."""
    MathTextParser("path").parse(f"${formula}$")


def rows(text):
    """Return the rows of an align* environment without its marks."""
    body = BODY.fullmatch(text)[1]
    return [row.replace("&", " ") for row in body.split(" \\\\\n")]


class TestNames:
    @pytest.mark.parametrize(
        "name, expected",
        [
            ("k", "k"),
            ("k_f", "k_{f}"),
            ("V0", "V_{0}"),
            ("R12", "R_{12}"),
            ("x_1", "x_{1}"),
            ("zeta_f", r"\zeta_{f}"),
            ("omega_t", r"\omega_{t}"),
            ("mu_s", r"\mu_{s}"),
            ("tau", r"\tau"),
            ("Omega", r"\Omega"),
            ("ω_r", r"\omega_{r}"),
            ("λ", r"\lambda"),
            ("k_theta", r"k_{\theta}"),
            ("v_road", r"v_{\mathrm{road}}"),
            ("stiffness", r"\mathrm{stiffness}"),
            ("pi", r"\mathrm{pi}"),
            ("rear.mass.p", r"p_{\mathrm{rear,mass}}"),
            ("wheel.spoke_damping.e", r"e_{\mathrm{wheel,spoke\ damping}}"),
            ("arm.e_in", r"e_{\mathrm{in},\mathrm{arm}}"),
            ("hub>gear.f", r"f_{\mathrm{hub\to gear}}"),
            ("der(rear.mass.p)", r"\dot{p}_{\mathrm{rear,mass}}"),
            ("der(der(v_road))", r"\ddot{v}_{\mathrm{road}}"),
            ("der(omega_t)", r"\dot{\omega}_{t}"),
            ("50%", r"\mathrm{50\%}"),
        ],
    )
    def test_symbol(self, name, expected):
        assert latex_name(name) == expected
        parse(expected)

    @pytest.mark.parametrize("name", ["_", "_x", "a{b}", "a^b", "a$b", "a~b", "a\\b", "ω2", "."])
    def test_odd_names_can_be_read(self, name):
        parse(latex_name(name))

    def test_three_dots(self):
        assert latex_name("x", dots=3) == "x^{(3)}"

    def test_names_stay_distinct(self):
        symbols = sympy.symbols("k_1 k1 a.b_c.e")
        names = latex_names(symbols)
        assert len(set(names.values())) == len(symbols)
        for name in names.values():
            parse(name)


EXPRESSIONS = [
    x / (y + 1),
    sympy.exp(-(x**2) / y),
    sympy.exp(x),
    sympy.exp(x + y) ** 2,
    sympy.sqrt(x**2 + 1),
    sympy.Abs(x) * sympy.sign(x),
    sympy.tanh(1000 * x) * sympy.log(y) * sympy.atan2(x, y),
    sympy.Heaviside(x) ** 2 + sympy.Heaviside(y),
    sympy.Min(x, y) + sympy.Max(x, 2 * y, 3),
    sympy.floor(x) + sympy.ceiling(y) + sympy.erf(x),
    sympy.Rational(981, 100) * x - sympy.pi * y,
    sympy.Symbol("a.b.q") ** 3 * sympy.Symbol("zeta_f"),
    sympy.Dummy("spring.q") * 2,
]


class TestExpressions:
    @pytest.mark.parametrize("expression", EXPRESSIONS, ids=str)
    def test_can_be_read(self, expression):
        parse(latex(expression))

    def test_factors_are_set_apart(self):
        assert latex(x * sympy.Symbol("k_f")) == r"k_{f} \, x"

    def test_a_fraction_in_an_exponent_comes_down(self):
        assert latex(sympy.exp(-x / y)) == r"\exp\left(- \frac{x}{y}\right)"
        assert latex(sympy.exp(-x)) == "e^{- x}"

    def test_given_names(self):
        assert latex(x + 1, {x: r"\xi"}) == r"\xi + 1"

    def test_step_is_not_a_theta(self):
        assert r"\theta" not in latex(sympy.Heaviside(x))


class TestAlign:
    def test_nothing(self):
        assert align([]) == ""

    def test_rows(self):
        assert rows(align([("y", x + 1), ("z", x**2)])) == ["y  = x + 1", "z  = x^{2}"]

    def test_long_sums_are_broken_and_nothing_is_lost(self):
        terms = [sympy.Symbol(f"a_{i}") * sympy.sin(sympy.Symbol(f"b_{i}")) for i in range(24)]
        broken = rows(align([("y", sympy.Add(*terms) - x)]))
        assert len(broken) > 2
        assert all(row.count("a_{") < 12 for row in broken)
        assert sum(row.count(r"\sin") for row in broken) == 24
        assert all(row.lstrip().startswith((r"\quad +", r"\quad -")) for row in broken[1:])
        for row in broken:
            parse(row)

    def test_program(self):
        program = Program("f", (("x", (x,)),), ((y, x + 1),), (("rate", (y**2, -y)),))
        text = to_latex(program)
        assert [row.split(" = ")[0].strip() for row in rows(text)] == [
            "y",
            r"\mathrm{rate}_{1}",
            r"\mathrm{rate}_{2}",
        ]
        for row in rows(text):
            parse(row)
