"""What all switching elements share: modes, each of them an ordinary element."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import sympy

from ..errors import LawError
from .base import OnePort


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Switched(OnePort):
    """One-port with modes. In each mode it is an ordinary element.

    In the mode of code 0 the flow is held at zero; in the others the effort
    follows a law.

    Attributes
    ----------
    modes : mapping of str to int
        Labels and codes of the modes.
    impulses : mapping of int to int or None
        By code: the sign that an impulse of the variable answered (effort where
        the flow is held, else flow) must have for the mode to take it; 0 for
        any; None where the mode takes no impulse.
    commanded : bool
        Whether the margins alone tell the mode, whatever effort and flow are.
    """

    modes: ClassVar[Mapping[str, int]]
    impulses: ClassVar[Mapping[int, int | None]]
    commanded: ClassVar[bool] = False

    @property
    def switches(self) -> bool:
        """Whether the element has modes as it stands."""
        return True

    def plain(self, code: int, imposed: sympy.Expr = sympy.S.Zero) -> OnePort:
        """Return the element that this one is while it stays in a mode.

        Parameters
        ----------
        code : int
        imposed : Expr
            Added to the effort or flow that the mode holds: during an impact
            or a commutation it goes to zero in no time.
        """
        raise NotImplementedError

    def margin(self, code: int) -> sympy.Expr:
        """Return what stays positive while a mode lasts, in the element's own variables."""
        raise NotImplementedError

    def next_code(self, code: int, effort: float, flow: float) -> int:
        """Return the mode that follows where a margin is used up, at an effort and flow."""
        return 1 - code

    def code(self, mode: Any) -> int:
        """Return the code of a mode by its label.

        Raises
        ------
        LawError
            For a mode that does not exist.
        """
        if mode not in self.modes:
            raise LawError(
                f"{self.kind} {self.name!r} has no mode {mode!r}; use {', '.join(self.modes)}",
                elements=[self.name],
            )
        return self.modes[mode]

    def label(self, code: int) -> str:
        """Return the label of a mode by its code."""
        return next(label for label, value in self.modes.items() if value == code)

    def _twin(self, plain: OnePort) -> OnePort:
        """Give a plain element this one's port variables."""
        return plain.replaced({plain.e: self.e, plain.f: self.f})
