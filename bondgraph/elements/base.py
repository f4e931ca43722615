"""What all elements share: names, symbols, laws, and the one-port."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self

import sympy

from ..bonds import Joinable
from ..errors import GraphError, LawError
from ..laws import exact

NO_PARTNERS = sympy.Tuple()  # of a one-port: it is no port of a field
EFFORT = "effort"
FLOW = "flow"


def check_name(kind: str, name: Any) -> None:
    """Refuse names that could not be addressed."""
    if not isinstance(name, str) or not name.strip():
        raise GraphError(
            f"{kind} needs a name, got {name!r}; give it a short word such as {kind}('damper', ...)"
        )
    if "." in name or ">" in name:
        raise GraphError(
            f"{kind} {name!r}: '.' and '>' are kept for qualified names; use '_' instead"
        )


def variable(name: str) -> sympy.Dummy:
    """Return a fresh real symbol: two elements of one name share none."""
    return sympy.Dummy(name, real=True)


@functools.cache
def _fields(kind: type[Any]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the fields that hold the element's own variables, and the others.

    They are told by type: a law may be another element's bare symbol.
    """
    own = tuple(field.name for field in fields(kind) if field.type == "sympy.Dummy")
    return own, tuple(field.name for field in fields(kind) if field.name not in own)


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Element(Joinable):
    """Base of all elements: a name, symbols and law expressions.

    Attributes
    ----------
    name : str
        Unique within the graph that holds the element.
    """

    name: str
    kind: ClassVar[str] = "element"

    def _set(self, **values: Any) -> None:
        for key, value in values.items():
            object.__setattr__(self, key, value)

    def _fields(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        kind: Any = type(self)
        return _fields(kind)

    def __repr__(self) -> str:
        return f"{self.kind}({self.name!r})"

    @property
    def symbols(self) -> dict[str, sympy.Dummy]:
        """Port variables and states by attribute name, as other laws use them."""
        return {name: getattr(self, name) for name in self._fields()[0]}

    @property
    def laws(self) -> dict[str, sympy.Expr]:
        """Law expressions by attribute name."""
        values = {name: getattr(self, name) for name in self._fields()[1]}
        return {key: value for key, value in values.items() if isinstance(value, sympy.Expr)}

    def replaced(
        self, replacements: Mapping[sympy.Basic, sympy.Basic], name: str | None = None
    ) -> Self:
        """Return a new element of the same kind with symbols exchanged throughout.

        Parameters
        ----------
        replacements : mapping of Symbol to Expr
            Applied to the element's own symbols and to its laws.
        name : str, optional
            The copy's name.
        """
        twin = object.__new__(type(self))
        for field in fields(self):
            value = getattr(self, field.name)
            object.__setattr__(
                twin,
                field.name,
                value.xreplace(replacements) if isinstance(value, sympy.Basic) else value,
            )
        if name is not None:
            object.__setattr__(twin, "name", name)
        return twin


@dataclass(frozen=True, eq=False, init=False, repr=False)
class OnePort(Element):
    """An element with one power port.

    Attributes
    ----------
    e, f : Symbol
        Effort and flow at the port; a passive element takes the power ``e f``.
    """

    e: sympy.Dummy
    f: sympy.Dummy
    passive: ClassVar[bool] = True

    def _ports(self, name: str) -> None:
        check_name(self.kind, name)
        self._set(name=name, e=variable(f"{name}.e"), f=variable(f"{name}.f"))

    def _apply(self, what: str, law: Any, argument: sympy.Symbol) -> sympy.Expr:
        """Evaluate a law given as a function, or take it as an expression."""
        try:
            return exact(law(argument) if callable(law) else law)
        except LawError as error:
            raise LawError(
                f"{self.kind} {self.name!r}, {what}: {error}", elements=[self.name]
            ) from None

    def _one_of(self, **given: Any) -> tuple[str, Any]:
        """Return the one law that was given, by keyword."""
        chosen = [(key, value) for key, value in given.items() if value is not None]
        if len(chosen) != 1:
            options = ", ".join(given)
            said = "none was" if not chosen else f"{' and '.join(key for key, _ in chosen)} were"
            raise LawError(
                f"{self.kind} {self.name!r} takes exactly one of {options}; {said} given",
                elements=[self.name],
            )
        return chosen[0]
