"""Dimensions as products of powers, their names and the domains they belong to."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from types import MappingProxyType

from ..errors import ParameterError
from ..units import to_si

UNKNOWN = "unknown"

# Units of effort, flow, displacement (of a C) and momentum (of an I).
DISPLAY: Mapping[str, tuple[str, str, str, str]] = MappingProxyType(
    {
        "translation": ("N", "m/s", "m", "N*s"),
        "rotation": ("N*m", "rad/s", "rad", "N*m*s"),
        "hydraulic": ("Pa", "m^3/s", "m^3", "Pa*s"),
        "electrical": ("V", "A", "C", "Wb"),
        "thermal": ("K", "W/K", "J/K", "K*s"),
    }
)

# The same on pseudo-bonds, whose flow is heat.
PSEUDO = ("K", "W", "J", "K*s")

# Units of integrals over time, by the unit of what is integrated.
INTEGRALS: Mapping[str, str] = MappingProxyType(
    {
        unit: integral
        for effort, flow, displacement, momentum in (*DISPLAY.values(), PSEUDO)
        for unit, integral in ((effort, momentum), (flow, displacement))
    }
)

# Exponent by base unit, and by region for an effort that is not known yet.
Form = dict[str | int, Fraction]

BASE = MappingProxyType(
    {
        "[mass]": "kg",
        "[length]": "m",
        "[time]": "s",
        "[current]": "A",
        "[temperature]": "K",
        "[substance]": "mol",
        "[luminosity]": "cd",
    }
)
_ORDER = {base: place for place, base in enumerate(BASE.values())}


def form(**powers: int) -> Form:
    """Build a form of base units.

    Examples
    --------
    >>> unit_of(form(m=1, s=-1))
    'm/s'
    """
    return {base: Fraction(power) for base, power in powers.items()}


POWER = form(kg=1, m=2, s=-3)
SECOND = form(s=1)
TEMPERATURE = form(K=1)
EFFORTS: Mapping[str, Form] = MappingProxyType(
    {
        "translation": form(kg=1, m=1, s=-2),
        "rotation": form(kg=1, m=2, s=-2),
        "hydraulic": form(kg=1, m=-1, s=-2),
        "electrical": form(kg=1, m=2, s=-3, A=-1),
        "thermal": TEMPERATURE,
    }
)


def times(*forms: Mapping[str | int, Fraction]) -> Form:
    """Multiply dimensions."""
    product: Form = {}
    for factor in forms:
        for base, power in factor.items():
            product[base] = product.get(base, Fraction(0)) + power
    return {base: power for base, power in product.items() if power}


def raised(base: Mapping[str | int, Fraction], power: Fraction | int) -> Form:
    """Raise a dimension to a power."""
    return {key: value * power for key, value in base.items() if power}


def per(above: Mapping[str | int, Fraction], below: Mapping[str | int, Fraction]) -> Form:
    """Divide dimensions."""
    return times(above, raised(below, -1))


def unit_of(dimension: Mapping[str | int, Fraction]) -> str:
    """Write a dimension in base units.

    Examples
    --------
    >>> unit_of(form(kg=1, m=2, s=-2))
    'kg*m^2/s^2'
    """
    items = sorted(
        dimension.items(), key=lambda item: (_ORDER.get(str(item[0]), len(_ORDER)), str(item[0]))
    )
    above = [_factor(base, power) for base, power in items if power > 0]
    below = [_factor(base, -power) for base, power in items if power < 0]
    bottom = below[0] if len(below) == 1 else f"({'*'.join(below)})"
    return ("*".join(above) or "1") + (f"/{bottom}" if below else "")


def _factor(base: str | int, power: Fraction) -> str:
    if power == 1:
        return str(base)
    return f"{base}^{power}" if power.denominator == 1 else f"{base}^({power})"


def domain_of(effort: Form | None) -> str:
    """Name the domain that has a dimension of effort.

    Examples
    --------
    >>> domain_of(form(kg=1, m=-1, s=-2))
    'hydraulic'
    """
    return next((name for name, known in EFFORTS.items() if known == effort), UNKNOWN)


def dimension(unit: str) -> Form:
    """Return the dimension of a unit.

    Raises
    ------
    ParameterError
        For a unit that cannot be read.

    Examples
    --------
    >>> dimension("N/mm") == form(kg=1, s=-2)
    True
    """
    from ..units import parse_unit  # pint, only once a unit is looked at

    return {
        BASE.get(base, base): Fraction(power).limit_denominator(64)
        for base, power in parse_unit(unit).dimensionality.items()
    }


_WORD = re.compile(r"[^\W\d]+")
_ANGLES = {"deg": "rad", "degree": "rad", "degrees": "rad", "turn": "rad", "rpm": "rad/s"}
_PREFIXES = ("milli", "micro", "nano", "kilo", "mega", "giga", "centi", "deci", "hecto")


def si_unit(unit: str) -> str:
    """Return the SI unit that a value has once it is converted from ``unit``.

    Raises
    ------
    ParameterError
        For a unit that cannot be read.

    Examples
    --------
    >>> si_unit("N/mm"), si_unit("kN*ms"), si_unit("g"), si_unit("bar"), si_unit("rpm")
    ('N/m', 'N*s', 'kg', 'Pa', 'rad/s')
    """
    plain = _WORD.sub(lambda word: _coherent(word[0]), unit)
    if "" not in (unit, plain) and to_si(1.0, plain) == 1.0 and dimension(plain) == dimension(unit):
        return plain
    return named_unit(dimension(unit))


def _coherent(word: str) -> str:
    """Strip the prefix of one unit; the word itself where that does not help."""
    if word in _ANGLES or to_si(1.0, word) == 1.0:
        return _ANGLES.get(word, word)
    stems = ["kg", *(word.removeprefix(prefix) for prefix in _PREFIXES), word[1:], word[2:]]
    for stem in stems:
        try:
            if stem and to_si(1.0, stem, expected=word) == 1.0:
                return stem
        except ParameterError:
            continue
    return word


def _named() -> list[tuple[str, Form]]:
    """Units with a name of their own; angles, which have no dimension, are left out."""
    found = [("W", POWER)]
    for domain, effort in EFFORTS.items():
        flow = per(POWER, effort)
        forms = (effort, flow, times(flow, SECOND), times(effort, SECOND))
        found += [pair for pair in zip(DISPLAY[domain], forms, strict=True) if "rad" not in pair[0]]
    return found


_NAMED = _named()


def named_unit(dimension: Form) -> str:
    """Write a dimension by a unit's name where there is one.

    Examples
    --------
    >>> named_unit(form(kg=1, m=1, s=-2)), named_unit(form(s=-1)), named_unit({})
    ('N', '1/s', '')
    """
    if not dimension:
        return ""
    return next((name for name, known in _NAMED if known == dimension), unit_of(dimension))
