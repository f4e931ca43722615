"""Single entries: what may stand there, and errors that say where."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import sympy

from ..errors import BondGraphError, LawError, ModelError, suggestion
from ..expressions import parse
from ..expressions.words import shortened
from ..laws import exact
from ..units import parse_unit


@contextmanager
def at(place: str) -> Iterator[None]:
    """Say where in the file an error arose, in one line."""
    try:
        yield
    except BondGraphError as error:
        message = shortened(" ".join(f"{place}: {error}".split()), 1000)
        raise type(error)(message, elements=error.elements, bonds=error.bonds) from None


def as_text(value: Any, where: str) -> str:
    """Return an entry that must be text."""
    if not isinstance(value, str):
        said = "is missing" if value is None else f"is {shown(value)}"
        raise ModelError(f"{where} {said}; give it as text in quotes")
    return value


def as_flag(value: Any, where: str) -> bool:
    """Return an entry that must be true or false."""
    if not isinstance(value, bool):
        raise ModelError(f"{where} is {shown(value)}; write true or false")
    return value


def check_table(value: Any, where: str) -> None:
    """Raise unless the entry is a table."""
    if not isinstance(value, dict):
        raise ModelError(f"{where}: expected a table, got {shown(value)}; write [{where}]")


def check_keys(row: Mapping[str, Any], known: Iterable[str], where: str, name: str = "") -> None:
    """Raise for a key that is not known; a ``name`` is what the user chose."""
    for key in row:
        if key not in known:
            hint = nearest(key, known)
            if name and not hint.startswith("did"):
                hint += f"; a name with a dot stands in quotes: '{name}.{key}'"
            raise ModelError(f"{where}{': ' * bool(where)}unknown key {shown(key)}; {hint}")


def check_unit(unit: str, where: str) -> None:
    """Raise for a unit that cannot be read."""
    if unit:
        with at(where):
            parse_unit(unit)


def as_expression(given: Any, meanings: Mapping[str, Any], where: str) -> sympy.Expr:
    """Return what a number or a formula says."""
    with at(where):
        if isinstance(given, str):
            return parse(given, meanings)
        if isinstance(given, bool) or not is_finite(given):
            raise LawError(f"expected a finite number or a formula in quotes, got {shown(given)}")
        return exact(given)


def is_finite(value: Any) -> bool:
    """Whether this is a number that a double can hold."""
    try:
        return isinstance(value, int | float) and math.isfinite(value)
    except OverflowError:
        return False


def shown(value: Any) -> str:
    """Return a value for an error message."""
    return shortened(repr(value))


def nearest(name: Any, known: Iterable[str]) -> str:
    """Return the known names that come near, or else all."""
    names = list(known)
    return suggestion(str(name), names) or f"there are {', '.join(names[:20])}"
