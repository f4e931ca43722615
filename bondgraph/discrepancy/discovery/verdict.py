"""How a search for a missing effect ends."""

from __future__ import annotations

from enum import StrEnum


class Verdict(StrEnum):
    """How a search for a missing effect ends.

    Examples
    --------
    >>> Verdict.NONE == "none", str(Verdict.NAMED)
    (True, 'named')
    """

    NAMED = "named"
    AMBIGUOUS = "ambiguous"
    UNNAMED = "unnamed"
    NONE = "none"

    @property
    def meaning(self) -> str:
        """What it says, in a sentence."""
        return _MEANINGS[self]


_MEANINGS = {
    Verdict.NAMED: "an effect is missing, and the data tell which",
    Verdict.AMBIGUOUS: "an effect is missing; the data cannot tell which of several",
    Verdict.UNNAMED: "something is missing that none of the known effects explains",
    Verdict.NONE: "the data show nothing that the model lacks",
}
