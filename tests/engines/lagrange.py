"""Equations of motion by sympy.physics.mechanics, from frames, points and bodies.

The double pendulum is done by Lagrange's method, the cart with a pendulum by Kane's, so that the
two ways check each other's use as well.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import sympy
from scipy.integrate import solve_ivp
from sympy.physics import mechanics

from .pendulums import J1, J2, F, M, g, k, l1, l2, m1, m2


@dataclass(frozen=True)
class Motion:
    """Equations ``mass @ accelerations = force`` in plain symbols.

    Attributes
    ----------
    q, w : tuple of Symbol
        Coordinates and their rates.
    mass : (n, n) Matrix
    force : (n, 1) Matrix
    energy : Expr
        Kinetic and potential.
    """

    q: tuple[sympy.Symbol, ...]
    w: tuple[sympy.Symbol, ...]
    mass: sympy.Matrix
    force: sympy.Matrix
    energy: sympy.Expr

    def poles(self, values: dict[sympy.Symbol, float], at: tuple[float, ...]) -> np.ndarray:
        """Eigenvalues of the motion about a rest at `at`, from the pencil in q and w."""
        rest = dict(zip(self.q, at, strict=True)) | dict.fromkeys(self.w, 0) | values

        def number(matrix: sympy.Matrix) -> np.ndarray:
            return np.array(matrix.subs(rest), dtype=float)

        n = len(self.q)
        mass = scipy.linalg.block_diag(np.eye(n), number(self.mass))
        slopes = number(self.force.jacobian([*self.q, *self.w]))
        system = np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), slopes])
        return scipy.linalg.eigvals(system, mass)

    def run(
        self, values: dict[sympy.Symbol, float], start: list[float], t: np.ndarray
    ) -> np.ndarray:
        """Coordinates and rates at times t, by DOP853; (2n, nt)."""
        names = [*self.q, *self.w]
        mass, force = (
            sympy.lambdify(names, matrix.subs(values)) for matrix in (self.mass, self.force)
        )

        def rates(_t: float, y: np.ndarray) -> np.ndarray:
            return np.concatenate([y[len(self.q) :], np.linalg.solve(mass(*y), force(*y))[:, 0]])

        done = solve_ivp(
            rates, (t[0], t[-1]), start, method="DOP853", t_eval=t, rtol=1e-12, atol=1e-13
        )
        assert done.success
        return done.y

    def energies(self, values: dict[sympy.Symbol, float], y: np.ndarray) -> np.ndarray:
        """Energy at states y of shape (2n, nt)."""
        return sympy.lambdify([*self.q, *self.w], self.energy.subs(values))(*y)


def rod(name: str, angle: sympy.Expr, frame, start, length, mass, inertia):
    """A bob with an inertia about its own centre, hung from a point of known velocity."""
    arm = frame.orientnew(f"{name}_arm", "Axis", [angle, frame.z])
    bob = start.locatenew(f"{name}_bob", -length * arm.y)
    bob.v2pt_theory(start, frame, arm)
    tensor = mechanics.inertia(arm, 0, 0, inertia)
    return bob, mechanics.RigidBody(name, bob, arm, mass, (tensor, bob))


def plain(expressions, q, w):
    """Exchange functions of time and their rates for symbols."""
    rates = {item.diff(): sympy.Symbol(f"w_{item.name}", real=True) for item in q}
    speeds = dict(zip(w, rates.values(), strict=True)) if w else {}
    places = {item: sympy.Symbol(item.name, real=True) for item in q}
    return (
        tuple(places.values()),
        tuple(rates.values()),
        *(item.subs(rates).subs(speeds).subs(places) for item in expressions),
    )


def double_pendulum() -> Motion:
    """Angles of both rods from hanging, by Lagrange's method."""
    q = mechanics.dynamicsymbols("q1 q2")
    frame, pivot = mechanics.ReferenceFrame("N"), mechanics.Point("O")
    pivot.set_vel(frame, 0)
    bob1, body1 = rod("upper", q[0], frame, pivot, l1, m1, J1)
    bob2, body2 = rod("lower", q[1], frame, bob1, l2, m2, J2)
    body1.potential_energy = m1 * g * bob1.pos_from(pivot).dot(frame.y)
    body2.potential_energy = m2 * g * bob2.pos_from(pivot).dot(frame.y)
    bodies = body1, body2
    method = mechanics.LagrangesMethod(mechanics.Lagrangian(frame, *bodies), q)
    method.form_lagranges_equations()
    energy = sum(body.kinetic_energy(frame) + body.potential_energy for body in bodies)
    return Motion(*plain((method.mass_matrix, method.forcing, energy), q, ()))


def cart_pendulum() -> Motion:
    """Place of the cart and angle of the rod from hanging, by Kane's method."""
    q, w = mechanics.dynamicsymbols("x q"), mechanics.dynamicsymbols("v u")
    x, angle = q
    frame, origin = mechanics.ReferenceFrame("N"), mechanics.Point("O")
    origin.set_vel(frame, 0)
    centre = origin.locatenew("centre", x * frame.x)
    centre.set_vel(frame, w[0] * frame.x)
    cart = mechanics.Particle("cart", centre, M)
    bob, body = rod("rod", angle, frame, centre, l1, m1, J1)
    kinematics = [speed - place.diff() for place, speed in zip(q, w, strict=True)]
    body.frame.set_ang_vel(frame, w[1] * frame.z)
    bob.set_vel(frame, centre.vel(frame) + (w[1] * frame.z).cross(bob.pos_from(centre)))
    loads = [(centre, (F - k * x) * frame.x), (bob, -m1 * g * frame.y)]
    method = mechanics.KanesMethod(frame, list(q), list(w), kd_eqs=kinematics)
    method.kanes_equations([cart, body], loads)
    height = bob.pos_from(origin).dot(frame.y)
    energy = (
        cart.kinetic_energy(frame) + body.kinetic_energy(frame) + k * x**2 / 2 + m1 * g * height
    )
    return Motion(*plain((method.mass_matrix, method.forcing, energy), q, w))
