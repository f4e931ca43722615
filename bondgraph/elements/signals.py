"""Signal blocks: dynamics outside the power graph, each with one state of its own.

A block has no bonds. It hears variables of the graph through its law, and other
laws hear its state ``y``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import sympy

from ..errors import LawError
from ..laws import exact
from .base import Element, check_name, variable


@dataclass(frozen=True, eq=False, init=False, repr=False)
class SignalBlock(Element):
    """What has a state and no bonds: ``dy/dt = rate``.

    Attributes
    ----------
    y : Symbol
        The state, which other laws may use.
    rate : Expr
    initial : Expr
    """

    y: sympy.Dummy
    rate: sympy.Expr
    initial: sympy.Expr

    def _block(self, name: str, initial: Any) -> None:
        check_name(self.kind, name)
        self._set(name=name, y=variable(f"{name}.y"))
        self._set(initial=self._law("initial", lambda: initial))

    def _law(self, what: str, law: Callable[[], Any]) -> sympy.Expr:
        try:
            return exact(law())
        except (LawError, TypeError) as error:
            raise LawError(
                f"{self.kind} {self.name!r}, {what}: {error}", elements=[self.name]
            ) from None


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Block(SignalBlock):
    """Signal block with one state: ``dy/dt = rate``.

    Parameters
    ----------
    name : str
    rate : callable
        ``rate=lambda y: ...``, in the state and any variables of the graph.
    initial : number, Expr
        Initial state, zero unless given.

    Attributes
    ----------
    y : Symbol
        The state, which other laws may use.

    Examples
    --------
    >>> controller = Block("valve", rate=lambda y: 3 - y)
    >>> controller.rate
    3 - _valve.y
    """

    kind: ClassVar[str] = "Block"

    def __init__(self, name: str, rate: Callable[[Any], Any], *, initial: Any = 0) -> None:
        self._block(name, initial)
        self._set(rate=self._law("rate", lambda: rate(self.y)))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Integrator(SignalBlock):
    """Integral of a signal over time, such as an angle from an angular velocity.

    Parameters
    ----------
    name : str
    signal : Expr
        What is integrated: port variables, inputs, time, parameters.
    initial : number, Expr
        Value at the start, zero unless given.

    Examples
    --------
    >>> from bondgraph import One
    >>> shaft = One("shaft")
    >>> Integrator("angle", shaft.f).rate
    _shaft.f
    """

    kind: ClassVar[str] = "Integrator"

    def __init__(self, name: str, signal: Any, *, initial: Any = 0) -> None:
        self._block(name, initial)
        self._set(rate=self._law("signal", lambda: signal))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Lag(SignalBlock):
    """First-order lag: ``time_constant dy/dt = signal - y``.

    Parameters
    ----------
    name : str
    signal : Expr
    time_constant : number, Expr
        s, positive.
    initial : number, Expr
        Value at the start, zero unless given.

    Raises
    ------
    LawError
        For a time constant that is not positive.

    Examples
    --------
    >>> from bondgraph import Zero
    >>> tank = Zero("tank")
    >>> Lag("gauge", tank.e, 0.5).rate
    -2*_gauge.y + 2*_tank.e
    """

    kind: ClassVar[str] = "Lag"

    def __init__(self, name: str, signal: Any, time_constant: Any, *, initial: Any = 0) -> None:
        self._block(name, initial)
        constant = self._law("time_constant", lambda: time_constant)
        if constant.is_positive is False:
            raise LawError(
                f"Lag {name!r}: the time constant is {constant}; it must be positive",
                elements=[name],
            )
        value = self._law("signal", lambda: signal)
        self._set(rate=sympy.expand((value - self.y) / constant, deep=False))
