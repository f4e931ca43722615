"""Sources of effort and of flow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import sympy

from .base import OnePort


@dataclass(frozen=True, eq=False, init=False, repr=False)
class EffortSource(OnePort):
    """What decides the effort of its bond.

    Attributes
    ----------
    effort : Expr
    """

    effort: sympy.Expr
    passive: ClassVar[bool] = False


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Se(EffortSource):
    """Source of effort.

    Parameters
    ----------
    name : str
    effort : number, Expr
        May use time, parameters, inputs and port variables (modulated: MSe).

    Examples
    --------
    >>> Se("battery", 12).effort
    12
    """

    kind: ClassVar[str] = "Se"

    def __init__(self, name: str, effort: Any) -> None:
        self._ports(name)
        self._set(effort=self._apply("effort", effort, self.f))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class FlowSource(OnePort):
    """What decides the flow of its bond.

    Attributes
    ----------
    flow : Expr
    """

    flow: sympy.Expr
    passive: ClassVar[bool] = False


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Sf(FlowSource):
    """Source of flow.

    Parameters
    ----------
    name : str
    flow : number, Expr
        May use time, parameters, inputs and port variables (modulated: MSf).

    Examples
    --------
    >>> Sf("road", 0.5).flow
    1/2
    """

    kind: ClassVar[str] = "Sf"

    def __init__(self, name: str, flow: Any) -> None:
        self._ports(name)
        self._set(flow=self._apply("flow", flow, self.e))
