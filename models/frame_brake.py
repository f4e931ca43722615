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
