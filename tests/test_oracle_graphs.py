"""Bond graphs with answers that textbooks, closed forms or arithmetic by hand give.

Eigenvalues are compared to the digits stated; where a closed form exists it is evaluated here.
"""

import numpy
import pytest
import sympy

from bondgraph import TF, TIME, C, I, One, R, Se, Sf, Zero, assemble, derive, linearize, models
from bondgraph.errors import CausalConflictError, GraphError

RLC_W = numpy.sqrt(3) / 2


def msd(backwards=False):
    v = One("v")
    parts = I("m", 2), C("k", 0.125), R("b", 0.5)
    return assemble(
        "msd", Se("F", 0) >> v, *(part >> v if backwards else v >> part for part in parts)
    )


def parallel_rlc():
    return assemble("rlc", Zero("u") >> (R("r", 1), C("c", 1), I("l", 1)))


def wikipedia():
    """The worked example of Wikipedia's article on bond graphs, with R2 I3 r C6 R7."""
    v, u = One("v"), Zero("u")
    return assemble(
        "wikipedia",
        Se("s", 0) >> v >> (R("R2", 2), I("I3", 0.5)),
        v >> TF("r", 0.3) >> u >> (C("C6", 0.25), R("R7", 4)),
    )


def rigid_pair():
    return assemble("pair", Se("F", 0) >> One("v") >> (I("a", 2), I("b", 3), R("r", 0.5)))


def gear():
    a, z = One("a"), One("z")
    return assemble(
        "gear",
        Se("s", 0) >> a >> (I("i", 2), R("r", 0.5)),
        a >> TF("gear", 0.2) >> z >> (I("j", 3), R("x", 0.7)),
    )


def two_capacitors():
    return assemble("pair", Sf("s", 0) >> Zero("u") >> (C("x", 2), C("y", 3), R("r", 0.5)))


def resistive_loop():
    a, u, z = One("a"), Zero("u"), One("z")
    return assemble(
        "loop",
        Se("s", 0) >> a >> (R("r1", 1.5), u),
        u >> (R("r2", 2.5), z),
        z >> (R("r3", 3.5), C("c", 0.4)),
    )


EIGENVALUES = {
    "parallel RLC": (parallel_rlc, [complex(-0.5, RLC_W)]),
    "mass-spring-damper": (msd, [-0.125 + 1.996089j]),
    "arrows drawn backwards": (lambda: msd(backwards=True), [-0.125 + 1.996089j]),
    "Wikipedia": (wikipedia, [-1.263068, -3.736932]),
    "rigid pair": (rigid_pair, [-0.1]),
    "gear": (gear, [-0.528 / 2.12]),
    "two C on a 0": (two_capacitors, [-0.4]),
    "resistive loop": (resistive_loop, [-0.563380]),
    "quarter car": (models.quarter_car.graph, [-1.643512 + 7.646347j, -15.356488 + 68.328053j]),
}


@pytest.mark.parametrize("name", EIGENVALUES)
def test_eigenvalues(name):
    make, expected = EIGENVALUES[name]
    both = [z for pole in expected for z in ([pole, pole.conjugate()] if pole.imag else [pole])]
    assert linearize(make()).poles() == pytest.approx(numpy.array(both), abs=1.5e-6)


def cells(kind, count, value, capacitance):
    """A ladder: each cell an element in series and a capacitor across."""
    ahead, parts = Se("s", 0), []
    for k in range(count):
        one, zero = One(f"one{k}"), Zero(f"zero{k}")
        parts.append(ahead >> one >> (kind(f"x{k}", value), zero))
        parts.append(zero >> C(f"c{k}", capacitance))
        ahead = zero
    return assemble("ladder", *parts)


@pytest.mark.parametrize("count", [1, 2, 3, 10, 40])
class TestLadders:
    def sines(self, count):
        k = numpy.arange(1, count + 1)
        return numpy.sin((2 * k - 1) * numpy.pi / (2 * (2 * count + 1)))

    def test_rc(self, count):
        r, c = 3, 0.25
        expected = -4 / (r * c) * self.sines(count) ** 2
        assert linearize(cells(R, count, r, c)).poles() == pytest.approx(
            numpy.sort(expected)[::-1], rel=1e-11
        )

    def test_lc(self, count):
        inductance, c = 3, 0.25
        poles = linearize(cells(I, count, inductance, c)).poles()
        expected = 2 / numpy.sqrt(inductance * c) * self.sines(count)
        assert numpy.sort(poles.imag[poles.imag > 0]) == pytest.approx(expected, rel=1e-11)
        assert numpy.abs(poles.real).max() < 1e-11 * expected.max()


class TestStateEquations:
    E, F, V, d, r, c, L = sympy.symbols("E F V d r c L", real=True)

    def rates(self, graph):
        return {state.name: rate for state, rate in derive(graph).explicit().items()}

    def var(self, name):
        return sympy.Symbol(name, real=True)

    def test_rc(self):
        graph = assemble("rc", Se("s", self.E) >> One("v") >> (R("r", self.r), C("c", self.c)))
        expected = (self.E - self.var("c.q") / self.c) / self.r
        assert sympy.simplify(self.rates(graph)["c.q"] - expected) == 0

    def test_two_junctions(self):
        a, u, z = One("a"), Zero("u"), One("z")
        graph = assemble(
            "g",
            Se("s", self.F) >> a >> (I("i", self.L), u),
            Sf("v", self.V) >> u >> z >> (C("c", self.c), R("r", self.r)),
        )
        p, q = self.var("i.p"), self.var("c.q")
        found = self.rates(graph)
        assert (
            sympy.simplify(
                found["i.p"] - (self.F - self.r * self.V - self.r * p / self.L - q / self.c)
            )
            == 0
        )
        assert sympy.simplify(found["c.q"] - (self.V + p / self.L)) == 0

    def test_damper_behind_a_transformer(self):
        a, z = One("a"), One("z")
        graph = assemble(
            "g",
            Se("s", self.F) >> a >> I("i", self.L),
            a >> TF("tf", self.d) >> z >> R("r", self.r),
        )
        p = self.var("i.p")
        assert (
            sympy.simplify(self.rates(graph)["i.p"] - (self.F - self.r * self.d**2 * p / self.L))
            == 0
        )

    def test_duffing_by_energy(self):
        graph = assemble(
            "duffing",
            Sf("s", self.V)
            >> Zero("u")
            >> (C("c", energy=lambda q: q**2 / 2 + q**4 / 4), I("i", 1)),
        )
        p, q = self.var("i.p"), self.var("c.q")
        found = self.rates(graph)
        assert sympy.expand(found["i.p"] - q - q**3) == 0
        assert sympy.expand(found["c.q"] - (self.V - p)) == 0
        energies = derive(graph).energies
        change = sum(
            sympy.diff(energy, state) * found[state.name].subs(self.V, 0)
            for energy in energies.values()
            for state in (p, q)
        )
        assert sympy.expand(change) == 0

    def test_pendulum_by_modulated_transformer(self):
        m, g, length = sympy.symbols("m g l", positive=True)
        arm, angle = One("arm"), C("angle", stiffness=0)
        graph = assemble(
            "pendulum",
            arm >> (I("bob", m * length**2), angle),
            arm >> TF("lever", length * sympy.sin(angle.q)) >> Se("weight", m * g),
        )
        found = self.rates(graph)
        theta = self.var("angle.q")
        assert sympy.simplify(found["bob.p"] + m * g * length * sympy.sin(theta)) == 0
        assert sympy.simplify(found["angle.q"] - self.var("bob.p") / (m * length**2)) == 0

    def test_driven_capacitor(self):
        """q = t exp(-t) solves the equation found, with q(0) = 0."""
        graph = assemble("g", Se("s", sympy.exp(-TIME)) >> One("v") >> (R("r", 1), C("c", 1)))
        q = TIME * sympy.exp(-TIME)
        rate = self.rates(graph)["c.q"].subs(self.var("c.q"), q)
        assert sympy.simplify(sympy.diff(q, TIME) - rate) == 0
        assert q.subs(TIME, 0) == derive(graph).initial[0]

    def test_parallel_rlc_solution(self):
        """q(t) = exp(-t/2)(cos wt - sqrt3 sin wt) from q = p = 1 solves the equations found."""
        found = self.rates(parallel_rlc())
        w = sympy.sqrt(3) / 2
        decay = sympy.exp(-TIME / 2)
        q = decay * (sympy.cos(w * TIME) - sympy.sqrt(3) * sympy.sin(w * TIME))
        p = decay * (sympy.cos(w * TIME) + sympy.sqrt(3) * sympy.sin(w * TIME))
        solution = {self.var("c.q"): q, self.var("l.p"): p}
        assert sympy.simplify(sympy.diff(q, TIME) - found["c.q"].subs(solution)) == 0
        assert sympy.simplify(sympy.diff(p, TIME) - found["l.p"].subs(solution)) == 0
        assert (q.subs(TIME, 0), p.subs(TIME, 0)) == (1, 1)


class TestMustBeReported:
    def test_two_sf_on_one_junction(self):
        v = One("v")
        with pytest.raises(CausalConflictError) as caught:
            derive(assemble("g", Sf("a", 1) >> v, Sf("b", 1) >> v, v >> R("r", 1)))
        assert {"a", "b", "v"} <= set(caught.value.elements)

    def test_two_se_on_one_junction(self):
        u = Zero("u")
        with pytest.raises(CausalConflictError) as caught:
            derive(assemble("g", Se("a", 1) >> u, Se("b", 1) >> u, u >> R("r", 1)))
        assert {"a", "b", "u"} <= set(caught.value.elements)

    def test_effort_source_straight_on_a_capacitor(self):
        u = sympy.Symbol("u", real=True)
        equations = derive(assemble("g", Se("s", u) >> C("c", 2), inputs=[u]))
        assert equations.states == ()
        assert any("C 'c' is in derivative causality" in text for text in equations.warnings)
        rate = equations.input_rates[u]
        assert equations.substituted(equations.ports["c.f"]) == 2 * rate

    def test_a_junction_with_one_bond(self):
        v = One("v")
        with pytest.raises(GraphError, match="'w' is dangling"):
            assemble("g", Se("s", 1) >> v >> R("r", 1), v >> Zero("w"))

    @pytest.mark.parametrize("make", [TF])
    def test_a_two_port_with_one_bond(self, make):
        v = One("v")
        with pytest.raises(GraphError, match="'tf' has 1 bond"):
            assemble("g", Se("s", 1) >> v >> R("r", 1), v >> make("tf", 2))

    def test_disconnected_parts_are_both_solved(self):
        graph = assemble(
            "g", One("v") >> (I("m", 2), R("b", 1)), Zero("u") >> (C("c", 4), R("r", 1))
        )
        assert "2 disconnected parts" in graph.warnings[0]
        assert linearize(graph).poles() == pytest.approx([-0.25, -0.5])

    def test_a_law_forced_into_the_causality_it_cannot_have(self):
        v = One("v")
        stribeck = R("pad", effort=lambda f: sympy.tanh(100 * f) * (2 + sympy.exp(-(f**2))))
        equations = derive(assemble("g", Se("s", 1) >> v >> (C("c", 1), stribeck)))
        assert len(equations.algebraic) == len(equations.residuals) == 1
        assert any("kept as algebraic variables" in text for text in equations.warnings)
