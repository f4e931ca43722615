"""Signal blocks and sensors: states and outputs beside the power graph."""

import numpy as np
import pytest
import sympy

from bondgraph import (
    GY,
    TIME,
    Block,
    C,
    De,
    Df,
    I,
    Integrator,
    Lag,
    One,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    derive,
    linearize,
    simulate,
)
from bondgraph.errors import GraphError, LawError


class TestIntegrator:
    def test_a_pendulum_s_angle(self):
        """th'' = -(g/l) sin th; small swings have the period 2 pi sqrt(l/g)."""
        w = One("w")
        angle = Integrator("angle", w.f, initial=0.1)
        graph = assemble(
            "pendulum", Se("weight", -2 * 9.81 * sympy.sin(angle.y)) >> w >> I("J", 2), angle
        )
        assert [str(state) for state in derive(graph).states] == ["J.p", "angle.y"]
        poles = linearize(graph, at={}).poles()
        grid = np.linspace(0, 10, 2001)
        run = simulate(graph, 10.0, t_eval=grid, rtol=1e-9)
        energy = run["w.f"] ** 2 / 2 - 9.81 * np.cos(run["angle.y"])
        assert np.ptp(energy) < 1e-8
        assert poles.imag.max() == pytest.approx(np.sqrt(9.81 * np.cos(0.1)), rel=1e-9)

    def test_of_time_alone(self):
        clock = Integrator("clock", 2 * TIME, initial=3)
        z = Zero("z")
        graph = assemble("g", Se("E", clock.y) >> z >> R("r", 1), clock, outputs={"y": clock.y})
        assert simulate(graph, 2.0).final["y"] == pytest.approx(7)


class TestLag:
    def test_a_step(self):
        tank = Zero("tank")
        gauge = Lag("gauge", tank.e, 0.5)
        graph = assemble("g", Se("p", 3) >> tank >> R("leak", 1), gauge)
        run = simulate(graph, 1.0, rtol=1e-9)
        assert run.final["gauge.y"] == pytest.approx(3 * (1 - np.exp(-2)), rel=1e-8)
        assert linearize(graph).poles() == pytest.approx([-2])

    @pytest.mark.parametrize("constant", [0, -1])
    def test_time_constants_are_positive(self, constant):
        with pytest.raises(LawError, match="must be positive"):
            Lag("g", sympy.Symbol("x"), constant)


class TestBlock:
    def test_a_controller_closes_the_loop(self):
        """PI control of a motor's speed; poles of the closed loop by hand."""
        j, b, r, k, kp, ki = 2, 0.5, 1.5, 0.8, 4, 3
        w = One("w")
        error = 1 - w.f
        integral = Integrator("integral", error)
        armature = One("armature")
        graph = assemble(
            "drive",
            Se("supply", kp * error + ki * integral.y) >> armature >> R("r", r),
            armature >> GY("motor", k) >> w >> (I("J", j), R("b", b)),
            integral,
        )
        # J w' = k (kp (1-w) + ki y - k w)/r - b w; y' = 1 - w
        matrix = np.array([[-(k * (kp + k) / r + b) / j, k * ki / r / j], [-1, 0]])
        assert sorted(linearize(graph).poles()) == pytest.approx(sorted(np.linalg.eigvals(matrix)))
        assert simulate(graph, 120.0).final["J.p"] / j == pytest.approx(1, rel=1e-6)

    def test_a_nonlinear_filter(self):
        block = Block("x", rate=lambda y: 1 - y**2)
        z = Zero("z")
        graph = assemble("g", Se("E", block.y) >> z >> R("r", 1), block)
        assert simulate(graph, 2.0, rtol=1e-9).final["x.y"] == pytest.approx(np.tanh(2), rel=1e-8)

    def test_it_takes_no_bonds(self):
        with pytest.raises((GraphError, TypeError), match="signal block"):
            assemble("g", Zero("z") >> (Block("x", rate=lambda y: -y), R("r", 1)))


class TestSensors:
    def graph(self):
        z, v = Zero("node"), One("v")
        return assemble(
            "g",
            Sf("i", 2) >> z >> (R("r", 3), De("volt")),
            z >> v >> (Df("amp"), R("s", 6)),
        )

    def test_they_are_outputs(self):
        equations = derive(self.graph())
        values = {name: equations.substituted(value) for name, value in equations.outputs.items()}
        assert values == {"volt": 4, "amp": sympy.Rational(2, 3)}

    def test_they_take_no_power(self):
        equations = derive(self.graph())
        for name in ("volt", "amp"):
            assert equations.substituted(equations.supplied[name]) == 0

    def test_one_that_would_hold_its_junction(self):
        v = One("v")
        with pytest.raises(GraphError, match=r"De 'p'.*hold the flow.*0-junction"):
            assemble("g", Se("e", 1) >> v >> (De("p"), R("r", 1)))
        z = Zero("z")
        with pytest.raises(GraphError, match=r"Df 'a'.*hold the effort.*1-junction"):
            assemble("g", Sf("e", 1) >> z >> (Df("a"), R("r", 1)))

    def test_an_output_of_the_same_name(self):
        z = Zero("z")
        with pytest.raises(GraphError, match="name of a sensor"):
            assemble("g", Sf("i", 1) >> z >> (De("p"), C("c", 1)), outputs={"p": z.e})

    def test_in_a_submodel(self):
        inner = self.graph()
        outer = assemble("outer", inner)
        assert set(outer.outputs) == {"g.volt", "g.amp"}
