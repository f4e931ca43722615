"""What is sought: parameters and initial states, their scale, bounds and priors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy

from ...errors import ParameterError
from ...parameters import as_parameter, unknown_name
from ...simulation import CompiledModel
from ...units import to_si
from ...values import parameter_values

Array = numpy.ndarray


@dataclass(frozen=True)
class Unknown:
    """One unknown and its coordinate u: its logarithm where it is positive by assumption.

    Attributes
    ----------
    name : str
    recording : int or None
        Whose initial state it is; None for a parameter.
    log : bool
    lower, upper : float
        Bounds of u.
    prior : (float, float) or None
        Mean and standard deviation of u.
    """

    name: str
    recording: int | None
    log: bool
    lower: float = -math.inf
    upper: float = math.inf
    prior: tuple[float, float] | None = None

    def value(self, u: float) -> float:
        """Return the value, SI, at a coordinate."""
        return math.exp(min(u, 700.0)) if self.log else float(u)

    def slope(self, u: float) -> float:
        """Return d value/d u."""
        return self.value(u) if self.log else 1.0


def bounded(
    name: str, recording: int | None, log: bool, limits: Any = None, prior: Any = None
) -> Unknown:
    """Return an unknown with its bounds and prior brought to its coordinate.

    Parameters
    ----------
    name : str
    recording : int or None
    log : bool
    limits : (lower, upper), optional
        Numbers in SI, or ``(value, unit)``; None where there is none.
    prior : (value, std), optional

    Returns
    -------
    Unknown

    Raises
    ------
    ParameterError

    Examples
    --------
    >>> bounded("m", None, True, (1, None)).lower
    0.0
    """
    low, high = -math.inf, math.inf
    if limits is not None:
        low, high = _pair(name, "bounds", limits)
        low = -math.inf if low is None else _number(name, low)
        high = math.inf if high is None else _number(name, high)
        if not low < high:
            raise ParameterError(f"bounds of {name!r}: {low:g} is not below {high:g}")
        if log and high <= 0:
            raise ParameterError(f"bounds of {name!r}: it is positive, and {high:g} is not")
    mean = None
    if prior is not None:
        value, std = (_number(name, part) for part in _pair(name, "prior", prior))
        if not std > 0 or (log and value <= 0):
            raise ParameterError(f"prior of {name!r}: {value:g} +- {std:g} is not admissible")
        mean = (math.log(value), std / value) if log else (value, std)
    if log:
        low = math.log(low) if low > 0 else -math.inf
        high = math.log(high) if high < math.inf else math.inf
    return Unknown(name, recording, log, low, high, mean)


def _pair(name: str, what: str, given: Any) -> tuple[Any, Any]:
    try:
        first, second = given
    except (TypeError, ValueError):
        raise ParameterError(f"{what} of {name!r}: expected two numbers, got {given!r}") from None
    return first, second


def _number(name: str, given: Any) -> float:
    row = as_parameter(name, given)
    return to_si(float(row.value), row.unit)


@dataclass(frozen=True, eq=False)
class Unknowns:
    """All unknowns of a fit, parameters first, then initial states recording by recording.

    Attributes
    ----------
    items : tuple of Unknown
    fixed : mapping
        Parameters with a value of their own that are not sought.
    states : tuple of str
        Whose initial values are sought, in every recording.
    """

    items: tuple[Unknown, ...]
    fixed: Mapping[str, Any]
    states: tuple[str, ...]

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters sought."""
        return tuple(item.name for item in self.items if item.recording is None)

    @property
    def lower(self) -> Array:
        """Lower bounds of the coordinates."""
        return numpy.array([item.lower for item in self.items])

    @property
    def upper(self) -> Array:
        """Upper bounds of the coordinates."""
        return numpy.array([item.upper for item in self.items])

    def values(self, z: Array) -> Array:
        """Return all values, SI."""
        return numpy.array([item.value(u) for item, u in zip(self.items, z, strict=True)])

    def slopes(self, z: Array) -> Array:
        """Return d value/d u of all."""
        return numpy.array([item.slope(u) for item, u in zip(self.items, z, strict=True)])

    def own(self, recording: int) -> slice:
        """Return where the initial states of a recording stand."""
        first = len(self.parameters) + recording * len(self.states)
        return slice(first, first + len(self.states))


def sought(
    model: CompiledModel,
    free: Sequence[Any],
    recordings: int,
    parameters: Mapping[Any, Any] | None,
    bounds: Mapping[Any, Any] | None,
    priors: Mapping[Any, Any] | None,
) -> tuple[Unknowns, Array]:
    """Sort out what is sought, and where parameters start.

    Parameters
    ----------
    model : CompiledModel
    free : sequence of str or Symbol
        ``"states"`` means the initial values of all states.
    recordings : int
    parameters, bounds, priors : mapping, optional

    Returns
    -------
    Unknowns
    (q,) array
        Coordinates of the parameters at the start.

    Raises
    ------
    ParameterError

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> found, start = sought(CompiledModel(mass_on_belt.graph()), ["m", "mass.p"], 2, {}, {}, {})
    >>> [item.name for item in found.items], start.tolist()
    (['m', 'mass.p', 'mass.p'], [0.0])
    """
    equations = model.equations
    symbols = {symbol.name: symbol for symbol in equations.graph.parameters}
    states = [state.name for state in equations.states]
    names = list(_flat(free, states))
    for name in names:
        if name not in symbols and name not in states:
            raise unknown_name("parameter or state", name, [*symbols, *states])
    if not names or len(set(names)) < len(names):
        raise ParameterError("free must name each unknown once, such as free=['k', 'mass.p']")
    given = {_name(key): value for key, value in (parameters or {}).items()}
    limits = {_name(key): value for key, value in (bounds or {}).items()}
    known = {_name(key): value for key, value in (priors or {}).items()}
    for name in (*limits, *known):
        if name not in names:
            raise ParameterError(f"{name!r} has bounds or a prior but is not free; add it to free")
    values = parameter_values(equations, given, model.resolver)
    items, start = [], []
    for name in (name for name in names if name in symbols):
        if name not in values:
            raise ParameterError(f"{name!r} has no value to start from; give it in parameters={{}}")
        log = bool(symbols[name].is_positive) and values[name] > 0
        item = bounded(name, None, log, limits.get(name), known.get(name))
        if symbols[name].is_nonnegative and not log:
            item = replace(item, lower=max(item.lower, 0.0))
        if symbols[name].is_nonpositive:
            item = replace(item, upper=min(item.upper, 0.0))
        items.append(item)
        start.append(math.log(values[name]) if log else values[name])
    first = numpy.clip(start, [i.lower for i in items], [i.upper for i in items])
    wanted = tuple(name for name in names if name in states)
    for place in range(recordings):
        items += [bounded(name, place, False, limits.get(name), known.get(name)) for name in wanted]
    fixed = {name: value for name, value in given.items() if name not in names}
    return Unknowns(tuple(items), fixed, wanted), numpy.array(first)


def _flat(free: Sequence[Any], states: Iterable[str]) -> Iterable[str]:
    for item in [free] if isinstance(free, str) else free:
        if item == "states":
            yield from states
        else:
            yield _name(item)


def _name(key: Any) -> str:
    return key if isinstance(key, str) else str(getattr(key, "name", key))


def own_parameters(model: CompiledModel) -> tuple[str, ...]:
    """Return the parameters with a number of their own that the equations use, through others or not."""
    used = {symbol.name for symbol in model.equations.parameters}
    table = model.equations.graph.parameters
    derived = {
        symbol.name: {s.name for s in row.value.free_symbols}
        for symbol, row in table.items()
        if row.derived
    }
    while more := {s for name in used for s in derived.get(name, ())} - used:
        used |= more
    return tuple(symbol.name for symbol in table if symbol.name in used - derived.keys())
