"""Dissipators: R."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import sympy

from ..laws import inverse
from ..terms import product
from .base import NO_PARTNERS, OnePort


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
    partners : Tuple of Symbol
        Variables of the other ports of the same field, which the law may use;
        empty for a one-port.

    Raises
    ------
    LawError
        Unless exactly one law is given.

    Examples
    --------
    >>> pad = R("pad", effort=lambda f: f + f**3)
    >>> pad.flow is None
    True
    >>> R("orifice", effort=lambda f: 4 * f * abs(f)).flow
    sqrt(Abs(_orifice.e))*sign(_orifice.e)/2
    """

    effort: sympy.Expr | None
    flow: sympy.Expr | None
    partners: sympy.Tuple
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
        self._set(partners=NO_PARTNERS)
        key, law = self._one_of(resistance=resistance, effort=effort, flow=flow)
        if key == "resistance":
            value = self._apply(key, law, self.f)
            self._set(
                effort=product(value, self.f),
                flow=None if value == 0 else product(1 / value, self.e),
            )
        elif key == "effort":
            self._set(effort=self._apply(key, law, self.f), flow=None)
            self._set(flow=inverse(self.effort, self.f, self.e))
        else:
            self._set(effort=None, flow=self._apply(key, law, self.e))
            self._set(effort=inverse(self.flow, self.e, self.f))
