"""A bicycle's rear brake with frame and wheel: stick-slip makes it squeal.

Road speed winds up tyre and spokes, the hub carries the rotor, the pads grip
it, and the frame bends at the caliper. Its equations are Eq. 1 of the paper,
with the pad force built up by a hydraulic line.

References
----------
Bike braking vibration modelling and measurement, Procedia Engineering 72
(2014) 471-476.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from bondgraph.elements import TF, Zero
from bondgraph.graph import BondGraph, assemble

from .bicycle import SYMBOLS as s
from .bicycle import brake_outputs, hydraulic_line, pad_friction, rear_frame, rear_wheel, sheet

if TYPE_CHECKING:
    from bondgraph.report import Section

# What a report follows the eigenvalues over unless it is told otherwise: NAME, LO, HI, N in SI.
VARY = (("V0", 0.25, 1.5, 200),)
# And the pairs that it maps, with a unit where the ends are not in SI.
MAPS = (
    (("V0", 0.25, 1.5, 60), ("v_s", 0.02, 0.4, 60)),
    (("mu_s", 0.3, 0.8, 60), ("mu_k", 0.2, 0.7, 60)),
    (("zeta_f", 0.005, 0.15, 60), ("zeta_w", 0.005, 0.15, 60)),
    (("k_f", 100.0, 800.0, 60, "N/mm"), ("k_w", 30.0, 300.0, 60, "N/mm")),
)


def graph() -> BondGraph:
    """Build the brake's bond graph.

    Returns
    -------
    BondGraph
        Outputs omega_r (rad/s), V_c (m/s), theta_w (rad), x_c (m), and slip,
        F_f, N. Start: free rolling, nothing deflected, pads off.

    Examples
    --------
    >>> graph().parameters[s.k_f].value
    350.0
    """
    wheel, rear, line = rear_wheel(), rear_frame(), hydraulic_line()
    friction = pad_friction(line["fluid"].e)
    pads = Zero("pads")
    return assemble(
        "bicycle_brake",
        wheel,
        rear,
        line,
        wheel.port("hub") >> TF("rotor_radius", s.r_r) >> pads >> rear.port("caliper"),
        pads >> friction,
        parameters=sheet(),
        outputs={
            "omega_r": (wheel["rotor"].f, "rad/s", "rotor speed"),
            "theta_w": (wheel["spokes"].q, "rad", "wind-up of the wheel"),
            **brake_outputs(rear, line, friction),
        },
    )


def figures(parameters: Mapping[Any, Any] | None = None) -> list[Section]:
    """Build this model's own sections of a report: the paper's Figs 4 to 9.

    Parameters
    ----------
    parameters : mapping, optional
        Those of the report.

    Returns
    -------
    list of bondgraph.report.Section
    """
    from .bicycle.story import figures as of

    return of(graph(), parameters)
