"""Ranges: which parameter is varied, from where to where."""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any

from ..errors import ParameterError
from ..units import to_si

_VARY = re.compile(
    r"(?P<name>[^=\s]+)=(?P<lo>[^:\[\]]+):(?P<hi>[^:\[\]]+)(:(?P<n>\d+))?(\[(?P<unit>.*)\])?"
)


@dataclass(frozen=True)
class Vary:
    """A range to follow the eigenvalues over.

    Parameters
    ----------
    name : str
        A parameter or an input.
    lo, hi : float
    n : int
        Number of points.
    unit : str
        Unit of the bounds; SI where empty.

    Raises
    ------
    ParameterError
        For bounds that are not finite or equal, and fewer than two points.

    Examples
    --------
    >>> Vary.parse("k_f=200:400:50[N/mm]")
    Vary(name='k_f', lo=200.0, hi=400.0, n=50, unit='N/mm')
    """

    name: str
    lo: float
    hi: float
    n: int = 200
    unit: str = ""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.lo) and math.isfinite(self.hi)) or self.lo == self.hi:
            raise ParameterError(
                f"vary {self.name!r}: {self.lo:g} to {self.hi:g} is no range; give two finite ends"
            )
        if self.n < 2:
            raise ParameterError(f"vary {self.name!r}: {self.n} points; give at least two")

    @classmethod
    def parse(cls, text: str) -> Vary:
        """Read ``NAME=LO:HI``, ``NAME=LO:HI:N`` or either with ``[unit]`` behind.

        Raises
        ------
        ParameterError
        """
        found = _VARY.fullmatch(text.strip())
        try:
            assert found is not None
            low, high = float(found["lo"]), float(found["hi"])
        except (AssertionError, ValueError):
            raise ParameterError(
                f"vary {text!r} cannot be read; write NAME=LO:HI:N, such as V0=0.5:1.5:50"
            ) from None
        return cls(found["name"], low, high, int(found["n"] or 200), found["unit"] or "")

    def in_si(self, unit: str) -> Vary:
        """Return the same range with bounds in SI, checked against a parameter's unit."""
        if not self.unit:
            return self
        try:
            low, high = (to_si(value, self.unit, expected=unit) for value in (self.lo, self.hi))
        except ParameterError as error:
            raise ParameterError(f"vary {self.name!r}: {error}") from None
        return replace(self, lo=low, hi=high, unit="")


def as_vary(item: Any) -> Vary:
    """Read a range from a `Vary`, a text or ``(name, lo, hi[, n[, unit]])``.

    Examples
    --------
    >>> as_vary(("V0", 0.25, 1.5)).n
    200
    """
    if isinstance(item, Vary):
        return item
    if isinstance(item, str):
        return Vary.parse(item)
    if isinstance(item, Collection) and 3 <= len(item) <= 5:
        return Vary(*item)
    raise ParameterError(f"vary {item!r} cannot be read; give (name, lo, hi, n)")
