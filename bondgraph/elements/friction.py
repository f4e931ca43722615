"""Dry friction with its modes, and the clutch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

import sympy

from ..errors import LawError
from ..laws import regularised
from .base import OnePort
from .dissipators import R
from .sources import Se, Sf
from .switched import Switched

STICK, SLIP_FORWARD, SLIP_BACKWARD = "stick", "slip+", "slip-"


@dataclass(frozen=True, eq=False, init=False, repr=False)
class DryFriction(Switched):
    """Dry friction: set-valued at zero slip, with modes stick, slip+ and slip-.

    Attributes
    ----------
    speed : Symbol
        Stands for the slip speed in `kinetic`.
    kinetic : Expr
        Magnitude of the effort while slipping.
    breakaway : Expr
        Largest effort while stuck.
    smoothing : Expr or None
        Slip width of the smooth form, which has no modes.
    """

    speed: sympy.Dummy
    kinetic: sympy.Expr
    breakaway: sympy.Expr
    smoothing: sympy.Expr | None
    modes: ClassVar[Mapping[str, int]] = MappingProxyType(
        {STICK: 0, SLIP_FORWARD: 1, SLIP_BACKWARD: -1}
    )
    # friction is bounded: it holds no impulse
    impulses: ClassVar[Mapping[int, int | None]] = MappingProxyType({0: None, 1: None, -1: None})

    def _friction(self, name: str, kinetic: Any, breakaway: Any, smoothing: Any) -> None:
        self._ports(name)
        self._set(speed=sympy.Dummy(f"{name}.speed", nonnegative=True))
        self._set(kinetic=self._apply("kinetic", kinetic, self.speed))
        highest = self.kinetic.xreplace({self.speed: sympy.S.Zero})
        self._set(
            breakaway=highest
            if breakaway is None
            else self._apply("breakaway", breakaway, self.speed)
        )
        self._set(
            smoothing=None if smoothing is None else self._apply("smoothing", smoothing, self.speed)
        )
        if self.smoothing is not None and self.smoothing.is_positive is False:
            raise LawError(
                f"{self.kind} {name!r}: smoothing is a slip width and must be positive",
                elements=[name],
            )
        if self.speed in self.breakaway.free_symbols:
            raise LawError(
                f"{self.kind} {name!r}: breakaway acts at zero slip and cannot depend on speed; give a force",
                elements=[name],
            )

    def slipping(self, direction: sympy.Expr) -> sympy.Expr:
        """Effort while slipping in ``direction`` (+1 or -1), as an expression in f."""
        return direction * self.kinetic.xreplace({self.speed: direction * self.f})

    def smoothed(self) -> sympy.Expr:
        """Effort of the smooth form, as an expression in f."""
        if self.smoothing is None:
            raise LawError(f"Friction {self.name!r} has no smoothing width", elements=[self.name])
        return regularised(self.kinetic, self.speed, self.f, self.smoothing)

    @property
    def switches(self) -> bool:
        """Whether the element has modes; the smooth form has none."""
        return self.smoothing is None

    def plain(self, code: Any, imposed: sympy.Expr = sympy.S.Zero) -> OnePort:
        """Return the element that this one is while it stays in a mode.

        Slipping, it is a source of effort where the effort does not depend on
        speed, which may bind a state: a spring in series yields.
        """
        if code == 0:
            return self._twin(Sf(self.name, imposed))
        law = self.slipping(sympy.sympify(code))
        if self.speed not in self.kinetic.free_symbols:
            return self._twin(Se(self.name, law + imposed))
        return self._twin(R(self.name, effort=lambda flow: law.xreplace({self.f: flow})))

    def next_code(self, code: int, effort: float, flow: float) -> int:
        """Return the mode that follows where a margin is used up: overloaded it slips, at rest it sticks."""
        if code:
            return 0
        return 1 if effort > 0 else -1

    def margin(self, code: int) -> sympy.Expr:
        """Return what stays positive while a mode lasts."""
        return code * self.f if code else self.breakaway - sympy.Abs(self.e)


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Friction(DryFriction):
    """Dry friction: set-valued at zero slip, with modes stick, slip+ and slip-.

    Slipping, the effort is ``kinetic(|f|)`` along f. Stuck, f is zero and the
    effort is whatever keeps it so, up to ``breakaway``.

    Parameters
    ----------
    name : str
    kinetic : callable
        ``kinetic=lambda speed: ...``: magnitude of the effort at a slip speed
        of at least zero. May use parameters and port variables, such as the
        pressure that presses the pads.
    breakaway : number, Expr, optional
        Largest effort while stuck; ``kinetic(0)`` unless given.
    smoothing : number, Expr, optional
        Only for comparison: a slip width over which ``tanh`` replaces the
        jump. The element then has no modes and no real stick.

    References
    ----------
    Karnopp, Computer simulation of stick-slip friction in mechanical dynamic
    systems, J. Dyn. Sys. Meas. Control 107 (1985) 100-103.

    Examples
    --------
    >>> belt = Friction("belt", kinetic=lambda speed: 8, breakaway=12)
    >>> belt.breakaway
    12
    """

    kind: ClassVar[str] = "Friction"

    def __init__(
        self, name: str, *, kinetic: Any, breakaway: Any = None, smoothing: Any = None
    ) -> None:
        self._friction(name, kinetic, breakaway, smoothing)


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Clutch(DryFriction):
    """Friction clutch or brake: locked up to a capacity, which may be varied to zero.

    Parameters
    ----------
    name : str
    capacity : number, Expr
        Largest effort that slipping gives, such as a torque in proportion to
        an input; not negative. Zero disengages.
    static : number, Expr, optional
        Largest effort while locked; ``capacity`` unless given.

    Examples
    --------
    >>> import sympy
    >>> pressure = sympy.Symbol("pressure")
    >>> Clutch("plates", 12 * pressure).breakaway
    12*pressure
    """

    kind: ClassVar[str] = "Clutch"

    def __init__(self, name: str, capacity: Any, *, static: Any = None) -> None:
        self._friction(name, lambda speed: capacity, static, None)
