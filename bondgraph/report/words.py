"""Numbers and names as the report writes them."""

from __future__ import annotations

import re

from ..dimensions import si_unit
from ..errors import ParameterError


def number(value: float, digits: int = 6) -> str:
    """Write a number with a few digits, as every table of the report does.

    Examples
    --------
    >>> number(1264.60010198), number(8.88178e-09), number(2250.0), number(-0.0)
    ('1264.6', '8.88178e-9', '2250', '0')
    """
    if value == 0:
        return "0"
    return re.sub(
        r"e([+-])0*(\d)", lambda found: f"e{found[1].strip('+')}{found[2]}", f"{value:.{digits}g}"
    )


def slug(text: str) -> str:
    """Return a text as part of a file's name.

    Examples
    --------
    >>> slug("rear mass/k_f")
    'rear-mass-k_f'
    """
    return re.sub(r"[^A-Za-z0-9_-]+", "-", text).strip("-") or "plot"


def coherent(unit: str) -> str:
    """Return the SI unit of a value given in ``unit``; 1 for a pure number.

    Examples
    --------
    >>> coherent("N/mm"), coherent("")
    ('N/m', '1')
    """
    try:
        return si_unit(unit) or "1"
    except ParameterError:
        return unit
