"""What names mean in the formulas of a file."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

import sympy

from ..expressions import as_double, to_text
from ..graph import TIME
from ..laws import exact


class Names:
    """What names mean in a file: parameters, inputs, time and the elements' variables.

    ``parameters.x`` and ``inputs.x`` are the long forms, for when a short one
    may mean two things.
    """

    def __init__(
        self,
        variables: Mapping[str, sympy.Symbol],
        parameters: Mapping[str, sympy.Symbol],
        inputs: Mapping[str, sympy.Symbol] | None = None,
    ) -> None:
        self.meanings: dict[str, Any] = {}
        tables = {"parameters": parameters, "inputs": inputs or {}}
        for table in tables.values():
            self._add(table.items())
        if "t" not in self.meanings:
            self.meanings["t"] = TIME
        self._add(variables.items())
        if "pi" in self.meanings:  # the constant goes by the same name
            self.meanings["pi"] = _two_meanings("pi")
        for name, table in tables.items():
            self._add((f"{name}.{key}", symbol) for key, symbol in table.items())
        self._spellings: dict[Any, list[str]] = {}
        for name, meaning in self.meanings.items():
            if not isinstance(meaning, str):
                self._spellings.setdefault(meaning, []).append(name)

    def _add(self, items: Iterable[tuple[str, Any]]) -> None:
        for name, symbol in items:
            if self.meanings.setdefault(name, symbol) != symbol:
                self.meanings[name] = _two_meanings(name)

    def within(self, bare: Mapping[str, Any]) -> Mapping[str, Any]:
        """Add the bare names of a law's own arguments."""
        own = {
            name: _two_meanings(name) if name in self.meanings or name == "pi" else symbol
            for name, symbol in bare.items()
        }
        return ChainMap(own, self.meanings)

    def write(self, value: Any, bare: Mapping[str, Any] = MappingProxyType({})) -> Any:
        """Return a law as it stands in the file: a number, or text."""
        expression = exact(value)
        if (number := _number(expression)) is not None:
            return number
        meanings, free = self.within(bare), expression.free_symbols
        used = {
            name: symbol
            for name, symbol in bare.items()
            if symbol in free and meanings[name] == symbol
        }
        for wanted in expression.free_symbols:
            for name in self._spellings.get(wanted, ()):
                if meanings[name] == wanted:
                    used.setdefault(name, wanted)
                    break
        if "pi" in meanings:
            used.setdefault("pi", meanings["pi"])
        return to_text(expression, used)


def _two_meanings(name: str) -> str:
    return (
        f"{name!r} may mean two things here; write 'parameters.{name}', 'inputs.{name}' "
        f"or the element's variable in full, such as 'spring.{name}'"
    )


def _number(expression: sympy.Expr) -> int | float | None:
    """Return a number as TOML holds it exactly; None where it cannot."""
    if not isinstance(expression, sympy.Rational):
        return None
    if expression.q == 1 and abs(expression.p) < 2**53:
        return int(expression.p)
    return as_double(expression)
