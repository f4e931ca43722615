"""Words that error messages share."""

from __future__ import annotations


def shortened(text: str, most: int = 60) -> str:
    """Return a text of at most so many characters."""
    return text if len(text) <= most else f"{text[: most - 3]}..."


def reason(error: BaseException) -> str:
    """Return what Python or sympy says, in one short line."""
    return " ".join(f"{type(error).__name__} {error}".split())[:80]
