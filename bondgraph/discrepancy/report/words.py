"""Numbers, names and sentences as the report on a discovery writes them."""

from __future__ import annotations

import math
from collections.abc import Iterable

from ...plot import pretty
from ...report.words import number, slug
from ..discovery import Discovery, Estimate, Verdict

KINDS = {"train": "learned from", "validation": "held out"}


def rounded(value: float, std: float) -> str:
    """Write a value to the second digit of its standard deviation.

    Examples
    --------
    >>> rounded(5.0400594, 0.016), rounded(1234.5, 56.0), rounded(2.5, float("inf"))
    ('5.040', '1234', '2.5')
    """
    if not (math.isfinite(value) and math.isfinite(std)) or std <= 0 or value == 0:
        return figure(value)
    last = 1 - math.floor(math.log10(std))
    if 1e-3 <= abs(value) < 1e6 and last >= 0:
        return f"{value:.{min(last, 9)}f}"
    return number(value, min(max(math.floor(math.log10(abs(value))) + last + 1, 2), 9))


def figure(value: float, digits: int = 4) -> str:
    """Write a number; a dash where there is none.

    Examples
    --------
    >>> figure(0.123456), figure(float("nan")), figure(float("-inf"))
    ('0.1235', '–', '–')
    """
    return number(value, digits) if math.isfinite(value) else "–"


def spread(std: float) -> str:
    """Write a standard deviation, or that the data do not tell.

    Examples
    --------
    >>> spread(0.02314), spread(float("inf"))
    ('0.023', 'not told')
    """
    return number(std, 2) if math.isfinite(std) else "not told"


def estimated(estimate: Estimate) -> str:
    """Write value, standard deviation and unit.

    Examples
    --------
    >>> estimated(Estimate(2.503817, 0.0231, "N*s/m"))
    '2.504 ± 0.023 N·s/m'
    """
    value = rounded(estimate.value, estimate.std)
    std = f" ± {number(estimate.std, 2)}" if math.isfinite(estimate.std) else ""
    return f"{value}{std}{' ' * bool(estimate.unit)}{pretty(estimate.unit)}"


def share(value: float) -> str:
    """Write a share as percent; that nothing was there where it is no number.

    Examples
    --------
    >>> share(0.9341), share(-0.004), share(float("nan"))
    ('93 %', '0 %', '–')
    """
    return f"{100 * value:.0f} %".replace("-0 %", "0 %") if math.isfinite(value) else "–"


def headline(found: Discovery) -> str:
    """Return the verdict at a glance."""
    labels = [effect.label for effect in found.effects]
    if found.verdict == Verdict.NAMED:
        return f"Missing: {' and '.join(labels)}"
    if found.verdict == Verdict.AMBIGUOUS:
        return f"Missing: one of {len(labels)} that look alike"
    if found.verdict == Verdict.UNNAMED:
        return "Something is missing, and none of the known effects may be named"
    return "The data show nothing missing"


def changed(found: Discovery) -> bool:
    """Whether what the courses show as ``after`` has an effect in it."""
    return bool(found.chosen.effects)


def file_names(names: Iterable[str]) -> dict[str, str]:
    """Return a name for files by name; no two are the same, whatever letters they have.

    Examples
    --------
    >>> file_names(["v 1", "v/1", "x"])
    {'v 1': 'v-1', 'v/1': 'v-1-2', 'x': 'x'}
    """
    found: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        stem = plain = slug(name)
        count = 1
        while stem.lower() in taken:  # some file systems do not tell V from v
            count += 1
            stem = f"{plain}-{count}"
        taken.add(stem.lower())
        found[name] = stem
    return found
