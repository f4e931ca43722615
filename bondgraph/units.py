"""Units at the border: any compatible unit comes in, SI floats stay inside.

pint is loaded when a unit is first looked at, never on import.
"""

from __future__ import annotations

import functools
import math
import re
from typing import TYPE_CHECKING, Any

from .errors import ParameterError

if TYPE_CHECKING:
    import pint

_POWER = r"(\*\*|\^)\s*\(?\s*[-+]?\d{1,2}(\.\d{1,3})?(/\d{1,2})?\s*\)?(?!\s*(\*\*|\^))"


@functools.cache
def _registry() -> pint.UnitRegistry:
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


@functools.lru_cache(maxsize=1024)
def parse_unit(unit: str) -> Any:
    """Return pint's unit for a text; raise ParameterError where it is none.

    Examples
    --------
    >>> str(parse_unit("N/mm"))
    'newton / millimeter'
    """
    _check_plain(unit)
    import pint

    try:
        return _registry().Unit(unit or "dimensionless")
    except (
        pint.UndefinedUnitError,
        pint.DefinitionSyntaxError,
        ValueError,
        TypeError,
        AttributeError,
    ):
        raise ParameterError(
            f"unit {unit!r} is not known; write it like 'N/mm', 'rad/s' or 'kg*m^2'"
        ) from None
    except Exception as error:  # tokenizer errors of pint have no common base
        raise ParameterError(
            f"unit {unit!r} cannot be read ({error}); write it like 'N/mm'"
        ) from None


def _check_plain(unit: str) -> None:
    """Refuse text that would make pint compute: numbers stand only in small exponents."""
    plain = re.sub(r"[^\W\d]\w*", "u", re.sub(_POWER, "", unit))
    if len(unit) > 100 or re.search(r"\d|\^|\*\*", re.sub(r"\b1\b", "", plain)):
        shown = unit if len(unit) <= 40 else f"{unit[:37]}..."
        raise ParameterError(f"unit {shown!r} cannot be read; write it like 'kg*m^2' or 'N/mm'")


def to_si(value: float, unit: str, expected: str | None = None) -> float:
    """Convert a value to coherent SI units.

    Parameters
    ----------
    value : float
        Value in ``unit``.
    unit : str
        Any unit pint knows; empty for a pure number.
    expected : str, optional
        A unit that must have the same dimension.

    Returns
    -------
    float
        Value in SI base units.

    Raises
    ------
    ParameterError
        For unknown or incompatible units.

    Examples
    --------
    >>> to_si(350, "N/mm", expected="N/m")
    350000.0
    """
    if expected is not None:
        check_compatible(unit, expected)
    if not unit:
        return float(value)
    return float(_registry().Quantity(float(value), parse_unit(unit)).to_base_units().magnitude)


def from_si(value: float, unit: str) -> float:
    """Convert an SI value to ``unit``.

    Examples
    --------
    >>> from_si(350e3, "N/mm")
    350.0
    """
    if not unit:
        return float(value)
    target = parse_unit(unit)
    converted = float(_registry().Quantity(float(value), _base(target)).to(target).magnitude)
    tidy = float(f"{converted:.15g}")
    return tidy if math.isclose(tidy, converted, rel_tol=1e-14) else converted


def check_compatible(unit: str, expected: str) -> None:
    """Raise unless two units measure the same dimension.

    Raises
    ------
    ParameterError
        For incompatible units, and for Hz where rad/s is meant (or the
        reverse), which differ by 2 pi.

    Examples
    --------
    >>> check_compatible("mm", "m")
    """
    given, wanted = parse_unit(unit), parse_unit(expected)
    if given.dimensionality != wanted.dimensionality:
        raise ParameterError(f"unit '{unit or '1'}' does not measure what '{expected or '1'}' does")
    units = (given, wanted)
    angular = ["radian" in str(_base(unit)) for unit in units]
    cyclic = ["hertz" in str(unit) for unit in units]
    if (angular[0] and cyclic[1]) or (angular[1] and cyclic[0]):
        raise ParameterError(
            f"'{unit}' and '{expected}' differ by 2 pi; convert by hand so that it is clear"
        )


def si_unit(unit: str) -> str:
    """Return the coherent SI unit that a value has inside; the unit itself where it is one.

    Examples
    --------
    >>> si_unit("N/mm"), si_unit("kg*m^2")
    ('kg/s^2', 'kg*m^2')
    """
    if not unit or to_si(1.0, unit) == 1.0:
        return unit
    plain = f"{_base(parse_unit(unit)):~}"
    return plain.replace(" ** ", "^").replace(" ", "")


def _base(unit: Any) -> Any:
    """Coherent SI units of a unit; a turn, a cycle and a degree come out in radian."""
    return _registry().Quantity(1.0, unit).to_base_units().units


def pretty(unit: str) -> str:
    """Return a unit as it is printed, with raised powers and centred dots.

    Examples
    --------
    >>> pretty("kg*m^2/s")
    'kg·m²/s'
    """
    return unit.replace("^2", "²").replace("^3", "³").replace("*", "·")


def quantity_parts(value: Any) -> tuple[float, str] | None:
    """Split a pint quantity into value and unit; None for anything else.

    Examples
    --------
    >>> quantity_parts(3.0) is None
    True
    """
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        try:
            return float(value.magnitude), str(value.units)
        except TypeError:
            raise ParameterError(f"{value!r} is not one number; give a scalar quantity") from None
    return None
