"""Heat from dissipation: what friction takes, temperature shows."""

import numpy as np
import pytest
import sympy

from bondgraph import (
    RS,
    TF,
    C,
    Friction,
    I,
    One,
    R,
    Se,
    Sf,
    Zero,
    assemble,
    derive,
    simulate,
)
from bondgraph.errors import GraphError


def warm(rub, store, speed=10):
    v, rotor = One("v"), Zero("rotor")
    return assemble("warm", v >> I("m", 2, initial=2 * speed), v >> rub >> rotor >> store)


class TestTrueBonds:
    def test_the_kinetic_energy_warms_the_body(self):
        """m c (T - T0) = m v^2 / 2, with entropy flow on the thermal bond."""
        graph = warm(RS("pad", 20), C("body", energy=lambda s: 50 * 300 * sympy.exp(s / 50)))
        run = simulate(graph, 5.0, rtol=1e-9)
        assert run["rotor.e"][-1] == pytest.approx(300 + 100 / 50, rel=1e-9)
        assert run.energy.dissipated == pytest.approx(0, abs=1e-7)
        assert run.energy.relative_residual == pytest.approx(0, abs=1e-9)
        assert (np.diff(run["pad_heat.f"]) <= 1e-12).all() and run["pad_heat.f"][0] > 0

    def test_entropy_flow_is_power_over_temperature(self):
        equations = derive(warm(RS("pad", 20), C("body", energy=lambda s: 300 * sympy.exp(s))))
        power = equations.ports["pad.e"] * equations.ports["pad.f"]
        flow = equations.ports["pad_heat.f"]
        ratio = equations.substituted(power / flow / equations.ports["rotor.e"])
        assert sympy.simplify(ratio) == 1


class TestPseudoBonds:
    def test_heat_is_the_flow(self):
        run = simulate(warm(RS("pad", 20, pseudo=True), C("body", 50)), 5.0, rtol=1e-9)
        assert run.final["body.q"] == pytest.approx(100, rel=1e-9)
        assert run["rotor.e"][-1] == pytest.approx(2, rel=1e-9)
        assert run.energy.relative_residual == pytest.approx(0, abs=1e-8)

    def test_a_wall_and_the_air_around(self):
        """Cooling through R to the ambient: T' = -(T - Ta)/(R C)."""
        body, way = Zero("body", pseudo=True), One("way")
        graph = assemble(
            "cooling",
            body >> C("store", 5, initial=5 * 80),
            body >> way >> R("wall", 2),
            way >> Se("ambient", 20),
        )
        run = simulate(graph, 10.0, rtol=1e-9)
        expected = 20 + 60 * np.exp(-10 / 10)
        assert run["body.e"][-1] == pytest.approx(expected, rel=1e-7)
        assert abs(run.energy.relative_residual) < 1e-8

    def test_friction_that_fades_as_it_heats(self):
        """The friction hears the temperature that it makes."""
        rotor, v = Zero("rotor"), One("v")
        temperature = rotor.e
        pads = Friction("pads", kinetic=lambda speed: 4 / (1 + temperature / 10))
        graph = assemble(
            "fade",
            v >> I("m", 2, initial=20),
            v >> RS(pads, pseudo=True) >> rotor >> C("iron", 2),
        )
        run = simulate(graph, 60.0, rtol=1e-9)
        assert run.events[-1].to_mode == "stick"
        assert run.final["iron.q"] == pytest.approx(100, rel=1e-8)
        # distance: F dx = dQ, F = 4/(1 + Q/20): x = (Q + Q^2/40)/4 at Q = 100
        from scipy.integrate import trapezoid

        fine = simulate(graph, 60.0, rtol=1e-9, t_eval=np.linspace(0, 60, 60001))
        assert trapezoid(fine["v.f"], fine.t) == pytest.approx((100 + 100**2 / 40) / 4, rel=1e-5)

    def test_no_transformer_on_heat(self):
        a, b = Zero("a", pseudo=True), Zero("b")
        graph = assemble("g", a >> C("x", 1), a >> TF("t", 2) >> b >> C("y", 1))
        with pytest.raises(GraphError, match=r"TF 't' stands on a pseudo-bond"):
            derive(graph)


class TestErrors:
    def test_not_a_dissipator(self):
        with pytest.raises(GraphError, match="takes a dissipator"):
            RS(I("m", 1))

    def test_law_and_element(self):
        with pytest.raises(GraphError, match="not both"):
            RS(R("r", 1), 2)

    def test_heat_needs_a_way(self):
        rub = RS("pad", 1)
        with pytest.raises(GraphError, match=r"Heat 'pad_heat' has no bond"):
            assemble("g", Sf("s", 1) >> rub, rub.heat)
