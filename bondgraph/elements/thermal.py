"""Heat from dissipation: RS, a dissipator whose loss flows on into the thermal domain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import sympy

from ..bonds import Joinable
from ..errors import GraphError
from .dissipators import R
from .friction import DryFriction
from .sources import FlowSource


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Heat(FlowSource):
    """Thermal port of an `RS`: the flow that a dissipator's loss becomes.

    Attributes
    ----------
    power : Expr
        The loss, W.
    pseudo : bool
        Whether the flow is heat (W) rather than entropy flow (W/K).
    """

    power: sympy.Expr
    pseudo: bool
    kind: ClassVar[str] = "Heat"

    def __init__(self, name: str, power: sympy.Expr, pseudo: bool) -> None:
        self._ports(name)
        self._set(power=power, pseudo=pseudo, flow=power if pseudo else power / self.e)


class RS(Joinable):
    """Dissipator that heats: ``junction >> RS(...) >> temperature``.

    What the dissipator takes, the thermal bond carries on: as entropy flow,
    with temperature as effort, or as heat in a pseudo-bond graph.

    Parameters
    ----------
    dissipator : R, Friction, Clutch or str
        The element that takes the power, or the name of an R.
    resistance, effort, flow : optional
        Law of the R, where only its name is given.
    pseudo : bool
        Whether the thermal bond is a pseudo-bond: effort is temperature and
        flow is heat in W, so that their product is no power. False: flow is
        entropy flow, a true bond.

    Attributes
    ----------
    dissipator : R, Friction or Clutch
    heat : Heat
        The thermal port, an element named ``<dissipator>_heat``.

    References
    ----------
    Thoma, Entropy and mass flow for energy conversion, J. Franklin Inst. 299
    (1975) 89-96; Karnopp, Margolis, Rosenberg, System Dynamics, ch. 12.

    Examples
    --------
    >>> from bondgraph import C, I, One, Zero, assemble
    >>> v, rotor = One("v"), Zero("rotor")
    >>> rub = RS("pad", 20, pseudo=True)
    >>> graph = assemble("warm", v >> I("m", 2), v >> rub >> rotor >> C("heat", 500))
    >>> sorted(graph.elements)
    ['heat', 'm', 'pad', 'pad_heat', 'rotor', 'v']
    """

    def __init__(
        self,
        dissipator: Any,
        resistance: Any = None,
        *,
        effort: Any = None,
        flow: Any = None,
        pseudo: bool = False,
    ) -> None:
        if isinstance(dissipator, str):
            dissipator = R(dissipator, resistance, effort=effort, flow=flow)
        elif not (resistance is None and effort is None and flow is None):
            raise GraphError(
                f"RS of {dissipator!r}: the element has its law already; give a law or an element, not both"
            )
        if not isinstance(dissipator, R | DryFriction):
            raise GraphError(f"RS takes a dissipator, R or Friction, or a name, not {dissipator!r}")
        self.dissipator = dissipator
        power = dissipator.e * dissipator.f
        self.heat = Heat(f"{dissipator.name}_heat", power, bool(pseudo))

    def __repr__(self) -> str:
        return f"RS({self.dissipator.name!r})"
