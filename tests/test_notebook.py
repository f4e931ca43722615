"""Views in a notebook: they parse, escape what they are given, and never raise."""

import json
import re
import subprocess
import sys
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy
import pytest
import sympy

from bondgraph import (
    C,
    I,
    One,
    R,
    Se,
    Sf,
    assemble,
    assign_causality,
    derive,
    linearize,
    models,
    simulate,
)
from bondgraph.errors import BondGraphError
from bondgraph.notebook import VIEWS
from bondgraph.notebook.markup import number, table
from bondgraph.stability import assess

from . import showcase
from .linear.graphs import SYSTEMS

VOID = {"img", "br", "hr", "meta"}


class Tags(HTMLParser):
    """Checks that tags are closed in the order they were opened."""

    def __init__(self):
        super().__init__()
        self.open, self.seen, self.text = [], [], []

    def handle_starttag(self, tag, attrs):
        self.seen.append(tag)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.seen.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def parsed(html):
    tags = Tags()
    tags.feed(html)
    tags.close()
    assert tags.open == []
    return tags


def formulas(latex):
    """What a formula needs no environment for, piece by piece."""
    for cell in re.split(r"\\\\|&|\\begin\{\w+\*?\}|\\end\{\w+\*?\}|\n", latex):
        plain = cell.strip().strip("$").removeprefix(r"\quad").strip()
        if plain and not re.search(
            r"\\vdots|\\left(?!.*\\right)|\\right(?!.*\\left)|\\text", plain
        ):
            yield plain


def renders(latex):
    """Whether matplotlib can typeset a formula's pieces, in the braces' own balance."""
    from matplotlib.mathtext import MathTextParser

    parser = MathTextParser("path")
    assert latex.count("{") == latex.count("}")
    for piece in formulas(latex):
        parser.parse(f"${piece}$")


def everything(graph):
    yield graph
    yield assign_causality(graph)
    yield derive(graph)
    system = linearize(graph)
    yield system
    yield system.at
    yield simulate(graph, 0.2)
    yield assess(graph)


@pytest.mark.parametrize("name", models.LIBRARY)
def test_every_view_of_every_library_model(name):
    graph = getattr(models, name).graph()
    seen = set()
    for value in everything(graph):
        kind = type(value).__name__
        tags = parsed(value._repr_html_())
        assert any(graph.name in text for text in tags.text)
        seen.add((kind, "html"))
        if hasattr(value, "_repr_svg_"):
            assert ElementTree.fromstring(value._repr_svg_()).tag.endswith("svg")
            seen.add((kind, "svg"))
        if hasattr(value, "_repr_latex_"):
            renders(value._repr_latex_())
            seen.add((kind, "latex"))
    assert seen == set(VIEWS)


@pytest.mark.parametrize("name", showcase.GRAPHS)
def test_graphs_with_every_kind_of_element(name):
    graph = showcase.GRAPHS[name]()
    parsed(graph._repr_html_())
    ElementTree.fromstring(graph._repr_svg_())
    equations = derive(graph)
    parsed(equations._repr_html_())
    assert equations._repr_latex_()


@pytest.mark.parametrize("name", SYSTEMS)
def test_linear_systems(name):
    system = SYSTEMS[name]()
    html = system._repr_html_()
    for row in system.damping_table():
        assert all(element in html for element in row.elements)
    assert system.at.equations.name in html
    parsed(html)
    renders(system._repr_latex_())
    parsed(system.at._repr_html_())


class TestGraphs:
    def test_without_causality_it_is_drawn_without_strokes(self):
        v = One("v")
        failing = assemble("fails", Sf("a", 1) >> v, Sf("b", 2) >> v)
        with pytest.raises(BondGraphError):
            assign_causality(failing)
        assert 'class="stroke"' not in failing._repr_svg_()
        assert "Without causal strokes" in failing._repr_html_()
        parsed(failing._repr_html_())

    def test_strokes_and_dependent_storage_are_shown(self):
        brake = models.bicycle_brake.graph()
        assert brake._repr_svg_() == assign_causality(brake)._repr_svg_()
        assert "derivative causality: wheel.tyre" in brake._repr_html_()

    def test_texts_are_escaped(self):
        evil, name = "<script>alert(1)</script> & more", "<script & 'more'"
        k = sympy.Symbol("k", positive=True)
        from bondgraph import Parameter

        spring = C("spring", stiffness=k)
        graph = assemble(name, Se("F", 1) >> One("v") >> (I("m", 1), spring, R("b", 1)),
                         parameters={k: Parameter(3, "N/m", evil)},
                         outputs={"x": (spring.q, "m")})  # fmt: skip
        for value in everything(graph):
            for view in ("html", "svg"):
                text = getattr(value, f"_repr_{view}_", str)()
                assert "<script" not in text
            parsed(value._repr_html_())


class TestEquations:
    def test_mathml_and_units(self):
        html = derive(models.quarter_car.graph())._repr_html_()
        assert html.count("<math") == 4 and "N·s" in html

    def test_large_models_as_text(self):
        nodes = [One(f"v{k}") for k in range(20)]
        parts = [v >> (I(f"m{k}", 1), R(f"b{k}", 1)) for k, v in enumerate(nodes)]
        equations = derive(assemble("many", *parts))
        html = equations._repr_html_()
        assert "der(m7.p)" in html and "<math" not in html
        parsed(html)

    def test_without_states(self):
        bare = derive(assemble("bare", Se("E", 1) >> One("i") >> R("r", 2)))
        parsed(bare._repr_html_())
        assert bare._repr_latex_() == r"$\text{no state equations}$"
        system = linearize(bare.graph)
        assert "no states" in system._repr_html_()
        assert system._repr_latex_() == r"$\text{no states and no outputs}$"


class TestSystems:
    def test_numbers_and_names(self):
        latex = SYSTEMS["driven"]()._repr_latex_()
        assert r"\begin{bmatrix} -0.25 & -8 \\ 0.5 & 0 \end{bmatrix}" in latex
        assert r"\dot{p}_{\mathrm{m}}" in latex and r"\begin{bmatrix} F \end{bmatrix}" in latex

    def test_large_matrices_are_told_by_their_size(self):
        parts = [One(f"v{k}") >> (I(f"m{k}", 1), R(f"b{k}", 1)) for k in range(20)]
        latex = linearize(assemble("many", *parts))._repr_latex_()
        assert r"\left[20 \times 20\right]" in latex

    def test_stability_is_said(self):
        assert "unstable" in linearize(models.mass_on_belt.graph())._repr_html_()
        assert ", stable" in SYSTEMS["driven"]()._repr_html_()
        assert "neither growing nor decaying" in SYSTEMS["unseen"]()._repr_html_()


class TestRuns:
    def test_how_it_ended(self):
        run = simulate(models.mass_on_belt.graph(), 1.0)
        html = run._repr_html_()
        assert "finished at 1 s" in html and "energy dissipated" in html
        assert number(run.final["x"], "m") in html

    def test_a_run_that_failed_tells_the_remedy(self):
        v = One("v")
        law = R("up", effort=lambda f: -(f**3))
        run = simulate(assemble("up", Se("F", 1) >> v >> (I("m", 1), law)), 10.0)
        assert not run.outcome.ok
        html = run._repr_html_()
        assert run.outcome.value in html and run.outcome.advice.split(";")[0] in html.replace(
            "&#x27;", "'"
        )
        ElementTree.fromstring(run._repr_svg_())

    def test_long_runs_stay_small(self):
        run = simulate(models.mass_on_belt.graph(), (0, 20), t_eval=numpy.linspace(0, 20, 60001))
        assert len(run._repr_svg_()) < 300_000

    def test_without_states_and_with_what_is_not_finite(self):
        t_less = R("r", 2)
        bare = assemble("bare", Se("E", 1) >> One("i") >> t_less, outputs={"i": t_less.f})
        parsed(simulate(bare, 1.0)._repr_html_())
        mass = I("m", 1)
        pole = assemble("pole", Se("F", 1) >> One("v") >> mass, outputs={"y": 1 / mass.p})
        run = simulate(pole, 1.0)
        assert "y is not finite" in run._repr_html_()
        ElementTree.fromstring(run._repr_svg_())


class TestMarkup:
    def test_numbers(self):
        assert number(-1.5e-7, "m^2/s") == "\N{MINUS SIGN}1.5e\N{MINUS SIGN}07 m²/s"
        assert number(-numpy.inf) == "\N{MINUS SIGN}∞"

    def test_long_tables_are_cut(self):
        html = table(("n",), [(str(k),) for k in range(1000)])
        assert html.count("<td") == 60 and "and 940 more" in html
        assert table(("n",), []) == ""


def test_showing_a_graph_loads_no_simulation():
    code = (
        "from bondgraph.models import quarter_car; quarter_car.graph()._repr_svg_();"
        "import sys, json; print(json.dumps(sorted(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(json.loads(done.stdout))
    assert not loaded & {"bondgraph.simulation", "bondgraph.stability", "casadi"}


def test_ipython_takes_them():
    formatters = pytest.importorskip("IPython.core.formatters")
    data, _ = formatters.DisplayFormatter().format(SYSTEMS["driven"]())
    assert {"text/plain", "text/html", "text/latex"} <= set(data)
