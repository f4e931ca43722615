"""What quantities ask of a model: whether it has a signal or a mode, and in which unit."""

from __future__ import annotations

from ..errors import SweepError, suggestion
from ..simulation import CompiledModel


def unit_of(model: CompiledModel, signal: str) -> str:
    """Return a signal's unit: as declared, else as inferred."""
    graph = model.equations.graph
    if signal in graph.outputs and graph.outputs[signal].unit:
        return graph.outputs[signal].unit
    for symbol, unit in graph.inputs.items():
        if symbol.name == signal:
            return unit
    return model.units.get(signal) or ""


def check_signal(model: CompiledModel, name: str) -> None:
    """Raise SweepError unless a model has a signal of this name."""
    try:
        model.expression(model.equations, name)
    except KeyError:
        hint = suggestion(name, model.names) or f"there is {', '.join(model.names[:12])} ..."
        raise SweepError(f"signal {name!r} is not known; {hint}") from None


def check_mode(model: CompiledModel, element: str, mode: str) -> None:
    """Raise SweepError unless a model has a switching element with this mode."""
    names = model.contact_names
    if element not in names:
        hint = suggestion(element, names) or f"it has {', '.join(names) or 'none'}"
        raise SweepError(
            f"model {model.equations.name!r} has no switching element {element!r}; {hint}"
        )
    modes = model.equations.graph[element].modes
    if mode not in modes:
        raise SweepError(
            f"{element!r} has no mode {mode!r}; it has {', '.join(modes)}", elements=[element]
        )


def check_after(label: str, after: float | None, span: tuple[float, float]) -> None:
    """Raise SweepError for a time outside the run."""
    if after is not None and not span[0] <= after < span[1]:
        raise SweepError(f"{label}: {after:g} s is outside the run, {span[0]:g} s to {span[1]:g} s")
