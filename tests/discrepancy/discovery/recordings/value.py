"""What every machine of this folder says of itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Expected:
    """What is missing, and what an honest answer may say.

    Attributes
    ----------
    verdicts : tuple of str
        Those that are right.
    effects : tuple of frozenset of (effect, site)
        One set for each missing effect; any member of a set is right.
    parameters : mapping of str to float
        Truth by ``effect.coefficient``, SI, where the law is that of the table.
    truth : mapping of str to float
        The nominal model's own parameters in the simulator, SI.
    words : str
        What the recordings can tell and what they cannot.
    """

    verdicts: tuple[str, ...]
    effects: tuple[frozenset[tuple[str, str]], ...] = ()
    parameters: Mapping[str, float] = field(default_factory=dict)
    truth: Mapping[str, float] = field(default_factory=dict)
    words: str = ""


def one_of(*pairs: tuple[str, str]) -> frozenset[tuple[str, str]]:
    """Effects at sites of which any is a right name."""
    return frozenset(pairs)
