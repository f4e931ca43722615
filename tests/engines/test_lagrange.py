"""Pendulums against sympy.physics.mechanics: accelerations, eigenvalues and five seconds of motion."""

import functools
import random
from dataclasses import dataclass

import numpy as np
import pytest
import sympy
from sympy import cos, sin

from bondgraph import derive, linearize, simulate
from bondgraph.graph import BondGraph

from ..collection.case import vanishes
from . import lagrange, pendulums
from .pendulums import CART, DOUBLE, J1, J2, M, l1, l2, m1, m2


@dataclass(frozen=True)
class Pair:
    """A bond graph, a motion, and the graph's states in the motion's coordinates and rates.

    `same` names the graph's own variables that are these coordinates and rates.
    """

    graph: BondGraph
    motion: lagrange.Motion
    same: tuple[str, ...]
    states: dict[str, sympy.Expr]
    values: dict[sympy.Symbol, float]
    rests: dict[str, tuple[float, ...]]

    def start(self, at: list[float]) -> dict[str, float]:
        """The graph's states, as numbers, at coordinates and rates."""
        numbers = dict(zip((*self.motion.q, *self.motion.w), at, strict=True)) | self.values
        return {name: float(state.subs(numbers)) for name, state in self.states.items()}

    @functools.cached_property
    def unbalanced(self) -> list[sympy.Expr]:
        """``mass @ accelerations - force`` with the accelerations that the bond graph gives."""
        motion, equations = self.motion, derive(self.graph)
        names = {symbol: self.states[symbol.name] for symbol in equations.states}
        states = sympy.Matrix([*names.values()])
        rates = sympy.Matrix([equations.substituted(rate) for rate in equations.derivatives])
        carried = states.jacobian(motion.q) * sympy.Matrix(motion.w)
        left = states.jacobian(motion.w)
        momenta = [row for row in range(len(states)) if any(left.row(row))]
        change = (rates.subs(names, simultaneous=True) - carried).extract(momenta, [0])
        accelerations = left.extract(momenta, list(range(left.cols))).LUsolve(change)
        return list(motion.mass * accelerations - motion.force)


ANGLES = ("angle1.q", "angle2.q", "w1.f", "w2.f")


def double() -> Pair:
    motion = lagrange.double_pendulum()
    (q1, q2), (w1, w2) = motion.q, motion.w
    return Pair(
        graph=pendulums.double_pendulum(DOUBLE),
        motion=motion,
        same=ANGLES,
        states={"J1.p": J1 * w1, "angle1.q": q1, "J2.p": J2 * w2, "angle2.q": q2},
        values=DOUBLE,
        rests={"hanging": (0, 0), "upright": (np.pi, np.pi), "folded": (0, np.pi)},
    )


def bobs() -> Pair:
    """The double pendulum without inertia of the rods: the states are momenta across."""
    whole = lagrange.double_pendulum()
    bare = {J1: 0, J2: 0}
    mass, force, energy = (item.subs(bare) for item in (whole.mass, whole.force, whole.energy))
    (q1, q2), (w1, w2) = whole.q, whole.w
    speed = l1 * cos(q1) * w1
    values = {symbol: value for symbol, value in DOUBLE.items() if symbol not in bare}
    return Pair(
        graph=pendulums.double_pendulum(values, rods=False),
        motion=lagrange.Motion(whole.q, whole.w, mass, force, energy),
        same=ANGLES,
        states={
            "angle1.q": q1,
            "angle2.q": q2,
            "m1x.p": m1 * speed,
            "m2x.p": m2 * (speed + l2 * cos(q2) * w2),
        },
        values=values,
        rests={"hanging": (0, 0), "upright": (np.pi, np.pi)},
    )


def cart() -> Pair:
    motion = lagrange.cart_pendulum()
    (x, q), (v, w) = motion.q, motion.w
    return Pair(
        graph=pendulums.cart_pendulum(CART),
        motion=motion,
        same=("rail.q", "angle.q", "cart.f", "arm.f"),
        states={"M.p": M * v, "rail.q": x, "J.p": J1 * w, "angle.q": q},
        values=CART,
        rests={"hanging": (0, 0), "upright": (0, np.pi)},
    )


PAIRS = {make.__name__: functools.cache(make) for make in (double, bobs, cart)}
RESTS = [
    (name, rest)
    for name, rests in {
        "double": ("hanging", "upright", "folded"),
        "bobs": ("hanging", "upright"),
        "cart": ("hanging", "upright"),
    }.items()
    for rest in rests
]
STARTS = {
    "double": [1.2, -0.7, 0.3, 0.5],
    "bobs": [0.5, -0.4, 0.0, 0.2],
    "cart": [0.1, 2.1, 0.0, -0.5],
}


def rational_point(expression: sympy.Expr, draw: random.Random, angles: tuple[sympy.Symbol, ...]):
    """Value where all symbols, sines and cosines are random fractions."""

    def fraction() -> sympy.Rational:
        return sympy.Rational(draw.randint(1, 99), draw.randint(1, 99))

    tangents = {angle: fraction() for angle in angles}
    exact = {sin(a): 2 * t / (1 + t**2) for a, t in tangents.items()}
    exact |= {cos(a): (1 - t**2) / (1 + t**2) for a, t in tangents.items()}
    value = expression.xreplace(exact)
    assert len(value.free_symbols) > 5
    return value.xreplace({symbol: fraction() for symbol in sorted(value.free_symbols, key=str)})


@pytest.mark.parametrize("name", PAIRS)
class TestAccelerations:
    def test_as_expressions(self, name):
        pair = PAIRS[name]()
        for row in pair.unbalanced:
            assert row != 0 and vanishes(row)
            assert not vanishes(row + pair.motion.w[1])

    def test_at_random_rational_points(self, name):
        pair, draw = PAIRS[name](), random.Random(name)
        for row in pair.unbalanced:
            for _ in range(5):
                assert rational_point(row, draw, pair.motion.q) == 0


def by_place(poles: np.ndarray) -> np.ndarray:
    return np.array(sorted(poles, key=lambda pole: (round(pole.real, 6), round(pole.imag, 6))))


@pytest.mark.parametrize(("name", "rest"), RESTS)
def test_eigenvalues(name, rest):
    pair = PAIRS[name]()
    angles = pair.rests[rest]
    at = pair.start([*angles, *[0.0] * len(angles)])
    found = by_place(linearize(pair.graph, at=at).poles())
    expected = by_place(pair.motion.poles(pair.values, angles))
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).min()


@pytest.mark.parametrize("name", STARTS)
def test_five_seconds(name):
    pair, t = PAIRS[name](), np.linspace(0, 5, 501)
    expected = pair.motion.run(pair.values, STARTS[name], t)
    run = simulate(pair.graph, (0, 5), initial=pair.start(STARTS[name]), t_eval=t, rtol=1e-12)
    assert run.outcome.ok
    assert abs(run.energy.relative_residual) < 1e-9
    found = np.array([run[name] for name in pair.same])
    assert np.abs(found - expected).max() < 1e-7
    energies = pair.motion.energies(pair.values, found)
    assert np.ptp(energies) < 1e-9 * np.ptp(found[2:]) ** 2
