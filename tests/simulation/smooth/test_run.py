"""The parts of a smooth run: pieces of inputs, silence, scales, and a published stiff problem."""

import sys
import threading

import casadi
import numpy as np
import pytest
import sympy

from bondgraph import TIME, C, I, One, R, Se, Zero, assemble, derive
from bondgraph.simulation.inputs import at
from bondgraph.simulation.outcome import Outcome
from bondgraph.simulation.problem import InputTable, Options
from bondgraph.simulation.smooth import (
    SmoothFunctions,
    SmoothProblem,
    integrate_smooth,
    smooth_functions,
)
from bondgraph.simulation.smooth.pieces import own_grid, pieces
from bondgraph.simulation.smooth.quiet import quiet
from bondgraph.simulation.smooth.scales import typical

NONE = np.zeros(0)


class TestPieces:
    table = InputTable(
        np.array([0.0, 1.0, 2.0, 4.0]),
        np.array([[1.0, 0.0], [1.0, 4.0], [3.0, 4.0], [3.0, 0.0]]),
        np.array([0, 1]),
    )

    def test_they_give_the_inputs_everywhere(self):
        parts = pieces(self.table, (-1.0, 6.0))
        assert [part.start for part in parts] == [-1, 0, 1, 2, 4]
        for part in parts:
            for t in np.linspace(part.start, part.end, 7)[:-1]:
                here = part.at(t)
                assert here == pytest.approx(at(self.table, np.array([t]))[:, 0], abs=1e-12)

    def test_jumps_are_told_from_bends(self):
        jumps = [part.jumps for part in pieces(self.table, (-1.0, 6.0))]
        assert jumps == [True, False, False, True, False]

    def test_knots_that_change_nothing_do_not_cut(self):
        table = InputTable(np.arange(5.0), np.ones((5, 1)), np.array([0]))
        assert len(pieces(table, (0.0, 9.0))) == 1

    def test_the_grid_is_dense_after_jumps_only(self):
        times = own_grid(pieces(self.table, (-1.0, 6.0)))
        assert {-1.0, 0.0, 1.0, 2.0, 4.0, 6.0} <= set(times)
        gaps = {start: np.diff(times[times >= start])[0] for start in (-1.0, 1.0, 2.0)}
        assert gaps[-1.0] < 1e-7 and gaps[2.0] < 1e-7 and gaps[1.0] > 1e-3


class TestQuiet:
    def test_other_threads_are_heard(self, capsys):
        with quiet() as heard:
            print("mine", file=sys.stderr)
            other = threading.Thread(target=lambda: print("theirs", file=sys.stderr))
            other.start()
            other.join()
        assert "".join(heard) == "mine\n"
        assert capsys.readouterr().err == "theirs\n"

    def test_the_stream_is_put_back(self):
        before = sys.stderr
        with pytest.raises(ValueError, match="out"), quiet():
            raise ValueError("out")
        assert sys.stderr is before

    def test_while_threads_overlap(self):
        before, inner, leave = sys.stderr, threading.Event(), threading.Event()

        def stay():
            with quiet():
                inner.set()
                leave.wait(10)

        thread = threading.Thread(target=stay)
        with quiet():
            thread.start()
            inner.wait(10)
        leave.set()
        thread.join()
        assert sys.stderr is before


class TestScales:
    def sizes(self, graph, samples, span):
        functions = smooth_functions(derive(graph), derive(graph).parameters)
        start = np.zeros(functions.n), np.zeros(functions.nz)
        return typical(functions, samples, start, NONE, span)

    def test_a_fast_circuit_in_a_long_run(self):
        """10 V on 1 kohm and 1 nF: 1e-8 C, after a microsecond of a run of an hour."""
        graph = assemble("rc", Se("E", 10) >> One("v") >> (R("r", 1000), C("c", 1e-9)))
        (charge,), _ = self.sizes(graph, [(0.0, NONE)], 3600.0)
        assert 0.9e-8 < charge < 1.1e-8

    def test_an_oscillator(self):
        """Pushed with 1 N a mass of 1 kg on 1e4 N/m swings to 2e-4 m and 1e-2 N s."""
        parts = (I("m", 1), C("k", stiffness=1e4))
        momentum, way = self.sizes(
            assemble("o", Se("F", 1) >> One("v") >> parts), [(0.0, NONE)], 1.0
        )[0]
        assert 2e-3 < momentum < 5e-2 and 5e-5 < way < 1e-3

    def test_an_algebraic_variable(self):
        law = R("r", effort=lambda f: 4 * f + f**3)
        graph = assemble("g", Se("E", sympy.cos(TIME)) >> One("v") >> (C("c", 1), law))
        (_,), (flow,) = self.sizes(graph, [(0.0, NONE)], 1e-3)
        assert flow == pytest.approx(0.25, rel=1e-3)

    def test_what_never_moves_is_measured_all_the_same(self):
        graph = assemble("g", Zero("u") >> (C("c", 1), R("r", 1)))
        assert self.sizes(graph, [(0.0, NONE)], 1.0)[0] == [1.0]


def ring_modulator():
    """Fifteen states, four diodes; problem and values from the test set of Mazzia and Magherini.

    F. Mazzia, C. Magherini, Test Set for Initial Value Problem Solvers, release 2.4, University of
    Bari, 2008: ring modulator.
    """
    c, c_s, c_p, l_h, l_1, l_2 = 1.6e-8, 2e-12, 1e-8, 4.45, 2e-3, 5e-4
    y, t = casadi.SX.sym("y", 15), casadi.SX.sym("t")
    y1, y2, y3, y4, y5, y6, y7, y8, y9, y10, y11, y12, y13, y14, y15 = casadi.vertsplit(y)
    tone, carrier = 0.5 * casadi.sin(2e3 * casadi.pi * t), 2 * casadi.sin(2e4 * casadi.pi * t)

    def current(volts):
        return 40.67286402e-9 * (casadi.exp(17.7493332 * volts) - 1)

    one, two = current(y3 - y5 - y7 - carrier), current(-y4 + y6 - y7 - carrier)
    three, four = current(y4 + y5 + y7 + carrier), current(-y3 - y6 + y7 + carrier)
    rates = casadi.vertcat(
        (y8 - 0.5 * y10 + 0.5 * y11 + y14 - y1 / 25e3) / c,
        (y9 - 0.5 * y12 + 0.5 * y13 + y15 - y2 / 25e3) / c,
        (y10 - one + four) / c_s,
        (-y11 + two - three) / c_s,
        (y12 + one - three) / c_s,
        (-y13 - two + four) / c_s,
        (-y7 / 50 + one + two - three - four) / c_p,
        -y1 / l_h,
        -y2 / l_h,
        (0.5 * y1 - y3 - 17.3 * y10) / l_2,
        (-0.5 * y1 + y4 - 17.3 * y11) / l_2,
        (0.5 * y2 - y5 - 17.3 * y12) / l_2,
        (-0.5 * y2 + y6 - 17.3 * y13) / l_2,
        (-y1 + tone - (50 + 36.3) * y14) / l_1,
        (-y2 - (600 + 36.3) * y15) / l_1,
    )
    none = casadi.SX(0, 1)
    arguments = [t, y, casadi.SX.sym("z", 0), casadi.SX.sym("u", 0), casadi.SX.sym("p", 0)]
    slopes = [casadi.densify(casadi.jacobian(rates, y)), casadi.SX(15, 0), casadi.SX(0, 15)]
    return SmoothFunctions(
        n=15,
        nz=0,
        m=0,
        np=0,
        names=(),
        rates=casadi.Function("rates", arguments, [rates, none, casadi.SX.zeros(2)]),
        residual=casadi.Function("residual", arguments, [none, casadi.SX(0, 0), none]),
        slopes=casadi.Function("slopes", arguments, [rates, none, *slopes, casadi.SX(0, 0)]),
    )


PUBLISHED = [
    -0.2339057358486745e-1,
    -0.7367485485540825e-2,
    0.2582956709291169,
    -0.4064465721283450,
    -0.4039455665149794,
    0.2607966765422943,
    0.1106761861269975,
    0.2939904342435596e-6,
    -0.2840029933642329e-7,
    0.7267198267264553e-3,
    0.7929487196960840e-3,
    -0.7255283495698965e-3,
    -0.7941401968526521e-3,
    0.7088495416976114e-4,
    0.2390059075236570e-4,
]


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["cvodes", "idas", "rosenbrock"])
def test_the_ring_modulator_to_five_digits(solver):
    inputs = InputTable(np.zeros(1), np.zeros((1, 0)), NONE)
    options = Options(rtol=1e-8)
    problem = SmoothProblem(
        ring_modulator(), NONE, np.zeros(15), NONE, (0.0, 1e-3), inputs, solver, options
    )
    solution = integrate_smooth(problem)
    assert solution.outcome is Outcome.FINISHED
    assert solution.x_end == pytest.approx(PUBLISHED, rel=1e-5)
