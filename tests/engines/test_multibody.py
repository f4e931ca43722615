"""Pendulums against MuJoCo: mass matrices and one second of motion."""

import functools
import random

import numpy as np
import pytest
import sympy

from bondgraph import derive, simulate

from . import multibody, pendulums
from .pendulums import CART, DOUBLE, J1, J2, M
from .presence import need

GRAPHS = {"double": pendulums.double_pendulum(DOUBLE), "cart": pendulums.cart_pendulum(CART)}
COORDINATES = {"double": ("angle1.q", "angle2.q"), "cart": ("rail.q", "angle.q")}
# momenta of the inertias that keep integral causality
MOMENTA = {"double": {"J1.p": J1, "J2.p": J2}, "cart": {"M.p": M, "J.p": J1}}
RATES = {"double": ("w1.f", "w2.f"), "cart": ("cart.f", "arm.f")}
VALUES = {"double": DOUBLE, "cart": CART}


@functools.cache
def inertia(name):
    """Second derivatives of the bond graph's kinetic energy with respect to the rates."""
    equations = derive(GRAPHS[name])
    rates = sympy.symbols("w:2", real=True)
    moved = {
        sympy.Symbol(state, real=True): mass * rate
        for (state, mass), rate in zip(MOMENTA[name].items(), rates, strict=True)
    }
    kinetic = sum(
        equations.substituted(energy)
        for element, energy in equations.energies.items()
        if isinstance(GRAPHS[name].elements[element], pendulums.I)
    )
    matrix = sympy.hessian(kinetic.xreplace(moved), rates).subs(VALUES[name])
    places = [sympy.Symbol(place, real=True) for place in COORDINATES[name]]
    return sympy.lambdify(places, matrix)


@pytest.mark.parametrize("name", GRAPHS)
def test_mass_matrix(name):
    need("mujoco")
    draw = random.Random(name)
    for _ in range(10):
        at = np.array([draw.uniform(-3, 3), draw.uniform(-3, 3)])
        assert inertia(name)(*at) == pytest.approx(multibody.mass_matrix(name, at), abs=1e-12)


@pytest.mark.parametrize(
    ("name", "start"), [("double", [1.2, -0.7, 0.3, 0.5]), ("cart", [0.1, 2.1, 0.0, -0.5])]
)
def test_one_second(name, start):
    need("mujoco")
    expected = multibody.run(name, start, 1.0)
    t = np.linspace(0, 1, expected.shape[1])
    masses = [float(mass.subs(VALUES[name])) for mass in MOMENTA[name].values()]
    initial = dict(zip(COORDINATES[name], start[:2], strict=True)) | {
        state: mass * rate
        for state, mass, rate in zip(MOMENTA[name], masses, start[2:], strict=True)
    }
    run = simulate(GRAPHS[name], (0, 1), initial=initial, t_eval=t, rtol=1e-12)
    assert run.outcome.ok
    found = np.array([run[signal] for signal in (*COORDINATES[name], *RATES[name])])
    assert np.abs(found - expected).max() < 1e-8  # MuJoCo steps by a thousandth
    assert np.ptp(found, axis=1).min() > 0.1
