"""Words that error messages share."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def suggestion(name: str, known: Iterable[str]) -> str:
    """Return a question with the nearest known names; empty where none is near.

    Examples
    --------
    >>> suggestion("sinn", ["sin", "asin", "exp"])
    'did you mean sin or asin?'
    """
    near = difflib.get_close_matches(name, list(known), n=3)
    return f"did you mean {' or '.join(near)}?" if near else ""


def shortened(text: str, most: int = 60) -> str:
    """Return a text of at most so many characters."""
    return text if len(text) <= most else f"{text[: most - 3]}..."


def reason(error: BaseException) -> str:
    """Return what Python or sympy says, in one short line."""
    return " ".join(f"{type(error).__name__} {error}".split())[:80]
