"""Oscillators with known cycles."""

import math

import numpy
import sympy

from bondgraph import C, Friction, I, One, R, Se, Sf, Zero, assemble

# Period of van der Pol's oscillator at mu = 1, as in tables of it.
VAN_DER_POL_PERIOD = 6.6632868593231

# Mass on a belt, m = 1, k = 100, belt 0.5 m/s, 12 N to break away, 8 N while it slips.
SLIP, STICK = 0.493370342273, 0.16


def van_der_pol(sign=1):
    """Rayleigh's form of mu = 1; with sign -1 time runs backwards, and the cycle repels."""
    law = R("r", effort=lambda f: sign * (f**3 / 3 - f))
    return assemble("van_der_pol", One("loop") >> (I("L", 1), C("c", 1), law))


def belt(speed=0.5):
    """The textbook stick-slip oscillator, whose pieces are sines and straight lines."""
    drive, v = Zero("belt"), One("v")
    return assemble(
        "belt",
        Sf("drive", speed) >> drive >> v >> (I("m", 1), C("k", stiffness=100)),
        drive >> Friction("contact", kinetic=lambda slip: 8, breakaway=12),
    )


def belt_swing():
    """Least and most deflection of the belt's cycle, m: about F_k/k with the energy at let-go."""
    reach = math.hypot(0.12 - 0.08, 0.5 / 10)
    return 0.08 - reach, 0.08 + reach


def driven():
    """A mass on a spring and damper, pushed by an input; and its steady response at omega."""
    push = sympy.Symbol("push")
    parts = (I("m", 2), C("k", stiffness=8), R("b", 0.5))
    graph = assemble("driven", Se("F", push) >> One("v") >> parts, inputs={push: "N"})

    def response(omega):
        return 1 / (8 - 2 * omega**2 + 0.5j * omega)

    return graph, response


def van_der_pol_multiplier():
    """exp of the integral of the divergence once round, by scipy on the plain equations."""
    from scipy.integrate import solve_ivp

    def rates(t, y):
        del t
        q, p, _ = y
        return [p, -q - p**3 / 3 + p, 1 - p**2]

    def once(span, y):
        return solve_ivp(rates, span, y, method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]

    settled = once((0, 20 * VAN_DER_POL_PERIOD), [2.0, 0.0, 0.0])
    return float(numpy.exp(once((0, VAN_DER_POL_PERIOD), [*settled[:2], 0.0])[2]))
