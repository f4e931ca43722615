"""The parameter sheet of the bicycle's brake, with units, meanings and sources.

All models of the brake share it, so that they run on the same settings; a
model without a flexible wheel does not look at the wheel's rows.
"""

from __future__ import annotations

from types import SimpleNamespace

import sympy

from bondgraph.parameters import Parameter

PAPER = "Procedia Engineering 72 (2014) 471-476"
READING = f"{PAPER}, as read in docs/brake.md"
DERIVED = "derived"
ASSUMED = "engineering estimate; does not enter the brake's motion"
FREE = "free: only R_h C_h = tau counts; small, so that the line's energy does not blur the brake's"


def _symbols() -> SimpleNamespace:
    positive = "k_f k_w f_f f_w r_r r_t mu_s mu_k v_s tau m_f m_w J_r J_t k_t A_p C_h R_h"
    nonnegative = "zeta_f zeta_w F_k b_f b_w b_t N0 p_l"
    table = {name: sympy.Symbol(name, positive=True) for name in positive.split()}
    table |= {name: sympy.Symbol(name, nonnegative=True) for name in nonnegative.split()}
    table |= {name: sympy.Symbol(name, real=True) for name in ("V0", "omega_t", "V_b")}
    return SimpleNamespace(**table)


SYMBOLS = _symbols()


def sheet() -> dict[sympy.Symbol, Parameter]:
    """Return the parameter table.

    Returns
    -------
    dict of Symbol to Parameter
        Measured and chosen values first, then what is derived from them.
    """
    s = SYMBOLS
    turn = 2 * sympy.pi
    return {
        s.k_f: Parameter(
            350.0, "N/mm", "bending stiffness of the rear frame at the caliper", PAPER
        ),
        s.k_w: Parameter(
            90.0, "N/mm", "torsional stiffness of the wheel, seen at the rotor's rim", PAPER
        ),
        s.f_f: Parameter(300.0, "Hz", "fundamental frequency of the frame", PAPER),
        s.f_w: Parameter(200.0, "Hz", "fundamental frequency of the wheel", PAPER),
        s.r_r: Parameter(0.08, "m", "rotor radius", PAPER),
        s.r_t: Parameter(0.33, "m", "tyre radius", PAPER),
        s.zeta_f: Parameter(0.05, "", "damping ratio of the frame", f"{PAPER}: 0.02 to 0.1"),
        s.zeta_w: Parameter(0.05, "", "damping ratio of the wheel", f"{PAPER}: 0.02 to 0.1"),
        s.V0: Parameter(0.9, "m/s", "slip speed of the pads before braking", PAPER),
        s.mu_s: Parameter(0.5, "", "static friction coefficient", READING),
        s.mu_k: Parameter(0.4, "", "kinetic friction coefficient", READING),
        s.v_s: Parameter(0.05, "m/s", "slip sensitivity of the friction", READING),
        s.F_k: Parameter(900.0, "N", "kinetic braking force at full lever", PAPER),
        s.tau: Parameter(0.03, "s", "time constant of pad application", READING),
        s.m_f: Parameter(s.k_f / (turn * s.f_f) ** 2, "kg", "effective mass of the frame", DERIVED),
        s.m_w: Parameter(
            s.k_w / (turn * s.f_w) ** 2,
            "kg",
            "effective mass of hub and rotor at the rotor's rim",
            DERIVED,
        ),
        s.J_r: Parameter(s.m_w * s.r_r**2, "kg*m^2", "inertia of hub and rotor", DERIVED),
        s.k_t: Parameter(
            s.k_w * s.r_r**2, "N*m/rad", "wind-up stiffness of tyre and spokes", DERIVED
        ),
        s.b_f: Parameter(
            2 * s.zeta_f * sympy.sqrt(s.k_f * s.m_f), "N*s/m", "damping of the frame", DERIVED
        ),
        s.b_w: Parameter(
            2 * s.zeta_w * sympy.sqrt(s.k_w * s.m_w),
            "N*s/m",
            "damping of the wheel at the rotor's rim",
            DERIVED,
        ),
        s.b_t: Parameter(
            s.b_w * s.r_r**2, "N*m*s/rad", "wind-up damping of tyre and spokes", DERIVED
        ),
        s.omega_t: Parameter(s.V0 / s.r_r, "rad/s", "wheel speed imposed by the road", DERIVED),
        s.V_b: Parameter(s.r_t * s.omega_t, "m/s", "speed of the bicycle, no tyre slip", DERIVED),
        s.N0: Parameter(s.F_k / s.mu_k, "N", "normal force of both pads at full lever", DERIVED),
        s.J_t: Parameter(
            0.11, "kg*m^2", "inertia of tyre and rim, behind the imposed speed", ASSUMED
        ),
        s.A_p: Parameter(7.6e-4, "m^2", "piston area of both pads (two pistons of 22 mm)", ASSUMED),
        s.C_h: Parameter(1e-18, "m^3/Pa", "compliance of the brake fluid", FREE),
        s.p_l: Parameter(s.N0 / s.A_p, "Pa", "lever pressure", DERIVED),
        s.R_h: Parameter(s.tau / s.C_h, "Pa*s/m^3", "flow resistance of the brake line", DERIVED),
    }
