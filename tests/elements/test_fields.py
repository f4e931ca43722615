"""Multiport fields against matrices and machines with known equations."""

import numpy as np
import pytest
import scipy.linalg
import sympy

from bondgraph import (
    C,
    CField,
    I,
    ICField,
    IField,
    One,
    R,
    RField,
    Se,
    Sf,
    Zero,
    assemble,
    derive,
    linearize,
    simulate,
)
from bondgraph.errors import BondGraphError, GraphError, LawError

K = [[2, -5], [-5, 16]]
M = [[3, 1], [1, 2]]


class TestCField:
    def graph(self, **law):
        beam = CField("beam", ("tip", "middle"), **law)
        tip, middle = One("tip"), One("middle")
        return assemble(
            "beam", tip >> (I("m1", 1), beam["tip"]), middle >> (I("m2", 2), beam["middle"])
        )

    @pytest.mark.parametrize("form", ["stiffness", "compliance", "energy"])
    def test_frequencies_are_those_of_the_matrices(self, form):
        flexibility = np.linalg.inv(np.array(K, dtype=float))
        law = {
            "stiffness": K,
            "compliance": [
                [sympy.nsimplify(v).limit_denominator(1000) for v in row] for row in flexibility
            ],
            "energy": lambda q1, q2: q1**2 - 5 * q1 * q2 + 8 * q2**2,
        }[form]
        poles = linearize(self.graph(**{form: law})).poles()
        squares = scipy.linalg.eigh(np.array(K), np.diag([1, 2]), eigvals_only=True)
        assert sorted(poles.imag) == pytest.approx(sorted([*np.sqrt(squares), *-np.sqrt(squares)]))
        assert poles.real == pytest.approx(0, abs=1e-12)

    def test_the_energy_is_one(self):
        equations = derive(self.graph(stiffness=K))
        assert set(equations.energies) == {"m1", "m2", "beam"}
        q1, q2 = sympy.symbols("beam.tip.q beam.middle.q", real=True)
        assert sympy.expand(equations.energies["beam"] - (q1**2 - 5 * q1 * q2 + 8 * q2**2)) == 0
        assert equations.supplied == {}

    def test_a_nonlinear_field_keeps_energy(self):
        field = CField("f", ("a", "b"), energy=lambda x, y: (x**2 + y**2) ** 2 / 4 + x * y / 2)
        a, b = One("a"), One("b")
        graph = assemble("g", a >> (I("m", 1, initial=1), field["a"]), b >> (I("n", 2), field["b"]))
        run = simulate(graph, 10.0, rtol=1e-10)
        x, y, p, q = (run[name] for name in ("f.a.q", "f.b.q", "m.p", "n.p"))
        energy = (x**2 + y**2) ** 2 / 4 + x * y / 2 + p**2 / 2 + q**2 / 4
        assert energy == pytest.approx(0.5, rel=1e-8)
        assert abs(run.energy.relative_residual) < 1e-8

    def test_a_port_that_a_source_moves(self):
        """One displacement is prescribed through its effort: its state follows from the other's."""
        e, k = sympy.symbols("E k", positive=True)
        field = CField("f", ("a", "b"), stiffness=[[2 * k, -k], [-k, k]])
        b = One("b")
        graph = assemble("g", Se("E", e) >> field["a"], b >> (I("m", 1), R("r", 1), field["b"]))
        equations = derive(graph)
        assert [str(state) for state in equations.states] == ["m.p", "f.b.q"]
        q = sympy.Symbol("f.b.q", real=True)
        q_a = equations.substituted(equations.dependent["f.a"])
        assert sympy.simplify(q_a - (e + k * q) / (2 * k)) == 0
        effort = equations.substituted(equations.ports["f.b.e"])
        assert sympy.simplify(effort - (k * q / 2 - e / 2)) == 0

    def test_ports_must_be_bonded(self):
        beam = CField("beam", ("tip", "middle"), stiffness=K)
        with pytest.raises(GraphError, match=r"field 'beam'.*not bonded \(beam\.middle\)"):
            assemble("g", Zero("z") >> (beam["tip"], I("m", 1)))
        apart = CField("apart", ("a", "b"), stiffness=[[1, 0], [0, 2]])
        with pytest.raises(GraphError, match=r"field 'apart'.*not bonded \(apart\.a\)"):
            assemble("g", Zero("z") >> (apart["b"], I("m", 1)))

    def test_two_fields_of_one_name(self):
        first = CField("f", ("a", "b"), stiffness=K)
        second = CField("f", ("c", "d"), stiffness=K)
        ends = [One(f"v{i}") for i in range(4)]
        ports = [*first.ports.values(), *second.ports.values()]
        with pytest.raises(GraphError, match=r"two fields named 'f'|another field has its name"):
            assemble(
                "g",
                [v >> (I(f"m{i}", 1), p) for i, (v, p) in enumerate(zip(ends, ports, strict=True))],
            )

    def test_copies_are_fields_of_their_own(self):
        graph = self.graph(stiffness=K)
        twin = graph.copy("twin")
        both = derive(assemble("both", graph, twin))
        assert len(both.states) == 8
        assert {"beam.beam", "twin.beam"} <= set(both.energies)
        assert both.supplied == {}


class TestIField:
    def test_coupled_coils(self):
        """L di/dt = e - R i with L full, by hand."""
        coils = IField("coils", ("a", "b"), inertance=M)
        one, two = One("one"), One("two")
        graph = assemble(
            "t", Se("E", 1) >> one >> (R("r1", 5), coils["a"]), two >> (R("r2", 7), coils["b"])
        )
        poles = linearize(graph).poles()
        expected = scipy.linalg.eigvals(-np.diag([5, 7]), np.array(M))
        assert sorted(poles.real) == pytest.approx(sorted(expected.real), rel=1e-12)

    def test_coils_in_series_are_one_coil(self):
        """L1 + L2 + 2 M: the second flux follows from the first."""
        coils = IField("coils", ("a", "b"), inertance=M)
        loop = One("loop")
        graph = assemble("s", Se("E", 1) >> loop >> (R("r", 2), coils["a"], coils["b"]))
        system = linearize(graph)
        assert system.poles() == pytest.approx([-2 / (3 + 2 + 2)])
        assert len(derive(graph).dependent) == 1

    def test_with_an_inertia_beside_it(self):
        coils = IField("coils", ("a", "b"), inertance=M)
        one, two = One("one"), One("two")
        graph = assemble(
            "t", one >> (R("r1", 5), coils["a"]), two >> (R("r2", 7), coils["b"], I("more", 4))
        )
        expected = scipy.linalg.eigvals(-np.diag([5, 7]), np.array(M) + np.diag([0, 4]))
        assert sorted(linearize(graph).poles().real) == pytest.approx(sorted(expected.real))


class TestICField:
    """A solenoid: E = p^2 (1 + x) / (2 L0); current p (1 + x) / L0, force p^2 / (2 L0)."""

    def graph(self):
        l0 = sympy.Symbol("L0", positive=True)
        field = ICField(
            "solenoid",
            {"coil": "I", "gap": "C"},
            energy=lambda p, x: p**2 * (1 + x) / (2 * l0),
        )
        loop, v = One("loop"), One("v")
        return assemble(
            "relay",
            Se("E", 3) >> loop >> (R("r", 2), field["coil"]),
            v >> (I("m", 1), field["gap"], C("spring", stiffness=4), R("b", 1)),
            parameters={l0: 0.5},
        )

    def test_current_and_force(self):
        equations = derive(self.graph())
        p, x, l0 = (
            *sympy.symbols("solenoid.coil.p solenoid.gap.q", real=True),
            sympy.Symbol("L0", positive=True),
        )
        ports = equations.ports
        current = equations.substituted(ports["solenoid.coil.f"])
        force = equations.substituted(ports["solenoid.gap.e"])
        assert sympy.simplify(current - p * (1 + x) / l0) == 0
        assert sympy.simplify(force - p**2 / (2 * l0)) == 0

    def test_power_is_accounted_for(self):
        run = simulate(self.graph(), 5.0, rtol=1e-9)
        assert abs(run.energy.relative_residual) < 1e-8
        assert run.energy.stored > 0


class TestRField:
    @pytest.mark.parametrize("form", ["resistance", "conductance"])
    def test_a_matrix(self, form):
        matrix = np.array([[3.0, 1.0], [2.0, 4.0]])
        given = matrix if form == "resistance" else np.linalg.inv(matrix)
        pad = RField("pad", ("a", "b"), **{form: given})
        one, two = One("one"), One("two")
        graph = assemble("g", one >> (I("m", 1), pad["a"]), two >> (I("n", 2), pad["b"]))
        expected = np.linalg.eigvals(-matrix @ np.diag([1, 0.5]))
        assert sorted(linearize(graph).poles().real) == pytest.approx(sorted(expected.real))

    def test_one_port_in_each_causality(self):
        """A coil takes its effort, a capacitor its flow, from one matrix."""
        pad = RField("pad", ("a", "b"), resistance=[[3, 1], [2, 4]])
        one, two = One("one"), Zero("two")
        graph = assemble("g", one >> (I("m", 1), pad["a"]), two >> (C("c", 1), pad["b"]))
        # e2 = 2 f1 + 4 f2 with e2 = q: f2 = (q - 2 f1)/4; e1 = 3 f1 + f2
        by_hand = np.array([[-(3 - 0.5), -0.25], [0.5, -0.25]])
        assert sorted(linearize(graph).poles()) == pytest.approx(sorted(np.linalg.eigvals(by_hand)))

    def test_a_field_may_gyrate(self):
        """A skew matrix takes no power: two inertias swing against each other."""
        ring = RField("ring", ("a", "b"), resistance=[[0, 3], [-3, 0]])
        one, two = One("one"), One("two")
        graph = assemble("g", one >> (I("m", 1), ring["a"]), two >> (I("n", 4), ring["b"]))
        assert linearize(graph).poles() == pytest.approx([1.5j, -1.5j])

    def test_conduction_between_temperatures_makes_entropy(self):
        g = 2.0
        wall = RField("wall", ("hot", "cold"), flow=lambda t, u: (2 * (t - u) / t, 2 * (u - t) / u))
        hot, cold = Zero("hot"), Zero("cold")
        body = lambda name, s: C(name, energy=lambda S: 50 * 300 * sympy.exp(S / 50), initial=s)  # noqa: E731
        start = 50 * np.log(400 / 300)
        graph = assemble(
            "bodies",
            hot >> (wall["hot"], body("b1", float(start))),
            cold >> (wall["cold"], body("b2", 0)),
        )
        run = simulate(graph, 200.0, rtol=1e-9)
        assert run["hot.e"][-1] == pytest.approx(350 + 50 * np.exp(-2 * g / 50 * 200), rel=1e-6)
        made = run.final["b1.S" if "b1.S" in run.final else "b1.q"] + run.final["b2.q"] - start
        ends = run["hot.e"][-1], run["cold.e"][-1]
        assert made == pytest.approx(50 * np.log(ends[0] * ends[1] / (400 * 300)), rel=1e-6)
        assert run.energy.dissipated == pytest.approx(0, abs=1e-6)


class TestErrors:
    def test_a_matrix_that_makes_energy(self):
        with pytest.raises(LawError, match=r"CField 'f'.*not symmetric"):
            CField("f", ("a", "b"), stiffness=[[1, 2], [3, 4]])

    def test_a_singular_matrix(self):
        with pytest.raises(LawError, match="singular"):
            IField("f", ("a", "b"), inertance=[[1, 1], [1, 1]])

    def test_a_matrix_of_the_wrong_size(self):
        with pytest.raises(LawError, match="1 by 2; 2 ports need 2 by 2"):
            CField("f", ("a", "b"), stiffness=[[1, 2]])

    def test_an_unknown_port(self):
        with pytest.raises(GraphError, match="has no port 'c'; it has a, b"):
            CField("f", ("a", "b"), stiffness=K)["c"]

    @pytest.mark.parametrize("ports", [("a",), ("a", "a"), "a", ("a", "b.c"), ()])
    def test_port_names(self, ports):
        with pytest.raises(BondGraphError):
            CField("f", ports, energy=lambda *q: sum(x**2 for x in q))

    def test_one_law(self):
        with pytest.raises(LawError, match="exactly one of stiffness, compliance, energy"):
            CField("f", ("a", "b"))
        with pytest.raises(LawError, match="stiffness and energy were given"):
            CField("f", ("a", "b"), stiffness=K, energy=lambda a, b: a * b)

    def test_a_law_of_the_wrong_number_of_arguments(self):
        with pytest.raises(LawError, match=r"CField 'f', energy"):
            CField("f", ("a", "b"), energy=lambda q: q**2)
        with pytest.raises(LawError, match="gives 1 expressions for 2 ports"):
            RField("f", ("a", "b"), effort=lambda f, g: (f,))

    def test_the_field_itself_is_no_end_of_a_bond(self):
        with pytest.raises(TypeError, match="name its port"):
            Sf("s", 1) >> CField("f", ("a", "b"), stiffness=K)
