"""Two-ports: the transformer and the gyrator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import sympy

from ..errors import LawError
from ..laws import exact
from .base import Element, check_name, variable


@dataclass(frozen=True, eq=False, init=False, repr=False)
class TwoPort(Element):
    """Power-conserving two-port with one ratio.

    ``a >> TF("gear", n) >> b`` makes a the in side and b the out side.

    Attributes
    ----------
    e_in, f_in, e_out, f_out : Symbol
        Port variables, power taken at in and given at out.
    """

    e_in: sympy.Dummy
    f_in: sympy.Dummy
    e_out: sympy.Dummy
    f_out: sympy.Dummy
    ratio: sympy.Expr

    def __init__(self, name: str, ratio: Any) -> None:
        check_name(self.kind, name)
        self._set(name=name)
        self._set(
            **{port: variable(f"{name}.{port}") for port in ("e_in", "f_in", "e_out", "f_out")}
        )
        try:
            self._set(ratio=exact(ratio))
        except LawError as error:
            raise LawError(f"{self.kind} {name!r}, ratio: {error}", elements=[name]) from None
        if self.ratio == 0:
            raise LawError(
                f"{self.kind} {name!r}: a ratio of zero joins nothing; remove the element",
                elements=[name],
            )


@dataclass(frozen=True, eq=False, init=False, repr=False)
class TF(TwoPort):
    """Transformer: ``e_in = n e_out`` and ``f_out = n f_in``.

    Parameters
    ----------
    name : str
    ratio : number, Expr
        n; may use port variables and states (modulated: MTF).

    Examples
    --------
    >>> TF("gear", 0.2).ratio
    1/5
    """

    kind: ClassVar[str] = "TF"


@dataclass(frozen=True, eq=False, init=False, repr=False)
class GY(TwoPort):
    """Gyrator: ``e_in = r f_out`` and ``e_out = r f_in``.

    Parameters
    ----------
    name : str
    ratio : number, Expr
        r; may use port variables and states (modulated: MGY).

    Examples
    --------
    >>> GY("motor", 0.05).ratio
    1/20
    """

    kind: ClassVar[str] = "GY"
