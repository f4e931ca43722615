"""Submodels of a bicycle's rear end: frame, wheel, hydraulic line, pads."""

from __future__ import annotations

import sympy

from bondgraph.elements import C, Friction, I, One, R, Se, Sf, Zero
from bondgraph.graph import BondGraph, assemble
from bondgraph.laws import stribeck

from .sheet import SYMBOLS as s


def rear_frame(name: str = "rear") -> BondGraph:
    """Rear triangle bending at the caliper; port ``caliper``.

    Parameters
    ----------
    name : str

    Returns
    -------
    BondGraph
        States ``mass.p`` (N s) and ``bending.q`` (m).

    Examples
    --------
    >>> sorted(rear_frame().ports)
    ['caliper']
    """
    caliper = One("caliper")
    return assemble(
        name,
        caliper >> (I("mass", s.m_f), C("bending", stiffness=s.k_f), R("damping", s.b_f)),
        ports={"caliper": caliper},
    )


def rear_wheel(name: str = "wheel") -> BondGraph:
    """Tyre, rim and spokes winding up between road and hub; port ``hub``.

    The road imposes the speed of tyre and rim, whose inertia is therefore in
    derivative causality and adds no state.

    Parameters
    ----------
    name : str

    Returns
    -------
    BondGraph
        States ``spokes.q`` (rad) and ``rotor.p`` (N m s).

    Examples
    --------
    >>> sorted(rear_wheel().ports)
    ['hub']
    """
    rim, torque, windup, hub = One("rim"), Zero("torque"), One("windup"), One("hub")
    return assemble(
        name,
        hub >> I("rotor", s.J_r, initial=s.J_r * s.omega_t),
        windup >> (C("spokes", stiffness=s.k_t), R("spoke_damping", s.b_t)),
        Sf("road", s.omega_t) >> rim >> torque >> (windup, hub),
        rim >> I("tyre", s.J_t),
        ports={"hub": hub},
    )


def hydraulic_line(name: str = "line") -> BondGraph:
    """Brake line: lever pressure through a resistance into the caliper's fluid.

    Its time constant is the paper's first-order application of the pads. The
    pressure ``line['fluid'].e`` modulates the friction.

    Parameters
    ----------
    name : str

    Returns
    -------
    BondGraph
        State ``fluid.q`` (m^3).

    Examples
    --------
    >>> sorted(hydraulic_line().elements)
    ['flow', 'fluid', 'hose', 'lever']
    """
    flow = One("flow")
    return assemble(name, Se("lever", s.p_l) >> flow >> (R("hose", s.R_h), C("fluid", s.C_h)))


def pad_friction(pressure: sympy.Symbol) -> Friction:
    """Pads on the rotor, pressed by the fluid.

    Parameters
    ----------
    pressure : Symbol
        Port variable of the fluid, Pa.

    Returns
    -------
    Friction

    Examples
    --------
    >>> pad_friction(hydraulic_line()["fluid"].e).name
    'friction'
    """
    normal = s.A_p * pressure

    def kinetic(speed: sympy.Expr) -> sympy.Expr:
        return stribeck(speed, normal=normal, mu_s=s.mu_s, mu_k=s.mu_k, v_s=s.v_s)

    return Friction("friction", kinetic=kinetic)


def brake_outputs(
    rear: BondGraph, line: BondGraph, friction: Friction
) -> dict[str, tuple[sympy.Expr, str, str]]:
    """Signals that every brake has: the frame's motion, and the pads'.

    Parameters
    ----------
    rear, line : BondGraph
        From `rear_frame` and `hydraulic_line`.
    friction : Friction
        From `pad_friction`.

    Returns
    -------
    dict of str to (Expr, unit, meaning)

    Examples
    --------
    >>> line = hydraulic_line()
    >>> sorted(brake_outputs(rear_frame(), line, pad_friction(line["fluid"].e)))
    ['F_f', 'N', 'V_c', 'slip', 'x_c']
    """
    return {
        "V_c": (rear["mass"].f, "m/s", "caliper speed relative to the bicycle"),
        "x_c": (rear["bending"].q, "m", "deflection of the frame at the caliper"),
        "slip": (friction.f, "m/s", "slip of the pads"),
        "F_f": (friction.e, "N", "friction force"),
        "N": (s.A_p * line["fluid"].e, "N", "normal force of both pads"),
    }
