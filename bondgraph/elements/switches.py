"""Ideal switching elements: diode, check valve, switch and end stop."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

import sympy

from ..errors import LawError
from .base import OnePort
from .dissipators import R
from .sources import Se, Sf
from .switched import Switched


@dataclass(frozen=True, eq=False, init=False, repr=False)
class OneWay(Switched):
    """What lets flow pass along its bond and blocks it the other way.

    Passing, the effort is ``drop + resistance f`` and the flow is positive;
    blocking, the flow is zero and the effort stays below ``drop``.

    Attributes
    ----------
    drop, resistance : Expr
    """

    drop: sympy.Expr
    resistance: sympy.Expr
    impulses: ClassVar[Mapping[int, int | None]] = MappingProxyType({0: -1, 1: 1})

    def __init__(self, name: str, *, drop: Any = 0, resistance: Any = 0) -> None:
        self._ports(name)
        self._set(drop=self._apply("drop", drop, self.f))
        self._set(resistance=self._apply("resistance", resistance, self.f))
        for key in ("drop", "resistance"):
            value = getattr(self, key)
            if value.is_negative:
                raise LawError(
                    f"{self.kind} {name!r}: {key} is {value}; it must not be negative",
                    elements=[name],
                )

    def plain(self, code: int, imposed: sympy.Expr = sympy.S.Zero) -> OnePort:
        """Return the element that this one is while it stays in a mode."""
        if code == 0:
            return self._twin(Sf(self.name, imposed))
        if self.resistance == 0:
            return self._twin(Se(self.name, self.drop + imposed))
        law = self.drop + self.resistance * self.f
        return self._twin(R(self.name, effort=lambda flow: law.xreplace({self.f: flow})))

    def margin(self, code: int) -> sympy.Expr:
        """Return what stays positive while a mode lasts."""
        return self.f if code else self.drop - self.e


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Diode(OneWay):
    """Ideal diode: conducts flow along its bond, blocks effort against it.

    Conducting, the effort is ``drop + resistance f`` and the flow is positive;
    blocking, the flow is zero and the effort stays below ``drop``.

    Parameters
    ----------
    name : str
    drop : number, Expr
        Forward effort, not negative; zero for the ideal diode.
    resistance : number, Expr
        Slope of the effort while conducting; zero for the ideal diode.

    References
    ----------
    Karnopp, Margolis, Rosenberg, System Dynamics; Mosterman, Biswas, A theory of
    discontinuities in physical system models, J. Franklin Inst. 335 (1998) 401-439.

    Examples
    --------
    >>> d = Diode("d", drop=0.6)
    >>> d.margin(d.code("blocking"))
    3/5 - _d.e
    """

    kind: ClassVar[str] = "Diode"
    modes: ClassVar[Mapping[str, int]] = MappingProxyType({"blocking": 0, "conducting": 1})


@dataclass(frozen=True, eq=False, init=False, repr=False)
class CheckValve(OneWay):
    """Check valve: the hydraulic diode, open to flow along its bond only.

    Parameters
    ----------
    name : str
    drop : number, Expr
        Cracking pressure, Pa; zero for the ideal valve.
    resistance : number, Expr
        Pressure over flow while open; zero for the ideal valve.

    Examples
    --------
    >>> list(CheckValve("inlet").modes)
    ['closed', 'open']
    """

    kind: ClassVar[str] = "CheckValve"
    modes: ClassVar[Mapping[str, int]] = MappingProxyType({"closed": 0, "open": 1})


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Switch(Switched):
    """Ideal switch or valve: no flow while open, no effort while closed.

    Parameters
    ----------
    name : str
    closed : Expr
        A signal in time, inputs, states or port variables: the switch is
        closed while it is positive.

    Examples
    --------
    >>> from bondgraph import TIME
    >>> Switch("relay", closed=TIME - 1).margin(0)
    1 - t
    """

    closed: sympy.Expr
    kind: ClassVar[str] = "Switch"
    modes: ClassVar[Mapping[str, int]] = MappingProxyType({"open": 0, "closed": 1})
    impulses: ClassVar[Mapping[int, int | None]] = MappingProxyType({0: 0, 1: 0})
    commanded: ClassVar[bool] = True

    def __init__(self, name: str, *, closed: Any) -> None:
        self._ports(name)
        self._set(closed=self._apply("closed", closed, self.f))

    def plain(self, code: int, imposed: sympy.Expr = sympy.S.Zero) -> OnePort:
        """Return the element that this one is while it stays in a mode."""
        return self._twin(Se(self.name, imposed) if code else Sf(self.name, imposed))

    def margin(self, code: int) -> sympy.Expr:
        """Return what stays positive while a mode lasts."""
        return self.closed if code else -self.closed


@dataclass(frozen=True, eq=False, init=False, repr=False)
class EndStop(Switched):
    """Rigid end stop, one-sided: it pushes and never pulls.

    Bonded to the 1-junction of the speed at which the gap closes. Where the gap
    is used up, the closing speed f turns to ``-restitution f``: momentum is
    conserved, the energy lost counts as dissipated.

    Parameters
    ----------
    name : str
    gap : Expr
        What is left of the way, a function of states; positive while free.
    restitution : number, Expr
        Speed after over speed before an impact, from 0 (plastic) to 1 (elastic).
    rest : number, Expr, optional
        Closing speed up to which an impact has no rebound. Zero unless given:
        then bounces that follow each other ever faster end in a named outcome.

    References
    ----------
    Brogliato, Nonsmooth mechanics, 3rd ed., Springer 2016: Newton's restitution.

    Examples
    --------
    >>> from bondgraph import C
    >>> height = C("height", stiffness=0, initial=1)
    >>> EndStop("floor", gap=height.q, restitution=0.8).margin(1)
    _height.q
    """

    gap: sympy.Expr
    restitution: sympy.Expr
    rest: sympy.Expr
    kind: ClassVar[str] = "EndStop"
    modes: ClassVar[Mapping[str, int]] = MappingProxyType({"contact": 0, "free": 1})
    impulses: ClassVar[Mapping[int, int | None]] = MappingProxyType({0: 1, 1: None})

    def __init__(self, name: str, *, gap: Any, restitution: Any, rest: Any = 0) -> None:
        self._ports(name)
        self._set(gap=self._apply("gap", gap, self.f))
        self._set(restitution=self._apply("restitution", restitution, self.f))
        self._set(rest=self._apply("rest", rest, self.f))
        value = self.restitution
        if value.is_number and not 0 <= value <= 1:
            raise LawError(
                f"EndStop {name!r}: restitution is {value}; it must lie between 0 and 1",
                elements=[name],
            )

    def plain(self, code: int, imposed: sympy.Expr = sympy.S.Zero) -> OnePort:
        """Return the element that this one is while it stays in a mode."""
        return self._twin(Se(self.name, 0) if code else Sf(self.name, imposed))

    def margin(self, code: int) -> sympy.Expr:
        """Return what stays positive while a mode lasts."""
        return self.gap if code else self.e
