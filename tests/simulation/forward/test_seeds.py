"""Derivatives of the parameter table and of the initial state, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

from bondgraph import C, CompiledModel, I, One, R, assemble, sensitivities
from bondgraph.errors import ParameterError
from bondgraph.models import bicycle_brake
from bondgraph.simulation.forward.seeds import Seeds

k, m, f, zeta, b = sympy.symbols("k m f zeta b", positive=True)


def tuned():
    v = One("v")
    spring = C("spring", stiffness=k, initial=m / k)
    return assemble(
        "tuned",
        v >> (I("mass", m), spring, R("damper", b)),
        parameters={
            k: (8, "N/mm"),
            f: (20, "Hz"),
            m: k / (2 * sympy.pi * f) ** 2,
            zeta: 0.1,
            b: 2 * zeta * sympy.sqrt(k * m),
        },
        outputs={"speed": (v.f, "m/s")},
    )


def seeds(wrt, overridden=None, initial=(), x0=(0.0, 0.0)):
    model = CompiledModel(tuned())
    values = model.resolver(overridden or {})
    found = Seeds(model.equations, tuple(wrt), tuple(overridden or ()), tuple(initial))
    by_p, by_x = found(values, np.array(x0))
    names = [symbol.name for symbol in model.equations.parameters]
    rows = [state.name for state in model.equations.states]
    return dict(zip(names, by_p, strict=True)), dict(zip(rows, by_x, strict=True)), values


def test_a_parameter_acts_through_those_derived_from_it():
    p, x, values = seeds(["k", "f", "zeta"])
    mass, damping = values["m"], values["b"]
    assert p["k"] == pytest.approx([1, 0, 0])
    assert p["m"] == pytest.approx([mass / 8000, -2 * mass / 20, 0])
    # b = 2 zeta sqrt(k m) is proportional to k and 1/f
    assert p["b"] == pytest.approx([damping / 8000, -damping / 20, damping / 0.1])
    assert x["spring.q"] == pytest.approx([0, -2 * mass / 8000 / 20, 0], abs=1e-18)
    assert x["mass.p"] == pytest.approx([0, 0, 0])


def test_one_that_has_a_number_of_its_own_stays():
    p, _, values = seeds(["k"], {"m": 0.3})
    assert p["m"] == pytest.approx([0])
    assert p["b"] == pytest.approx([values["b"] / 16000])


def test_a_derived_one_moves_alone():
    p, x, values = seeds(["m", "b"])
    assert p["k"] == pytest.approx([0, 0])
    assert p["b"] == pytest.approx([values["b"] / (2 * values["m"]), 1])
    assert x["spring.q"] == pytest.approx([1 / 8000, 0])


def test_an_initial_value_given_by_an_output_moves_with_what_it_depends_on():
    p, x, values = seeds(["k", "mass.p"], initial=["speed", "spring.q"], x0=(0.7, 0.0))
    del p
    mass = values["m"]
    assert x["mass.p"] == pytest.approx([0.7 / mass * mass / 8000, 1])
    assert x["spring.q"] == pytest.approx([0, 0])


def test_a_table_without_a_slope_is_refused():
    width = sympy.Symbol("width", nonnegative=True)
    r = sympy.Symbol("r", nonnegative=True)
    graph = assemble(
        "root",
        One("v") >> (I("m", 1), R("r", r)),
        parameters={width: 0.0, r: sympy.sqrt(width)},
    )
    with pytest.raises(ParameterError, match="no finite slope by width"):
        sensitivities(graph, 1.0, ["width"])


def test_the_sheet_of_the_brake():
    """omega_t = V0/r_r; p_l = F_k/(mu_k A_p); the wheel starts with J_r omega_t."""
    model = CompiledModel(bicycle_brake.graph())
    values = model.resolver()
    x0 = np.zeros(len(model.equations.states))
    by_p, by_x = Seeds(model.equations, ("V0", "mu_k"), (), ())(values, x0)
    rows = dict(zip((s.name for s in model.equations.parameters), by_p, strict=True))
    assert rows["omega_t"] == pytest.approx([1 / 0.08, 0])
    assert rows["p_l"] == pytest.approx([0, -values["p_l"] / 0.4])
    assert rows["mu_k"] == pytest.approx([0, 1])
    assert by_x[0] == pytest.approx([values["J_r"] / 0.08, 0])
