"""The older, frame-only brake: a rigid wheel, the same frame, pads and line.

It lacks the wind-up of the wheel, and with it the squeal at high slip
sensitivity that `bicycle_brake` shows.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from bondgraph.elements import TF, One, Sf, Zero
from bondgraph.graph import BondGraph, assemble

from .bicycle import SYMBOLS as s
from .bicycle import brake_outputs, hydraulic_line, pad_friction, rear_frame, sheet

if TYPE_CHECKING:
    from bondgraph.report import Section

# What a report follows the eigenvalues over unless it is told otherwise: NAME, LO, HI, N in SI.
VARY = (("V0", 0.25, 1.5, 200),)
# And the pairs that it maps, with a unit where the ends are not in SI.
MAPS = (
    (("V0", 0.25, 1.5, 60), ("v_s", 0.02, 0.4, 60)),
    (("mu_s", 0.3, 0.8, 60), ("mu_k", 0.2, 0.7, 60)),
    (("k_f", 100.0, 800.0, 60, "N/mm"), ("zeta_f", 0.005, 0.15, 60)),
)


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
        Sf("road", s.omega_t)
        >> One("hub")
        >> TF("rotor_radius", s.r_r)
        >> pads
        >> rear.port("caliper"),
        pads >> friction,
        parameters=sheet(),
        outputs=brake_outputs(rear, line, friction),
    )


def figures(parameters: Mapping[Any, Any] | None = None) -> list[Section]:
    """Build this model's own sections of a report: the paper's sets without the wheel.

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
