"""Quantities as they are given: values, texts of the command line, functions of a trajectory."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..errors import SweepError, suggestion
from .quantities import Count, Energy, EventTime, Final, Mean, Minimum, Peak, Quantity, Rms, Share

_SIGNALS = {"final": Final, "peak": Peak, "min": Minimum, "mean": Mean, "rms": Rms}
_MODES = {"count": Count, "share": Share, "time": EventTime}
_KINDS = (*_SIGNALS, *_MODES, "energy")
_FORMS = (
    "final:SIGNAL, peak:SIGNAL[@AFTER], min:..., mean:..., rms:..., count:ELEMENT:MODE, "
    "share:ELEMENT:MODE[@AFTER], time:ELEMENT:MODE[:INDEX], energy[:TERM]"
)


@dataclass(frozen=True)
class Named:
    """A quantity, or a function of a trajectory, with its name in the result."""

    name: str
    what: Quantity | Callable[..., Any]


def as_quantities(given: Any) -> tuple[Named, ...]:
    """Return quantities from any of their accepted forms.

    Parameters
    ----------
    given : quantity, str, callable, sequence of these, or mapping of name to these

    Returns
    -------
    tuple of Named

    Raises
    ------
    SweepError
        For anything else, for none at all, and for two of one name.

    Examples
    --------
    >>> [one.name for one in as_quantities(["final:V_c", Count("friction", "stick")])]
    ['final:V_c', 'count:friction:stick']
    >>> as_quantities({"speed": "final:V_c"})[0].what
    Final(signal='V_c')
    """
    if isinstance(given, Mapping):
        named = tuple(Named(str(name), _one(item).what) for name, item in given.items())
    elif isinstance(given, Sequence) and not isinstance(given, str):
        named = tuple(_one(item) for item in given)
    else:
        named = (_one(given),)
    names = [item.name for item in named]
    if not names:
        raise SweepError(f"a sweep keeps at least one quantity: {_FORMS}")
    for name in names:
        if names.count(name) > 1:
            raise SweepError(
                f"quantity {name!r} is given twice; name them apart: {{'name': quantity}}"
            )
        if not name or "/" in name:
            raise SweepError(f"a quantity cannot be called {name!r}; give it a word without '/'")
    return named


def parse_quantity(text: str) -> Quantity:
    """Read a quantity as it is written on the command line.

    Parameters
    ----------
    text : str
        ``final:SIGNAL``, ``peak:SIGNAL@AFTER``, ``min:``, ``mean:``, ``rms:``,
        ``count:ELEMENT:MODE``, ``share:ELEMENT:MODE@AFTER``,
        ``time:ELEMENT:MODE:INDEX``, ``energy:TERM``.

    Returns
    -------
    Quantity

    Raises
    ------
    SweepError

    Examples
    --------
    >>> parse_quantity("peak:rear.bending.q@0.1")
    Peak(signal='rear.bending.q', after=0.1)
    >>> parse_quantity("time:friction:stick:2")
    EventTime(element='friction', mode='stick', index=2)
    """
    kind, _, rest = text.strip().partition(":")
    if kind not in _KINDS:
        hint = suggestion(kind, _KINDS) or f"write {_FORMS}"
        raise SweepError(f"quantity {text!r} cannot be read; {hint}")
    if kind == "energy":
        return Energy(rest or "residual")
    after = None
    if kind not in ("final", "count", "time"):
        rest, after = _after(text, rest)
    if kind in _SIGNALS and rest:
        return Final(rest) if kind == "final" else _SIGNALS[kind](rest, after)
    words = rest.split(":")
    if kind == "time" and len(words) == 3 and re.fullmatch(r"-?\d+", words[2]):
        return EventTime(words[0], words[1], int(words[2]))
    if kind in _MODES and len(words) == 2 and all(words):
        return Share(words[0], words[1], after) if kind == "share" else _MODES[kind](*words)
    raise SweepError(f"quantity {text!r} cannot be read; write {_FORMS}")


def _after(text: str, rest: str) -> tuple[str, float | None]:
    body, at, number = rest.rpartition("@")
    if not at:
        return rest, None
    try:
        return body, float(number)
    except ValueError:
        raise SweepError(f"quantity {text!r}: {number!r} is no time in seconds") from None


def _one(given: Any) -> Named:
    if isinstance(given, str):
        given = parse_quantity(given)
    if isinstance(given, Quantity):
        return Named(given.label, given)
    if callable(given):
        name = getattr(given, "__name__", type(given).__name__)
        return Named("quantity" if name == "<lambda>" else name, given)
    raise SweepError(
        f"quantity {given!r:.80} cannot be read; give one of bondgraph.sweeps, a function of a "
        f"trajectory, or a text: {_FORMS}"
    )
