"""Sensors: ideal detectors of effort and of flow, which take no power."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import sympy

from .sources import EffortSource, FlowSource


@dataclass(frozen=True, eq=False, init=False, repr=False)
class De(FlowSource):
    """Effort detector: no flow; its effort is an output of the graph.

    Bonded to a 0-junction, whose effort it tells.

    Parameters
    ----------
    name : str
        Also the name of the output.

    Examples
    --------
    >>> De("gauge").flow
    0
    """

    kind: ClassVar[str] = "De"
    passive: ClassVar[bool] = True

    def __init__(self, name: str) -> None:
        self._ports(name)
        self._set(flow=sympy.S.Zero)


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Df(EffortSource):
    """Flow detector: no effort; its flow is an output of the graph.

    Bonded to a 1-junction, whose flow it tells.

    Parameters
    ----------
    name : str
        Also the name of the output.

    Examples
    --------
    >>> Df("tachometer").effort
    0
    """

    kind: ClassVar[str] = "Df"
    passive: ClassVar[bool] = True

    def __init__(self, name: str) -> None:
        self._ports(name)
        self._set(effort=sympy.S.Zero)
