"""Transfer functions against textbooks and python-control."""

from __future__ import annotations

import control
import numpy as np
import pytest
import sympy

from bondgraph import C, I, One, R, Se, Sf, Zero, assemble, linearize, models, symbolic_system
from bondgraph.errors import ParameterError

from . import graphs
from .graphs import positive, u

s = sympy.Symbol("s")


def transfer(graph, output, source="u", **extra):
    return symbolic_system(graph, **extra).transfer_function(output, source, s)


def same(found, expected):
    return sympy.cancel(sympy.together(found - expected)) == 0


def test_mass_spring_damper():
    m, b, k = positive("m b k")
    found = transfer(graphs.oscillator(), "x")
    assert found.numerator.coefficients == (1,)
    assert found.denominator.coefficients == (m, b, k)
    assert found.dcgain() == 1 / k and found.relative_degree == 2
    assert found.zeros() == {} and len(found.poles()) == 2


def test_quarter_car():
    # Body speed over road speed, e.g. D. Karnopp, Vehicle System Dynamics; mass, not ratio, form.
    m_s, m_u, k_s, k_t = positive("m_s m_u k_s k_t")
    b = sympy.Symbol("b_s", nonnegative=True)
    found = transfer(models.quarter_car.graph(), "v_body", "v_road")
    above = k_t * (b * s + k_s)
    middle = k_t * m_s + k_s * (m_s + m_u)
    below = m_s * m_u * s**4 + b * (m_s + m_u) * s**3 + middle * s**2 + b * k_t * s + k_s * k_t
    assert same(found.numerator.expression, above) and same(found.denominator.expression, below)
    assert found.dcgain() == 1


def test_quarter_car_against_control():
    graph = models.quarter_car.graph()
    numeric = linearize(graph)
    values = {
        symbol: numeric.at.parameters[symbol.name] for symbol in symbolic_system(graph).parameters
    }
    system = symbolic_system(graph)
    whole = control.ss2tf(control.ss(numeric.A, numeric.B, numeric.C, numeric.D))
    for place, name in enumerate(system.outputs):
        found = system.transfer_function(name, "v_road").expression
        variable = system.s
        for point in (1 + 2j, 10j, -3 + 30j):
            value = complex(found.evalf(20, subs={**values, variable: point}))
            assert value == pytest.approx(complex(whole[place, 0](point)), rel=1e-6)


def test_motor_with_gear():
    L, r, K, J_m, J_l, b_m, b_l, n = positive("L R K J_m J_l b_m b_l n")
    system = symbolic_system(graphs.motor())
    assert len(system.states) == 2  # the load's inertia follows the rotor
    J, b = J_m + n**2 * J_l, b_m + n**2 * b_l
    found = system.transfer_function("speed", "u", s)
    assert same(found.expression, n * K / ((L * s + r) * (J * s + b) + K**2))
    assert same(found.dcgain(), n * K / (r * b + K**2))
    assert system.routh_hurwitz().status.name == "ALWAYS"


def test_ladders():
    R1, R2, C1, C2, L1, L2 = positive("R1 R2 C1 C2 L1 L2")
    found = transfer(graphs.ladder(2, "R"), "y").expression
    assert same(found, 1 / (R1 * R2 * C1 * C2 * s**2 + (R1 * C1 + R1 * C2 + R2 * C2) * s + 1))
    found = transfer(graphs.ladder(1, "RL"), "y").expression
    assert same(found, 1 / (L1 * C1 * s**2 + R1 * C1 * s + 1))
    found = transfer(graphs.ladder(2, "L"), "y").expression
    assert same(found, 1 / (L1 * L2 * C1 * C2 * s**4 + (L1 * C1 + L1 * C2 + L2 * C2) * s**2 + 1))


@pytest.mark.parametrize("cells", [3, 4])
def test_longer_ladders_by_chain_matrices(cells):
    chain = sympy.eye(2)
    for place in range(1, cells + 1):
        r, c, inductance = positive(f"R{place} C{place} L{place}")
        series = sympy.Matrix([[1, r + inductance * s], [0, 1]])
        chain = chain * series * sympy.Matrix([[1, 0], [c * s, 1]])
    found = transfer(graphs.ladder(cells, "RL"), "y")
    assert found.numerator.coefficients == (1,)
    assert sympy.expand(found.denominator.expression - chain[0, 0]) == 0


def test_lead_is_biproper():
    r, R2, c = positive("r R2 c")
    node = Zero("node")
    series, branch = One("series"), Zero("branch")
    graph = assemble(
        "lead",
        Se("E", u) >> series >> node >> R("load", R2),
        series >> branch >> (R("r", r), C("c", c)),
        inputs=[u],
        outputs={"y": node.e},
    )
    found = transfer(graph, "y")
    assert found.relative_degree == 0
    assert same(found.expression, R2 * (r * c * s + 1) / (r * R2 * c * s + r + R2))


def test_rate_of_an_input_counts_as_s_times_it():
    m, b = positive("m b")
    mass = I("mass", m)
    body = One("body")
    graph = assemble(
        "driven", Sf("drive", u) >> body >> (mass, R("b", b)), inputs=[u], outputs={"force": mass.e}
    )
    system = symbolic_system(graph)
    assert [symbol.name for symbol in system.inputs] == ["u", "der(u)"]
    assert [symbol.name for symbol in system.sources] == ["u"]
    found = system.transfer_function("force", "u", s)
    assert found.expression == m * s and found.relative_degree == -1
    assert system.transfer_matrix(s) == sympy.Matrix([[m * s]])


def test_common_factors_cancel_that_no_structure_shows():
    r, c = positive("r c")
    node, loops = Zero("node"), [One("first"), One("second")]
    parts = [
        node >> loop >> (R(f"r{place}", r), C(f"c{place}", c)) for place, loop in enumerate(loops)
    ]
    graph = assemble(
        "twins", Se("E", u) >> node, parts, inputs=[u], outputs={"i": loops[0].f + loops[1].f}
    )
    system = symbolic_system(graph)
    assert system.characteristic_polynomial(s).degree == 2
    found = system.transfer_function("i", "u", s)
    assert found.denominator.coefficients == (c * r, 1)
    assert found.numerator.coefficients == (2 * c, 0)
    assert found.zeros() == {0: 1} and found.poles() == {-1 / (c * r): 1}


def test_unstable_mode_that_cancels():
    a, b = positive("a b")
    first, second = One("first"), One("second")
    mass = I("second_mass", 1)
    graph = assemble(
        "apart",
        Se("E", u) >> first >> (I("first_mass", 1), R("r", a)),
        second >> (mass, R("r2", b)),
        inputs=[u],
        outputs={"v": first.f},
    )
    assert transfer(graph, "v").denominator.coefficients == (1, a)


def test_what_an_input_does_not_reach():
    graph = graphs.oscillator()
    system = symbolic_system(graph, outputs=["push.e", "mass.f"])
    assert system.transfer_function("push.e", "u").expression == 1
    quiet = assemble(
        "quiet",
        Se("E", u) >> Zero("n") >> R("r", 1),
        One("v") >> (i := I("i", 1), R("b", 1)),
        inputs=[u],
        outputs={"p": i.p},
    )
    found = transfer(quiet, "p")
    assert found.expression == 0 and found.dcgain() == 0


def test_free_integrator_has_no_gain_at_zero():
    m = positive("m")
    mass = I("mass", m)
    graph = assemble("free", Se("F", u) >> One("v") >> (mass, C("x", stiffness=0)), inputs=[u])
    found = transfer(graph, "mass.f", outputs=["mass.f"])
    assert found.expression == 1 / (m * s) and found.dcgain() == sympy.zoo


def test_a_parameter_as_input():
    graph = models.mass_on_belt.graph()
    system = symbolic_system(graph, modes={"contact": "stick"}, inputs=["v_b"])
    assert system.transfer_function("x", "v_b", s).expression == 1 / s


def test_matrix_and_dcgain():
    k = positive("k")
    system = symbolic_system(graphs.oscillator(), outputs=["mass.f"])
    matrix = system.transfer_matrix(s)
    assert matrix.shape == (2, 1)
    assert sympy.cancel(matrix[1] - s * matrix[0]) == 0
    assert system.dcgain("x", "u") == 1 / k and system.dcgain("mass.f", u) == 0


def test_unknown_names():
    system = symbolic_system(graphs.oscillator())
    with pytest.raises(ParameterError, match=r"output 'y'.*known: x"):
        system.transfer_function("y", "u")
    with pytest.raises(ParameterError, match="input 'w'"):
        system.transfer_function("x", "w")


def test_zeros_and_poles_against_control():
    r, R2, c = 2.0, 3.0, 0.25
    lead = control.tf([R2 * r * c, R2], [r * R2 * c, r + R2])
    names = positive("r R2 c")
    node, series, branch = Zero("node"), One("series"), Zero("branch")
    graph = assemble(
        "lead",
        Se("E", u) >> series >> node >> R("load", names[1]),
        series >> branch >> (R("r", names[0]), C("c", names[2])),
        inputs=[u],
        outputs={"y": node.e},
    )
    found = transfer(graph, "y")
    values = dict(zip(names, (r, R2, c), strict=True))
    assert np.allclose([float(item.subs(values)) for item in found.poles()], lead.poles().real)
    assert np.allclose([float(item.subs(values)) for item in found.zeros()], lead.zeros().real)
