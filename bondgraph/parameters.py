"""Parameters with value, unit, meaning and source; `bondgraph.resolver` makes SI numbers of them.

A parameter is a sympy symbol. What the symbol assumes (``positive=True``,
``nonnegative=True``) is what its value must satisfy.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import sympy

from .errors import LawError, ParameterError, suggestion
from .laws import exact
from .units import check_compatible, quantity_parts


@dataclass(frozen=True)
class Parameter:
    """One row of a model's parameter table.

    Attributes
    ----------
    value : float, Expr or None
        Number in ``unit``; or an expression in other parameters, whose result
        is in SI; or None where the user must give it.
    unit : str
        Unit of the value, empty for a pure number.
    meaning : str
        What it is, in a few words.
    source : str
        Where the value comes from.

    Examples
    --------
    >>> Parameter(350, "N/mm", "frame stiffness at the caliper").unit
    'N/mm'
    """

    value: Any = None
    unit: str = ""
    meaning: str = ""
    source: str = ""

    @property
    def derived(self) -> bool:
        """Whether the value is an expression in other parameters."""
        return isinstance(self.value, sympy.Expr) and bool(self.value.free_symbols)


def as_parameter(name: str, given: Any) -> Parameter:
    """Read a parameter from any of its accepted forms.

    Parameters
    ----------
    name : str
        For error messages.
    given : Parameter, number, Expr, (value, unit) or pint quantity

    Returns
    -------
    Parameter

    Raises
    ------
    ParameterError

    Examples
    --------
    >>> as_parameter("k", (350, "N/mm")).value
    350
    """
    if isinstance(given, Parameter):
        parameter = given
    elif (parts := quantity_parts(given)) is not None:
        parameter = Parameter(*parts)
    elif isinstance(given, tuple):
        if len(given) < 2 or len(given) > 4 or not all(isinstance(word, str) for word in given[1:]):
            raise ParameterError(
                f"parameter {name!r}: expected (value, 'unit', 'meaning', 'source'), got {given!r}"
            )
        parameter = Parameter(*given)
    else:
        parameter = Parameter(given)
    if parameter.value is None:
        return parameter
    try:
        value = exact(parameter.value)
    except LawError as error:
        raise ParameterError(f"parameter {name!r}: {error}") from None
    if not value.free_symbols:
        number = parameter.value if isinstance(parameter.value, int | float) else float(value)
        return Parameter(number, parameter.unit, parameter.meaning, parameter.source)
    return Parameter(value, parameter.unit, parameter.meaning, parameter.source)


def unknown_name(kind: str, name: str, known: Iterable[str]) -> ParameterError:
    """Build the error for a name that is not known, with the nearest ones."""
    names = list(known)
    hint = suggestion(name, names) or f"known: {', '.join(names) or 'none'}"
    return ParameterError(f"{kind} {name!r} is not known; {hint}")


def check_unit(name: str, unit: str, expected: str) -> None:
    """Raise, naming the parameter, unless its unit fits.

    Examples
    --------
    >>> check_unit("k", "N/mm", "N/m")
    """
    try:
        check_compatible(unit, expected)
    except ParameterError as error:
        raise ParameterError(f"parameter {name!r}: {error}") from None
