"""What symbols assume: the key ``assume``."""

from __future__ import annotations

import itertools
from typing import Any

import sympy

from ..errors import ParameterError
from .entries import shown

ASSUMPTIONS = (
    *("real", "positive", "nonnegative", "negative", "nonpositive", "nonzero", "zero"),
    *("integer", "even", "odd", "rational", "irrational", "finite", "complex", "commutative"),
)


def as_symbol(name: str, assume: Any, where: str) -> sympy.Symbol:
    """Return a symbol that assumes these words."""
    words = [assume] if isinstance(assume, str) else assume
    if not isinstance(words, list) or not all(word in ASSUMPTIONS for word in words):
        raise ParameterError(
            f"{where}: assume = {shown(assume)} is not known; there are {', '.join(ASSUMPTIONS)}"
        )
    try:
        return sympy.Symbol(name, **dict.fromkeys(words, True))
    except ValueError:
        raise ParameterError(
            f"{where}: assume = {shown(assume)} contradicts itself; keep one"
        ) from None


def assumptions_of(symbol: sympy.Symbol) -> dict[str, Any]:
    """Return the fewest words that give the symbol's assumptions; none for a real symbol."""
    true = [word for word in ASSUMPTIONS if symbol.assumptions0.get(word)]
    choices = (words for count in range(4) for words in itertools.combinations(true, count))
    for words in (("real",), *choices):
        if sympy.Symbol(symbol.name, **dict.fromkeys(words, True)) == symbol:
            if words == ("real",):
                return {}
            return {"assume": words[0] if len(words) == 1 else list(words)}
    raise ParameterError(
        f"{symbol.name!r} assumes what a file cannot say ({symbol.assumptions0}); "
        f"there are {', '.join(ASSUMPTIONS)}"
    )
