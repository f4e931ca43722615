"""What decides the results of a sweep, as text and hashes that another process finds again."""

from __future__ import annotations

import hashlib
import pickle
import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy
import sympy

from ..errors import SweepError
from ..graph import BondGraph
from ..simulation import CompiledModel
from .job import Job
from .points import Points
from .quantities import RUN, Quantity


def fingerprint(model: CompiledModel, job: Job, points: Points) -> dict[str, Any]:
    """Return everything that decides the results, by name, as JSON can hold it.

    Parameters
    ----------
    model : CompiledModel
    job : Job
    points : Points

    Returns
    -------
    dict
        Two sweeps with equal ones give the same results to the last bit, on
        one machine. What is long stands as a hash.
    """
    import casadi

    from .. import __version__

    compiled = job.options.get("backend") != "vm" and model.modes.compiled()
    return {
        "model": digest(graph_text(job.graph)),
        "points": _points(points),
        "quantities": {item.name: _quantity(item.what) for item in job.quantities},
        "t_span": list(job.t_span),
        "parameters": digest(text_of(job.shared[0])),
        "initial": digest(text_of(job.shared[1])),
        "inputs": digest(text_of(job.shared[2])),
        "t_eval": digest(text_of(job.t_eval)) if job.needs == RUN else None,
        "options": {name: text_of(value) for name, value in sorted(job.options.items())},
        "compiled": bool(compiled),
        "versions": {
            "halfarrow": __version__,
            "casadi": str(casadi.__version__),
            "numpy": str(numpy.__version__),
        },
    }


def digest(text: str | bytes) -> str:
    """Return a short hash of a text.

    Examples
    --------
    >>> len(digest("bond graph"))
    32
    """
    data = text.encode() if isinstance(text, str) else text
    return hashlib.blake2b(data, digest_size=16).hexdigest()


def graph_text(graph: BondGraph) -> str:
    """Return a text that tells all of a graph that has to do with its equations.

    Elements' own symbols are told by qualified names, so that the same model made twice has one
    text.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> graph_text(mass_on_belt.graph()) == graph_text(mass_on_belt.graph())
    True
    """
    own = {
        symbol: sympy.Symbol(f"{name}.{key}", real=True)
        for name, element in graph.elements.items()
        for key, symbol in element.symbols.items()
    }
    lines = [
        f"element {name} {type(element).__name__} {_element(element, own)}"
        for name, element in graph.elements.items()
    ]
    lines += [f"bond {bond.name} {bond.tail} {bond.head}" for bond in graph.bonds]
    lines += [
        f"parameter {text_of(symbol)} {text_of(row.value)} {row.unit}"
        for symbol, row in graph.parameters.items()
    ]
    lines += [f"input {text_of(symbol)} {unit}" for symbol, unit in graph.inputs.items()]
    lines += [
        f"output {name} {text_of(output.expression, own)}" for name, output in graph.outputs.items()
    ]
    return "\n".join(lines)


def _element(element: Any, own: Mapping[Any, Any]) -> str:
    return " ".join(
        f"{field.name}={text_of(getattr(element, field.name), own)}"
        for field in fields(element)
        if field.name != "name"
    )


def text_of(value: Any, own: Mapping[Any, Any] | None = None) -> str:
    """Return a text that tells a value wholly: numbers to the last bit, arrays by a hash.

    Parameters
    ----------
    value : number, str, expression, array, mapping, sequence, dataclass or function
    own : mapping of Symbol to Symbol, optional
        Exchanged in expressions before they are written.

    Raises
    ------
    SweepError
        For what cannot be told.

    Examples
    --------
    >>> text_of({"a": (0.1, "mm")})
    "{'a': (0.1, 'mm')}"
    """
    if isinstance(value, sympy.Basic):
        return sympy.srepr(value.xreplace(dict(own or {})))
    if isinstance(value, numpy.ndarray):
        data = numpy.ascontiguousarray(value)
        return f"array{data.shape}{data.dtype.str}{digest(data.tobytes())}"
    if isinstance(value, numpy.generic):
        return text_of(value.item())
    if value is None or isinstance(value, bool | int | float | str | bytes):
        return repr(value)
    if isinstance(value, Mapping):
        inside = ", ".join(
            f"{text_of(key, own)}: {text_of(item, own)}" for key, item in value.items()
        )
        return f"{{{inside}}}"
    if isinstance(value, tuple | list | sympy.Tuple):
        return f"({', '.join(text_of(item, own) for item in value)})"
    if isinstance(value, set | frozenset):
        return f"{{{', '.join(sorted(text_of(item, own) for item in value))}}}"
    if isinstance(value, type):
        return f"{value.__module__}.{value.__qualname__}"
    if is_dataclass(value):
        inside = ", ".join(
            f"{field.name}={text_of(getattr(value, field.name), own)}" for field in fields(value)
        )
        return f"{type(value).__name__}({inside})"
    return _function(value)


def _function(value: Any) -> str:
    """Tell a function by its code and what it holds; anything else by its pickle."""
    if isinstance(value, types.MethodType):
        return f"{text_of(value.__func__)} of {text_of(value.__self__)}"
    if isinstance(value, types.FunctionType):
        cells = [cell.cell_contents for cell in value.__closure__ or ()]
        held = text_of((*(value.__defaults__ or ()), *cells, value.__kwdefaults__))
        return f"{value.__module__}.{value.__qualname__} {_code(value.__code__)} {held}"
    try:
        return f"{type(value).__qualname__} {digest(pickle.dumps(value, protocol=5))}"
    except Exception as error:
        raise SweepError(
            f"{value!r:.80} cannot be told apart from others, so that a sweep with it could not be "
            f"taken up again: {error}; use a function, or leave out= away"
        ) from None


def _code(code: types.CodeType) -> str:
    constants = " ".join(
        _code(item) if isinstance(item, types.CodeType) else text_of(item)
        for item in code.co_consts
    )
    return digest(code.co_code + f"{code.co_names} {code.co_varnames} {constants}".encode())


def _quantity(what: Any) -> str:
    return what.label if isinstance(what, Quantity) else digest(text_of(what))


def _points(points: Points) -> str:
    return digest(
        text_of((dict(points.columns), dict(points.units), points.dims, dict(points.axes)))
    )
