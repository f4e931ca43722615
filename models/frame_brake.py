"""The older, frame-only brake: a rigid wheel, the same frame, pads and line.

It lacks the wind-up of the wheel, and with it the squeal at high slip
sensitivity that `bicycle_brake` shows.
"""

from __future__ import annotations

from bondgraph.elements import TF, One, Sf, Zero
from bondgraph.graph import BondGraph, assemble

from .bicycle import SYMBOLS as s
from .bicycle import hydraulic_line, pad_friction, rear_frame, sheet


def graph() -> BondGraph:
    """Build the frame-only brake's bond graph.

    Returns
    -------
    BondGraph
        Outputs V_c (m/s), x_c (m), and slip, F_f, N.

    Examples
    --------
    >>> sorted(graph().outputs)
    ['F_f', 'N', 'V_c', 'slip', 'x_c']
    """
    rear, line = rear_frame(), hydraulic_line()
    friction = pad_friction(line["fluid"].e)
    pads = Zero("pads")
    return assemble(
        "frame_brake",
        rear,
        line,
        Sf("road", s.omega_t) >> One("hub") >> TF("rotor_radius", s.r_r) >> pads >> rear.port("caliper"),
        pads >> friction,
        parameters=sheet(),
        outputs={
            "V_c": (rear["mass"].f, "m/s", "caliper speed relative to the bicycle"),
            "x_c": (rear["bending"].q, "m", "deflection of the frame at the caliper"),
            "slip": (friction.f, "m/s", "slip of the pads"),
            "F_f": (friction.e, "N", "friction force"),
            "N": (s.A_p * line["fluid"].e, "N", "normal force of both pads"),
        },
    )
