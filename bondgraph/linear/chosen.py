"""Other inputs and outputs than the declared ones: parameters, states and port variables."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy

from ..dimensions import infer, si_unit
from ..errors import ParameterError
from ..parameters import unknown_name
from .variations import slopes

if TYPE_CHECKING:
    from .system import LinearSystem


def with_outputs(system: LinearSystem, names: tuple[str, ...]) -> LinearSystem:
    """Return a system with port variables and states as outputs too.

    Parameters
    ----------
    system : LinearSystem
    names : tuple of str

    Returns
    -------
    LinearSystem

    Raises
    ------
    ParameterError
        For a name that is not known.
    """
    ports = system.at.equations.ports
    fresh = [name for name in dict.fromkeys(names) if name not in system.outputs]
    for name in fresh:
        if name not in ports:
            raise unknown_name("port variable or state", name, ports)
    if not fresh:
        return system
    extra = [name for name in system.inputs if name in _parameters(system)]
    symbols = [_parameters(system)[name] for name in extra]
    found = slopes(system.at, [ports[name] for name in fresh], symbols)
    return replace(
        system,
        C=numpy.vstack([system.C, found.states]),
        D=numpy.vstack([system.D, numpy.hstack([found.inputs, found.parameters])]),
        outputs=(*system.outputs, *fresh),
    )


def with_inputs(system: LinearSystem, names: tuple[Any, ...]) -> LinearSystem:
    """Return a system with parameters as inputs too.

    Parameters
    ----------
    system : LinearSystem
    names : tuple of str or Symbol

    Returns
    -------
    LinearSystem

    Raises
    ------
    ParameterError
        For a name that is not known.
    """
    known = _parameters(system)
    wanted = dict.fromkeys(str(getattr(name, "name", name)) for name in names)
    fresh = [name for name in wanted if name not in system.inputs]
    for name in fresh:
        if name not in known:
            raise unknown_name("parameter", name, known)
    equations = system.at.equations
    if equations.input_rates and fresh:
        raise ParameterError(
            f"model {equations.name!r} needs the rate of an input, and may need that of a parameter; "
            f"declare {fresh[0]!r} as an input when assembling",
            elements=fresh,
        )
    if not fresh:
        return system
    outputs = [equations.outputs.get(name, equations.ports.get(name)) for name in system.outputs]
    rows = [*equations.derivatives, *outputs]
    found = slopes(system.at, rows, [known[name] for name in fresh]).parameters
    n = len(system.states)
    return replace(
        system,
        B=numpy.hstack([system.B, found[:n]]),
        D=numpy.hstack([system.D, found[n:]]),
        inputs=(*system.inputs, *fresh),
    )


def state_units(system: LinearSystem) -> tuple[str, ...]:
    """Return the SI unit of each state, empty where it is not known."""
    known = infer(system.at.equations.graph).units
    return tuple(known.get(name) or "" for name in system.states)


def input_units(system: LinearSystem) -> tuple[str, ...]:
    """Return the SI unit of each input, empty where it is not known."""
    equations = system.at.equations
    units = {symbol.name: unit for symbol, unit in equations.graph.inputs.items()}
    for symbol, rate in equations.input_rates.items():
        units[rate.name] = f"{units[symbol.name]}/s" if units.get(symbol.name) else ""
    rows = {symbol.name: row.unit for symbol, row in equations.graph.parameters.items()}
    return tuple(
        units[name] if name in units else si_unit(rows.get(name, "")) for name in system.inputs
    )


def output_units(system: LinearSystem) -> tuple[str, ...]:
    """Return the SI unit of each output, empty where it is not known."""
    graph = system.at.equations.graph
    known = infer(graph).units
    return tuple(
        (graph.outputs[name].unit if name in graph.outputs else known.get(name)) or ""
        for name in system.outputs
    )


def _parameters(system: LinearSystem) -> dict[str, Any]:
    return {symbol.name: symbol for symbol in system.at.equations.graph.parameters}
