"""Dissipators: R, and dry friction with its modes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import sympy

from ..errors import LawError
from ..laws import affine_inverse, regularised
from ..terms import product
from .base import OnePort


@dataclass(frozen=True, eq=False, init=False, repr=False)
class R(OnePort):
    """Dissipator: effort and flow at the same instant.

    Parameters
    ----------
    name : str
    resistance : number, Expr, optional
        Linear: ``e = resistance f``.
    effort : callable, optional
        ``effort=lambda f: ...``, the effort as a function of the flow.
    flow : callable, optional
        ``flow=lambda e: ...``, the flow as a function of the effort.

    Attributes
    ----------
    effort, flow : Expr or None
        The law in each form, in the symbols ``f`` and ``e``; None where the
        law is not known in that form.

    Raises
    ------
    LawError
        Unless exactly one law is given.

    Examples
    --------
    >>> pad = R("pad", effort=lambda f: f**3)
    >>> pad.flow is None
    True
    """

    effort: sympy.Expr | None
    flow: sympy.Expr | None
    kind: ClassVar[str] = "R"

    def __init__(
        self,
        name: str,
        resistance: Any = None,
        *,
        effort: Callable[[Any], Any] | None = None,
        flow: Callable[[Any], Any] | None = None,
    ) -> None:
        self._ports(name)
        key, law = self._one_of(resistance=resistance, effort=effort, flow=flow)
        if key == "resistance":
            value = self._apply(key, law, self.f)
            self._set(
                effort=product(value, self.f),
                flow=None if value == 0 else product(1 / value, self.e),
            )
        elif key == "effort":
            self._set(effort=self._apply(key, law, self.f), flow=None)
            self._set(flow=affine_inverse(self.effort, self.f, self.e))
        else:
            self._set(effort=None, flow=self._apply(key, law, self.e))
            self._set(effort=affine_inverse(self.flow, self.e, self.f))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Friction(OnePort):
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

    speed: sympy.Dummy
    kinetic: sympy.Expr
    breakaway: sympy.Expr
    smoothing: sympy.Expr | None
    kind: ClassVar[str] = "Friction"

    def __init__(
        self, name: str, *, kinetic: Any, breakaway: Any = None, smoothing: Any = None
    ) -> None:
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
                f"Friction {name!r}: smoothing is a slip width and must be positive",
                elements=[name],
            )
        if self.speed in self.breakaway.free_symbols:
            raise LawError(
                f"Friction {name!r}: breakaway acts at zero slip and cannot depend on speed; give a force"
            )

    def slipping(self, direction: sympy.Expr) -> sympy.Expr:
        """Effort while slipping in ``direction`` (+1 or -1), as an expression in f."""
        return direction * self.kinetic.xreplace({self.speed: direction * self.f})

    def smoothed(self) -> sympy.Expr:
        """Effort of the smooth form, as an expression in f."""
        if self.smoothing is None:
            raise LawError(f"Friction {self.name!r} has no smoothing width", elements=[self.name])
        return regularised(self.kinetic, self.speed, self.f, self.smoothing)
