"""Elements and the keywords of their laws: one from the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields
from typing import Any

import sympy

from ..elements import GY, TF, C, Element, Friction, I, R, Se, Sf
from ..errors import BondGraphError, LawError
from ..expressions.words import reason
from .entries import as_expression, at
from .kinds import KINDS, VARIABLES, Kind, variables_of
from .names import Names


def built(
    label: str,
    kind: Kind,
    row: dict[str, Any],
    names: Names,
    variables: Mapping[str, sympy.Symbol],
) -> Element:
    """Build an element whose symbols are the ones other laws already use."""
    laws = {}
    for key, argument in kind.laws.items():
        if key in row:
            symbol = variables[f"{label}.{argument}"] if argument else None
            where = f"element {label!r}, {key}"
            law = as_expression(row[key], names.within(argument, symbol), where)
            laws[key] = _function(law, symbol) if argument else law
    with at(f"element {label!r}"):
        try:
            element = kind.build(local(label), **laws)
        except (TypeError, ValueError, ArithmeticError, RecursionError) as error:
            raise LawError(f"its law cannot be worked out ({reason(error)}); simplify it") from None
        own = {symbol: variables[f"{label}.{key}"] for key, symbol in variables_of(element).items()}
        return element.replaced(own, name=label)


def laws_of(element: Any) -> dict[str, sympy.Expr]:
    """Return the keywords that build an element's laws again."""
    if isinstance(element, Se):
        return {"effort": element.effort}
    if isinstance(element, Sf):
        return {"flow": element.flow}
    if isinstance(element, TF | GY):
        return {"ratio": element.ratio}
    if isinstance(element, Friction):
        return _friction_laws(element)
    forms: Iterable[dict[str, Any]] = ()
    if isinstance(element, R):
        forms = _resistor_forms(element)
    elif isinstance(element, C | I):
        forms = _storage_forms(element)
    forms = [{key: law for key, law in form.items() if law is not None} for form in forms]
    forms = [form for form in forms if form]
    chosen = next((form for form in forms if _builds(element, form)), forms[-1] if forms else {})
    initial = getattr(element, "initial", sympy.S.Zero)
    return chosen | ({"initial": initial} if initial != 0 else {})


def _friction_laws(element: Friction) -> dict[str, sympy.Expr]:
    laws = {"kinetic": element.kinetic}
    if element.breakaway != element.kinetic.xreplace({element.speed: sympy.S.Zero}):
        laws["breakaway"] = element.breakaway
    if element.smoothing is not None:
        laws["smoothing"] = element.smoothing
    return laws


def _resistor_forms(element: R) -> Iterator[dict[str, Any]]:
    if element.effort is not None:
        yield {"resistance": _slope(element.effort, element.f)}
        yield {"effort": element.effort}
    yield {"flow": element.flow}
    yield {"effort": element.effort}


def _storage_forms(element: C | I) -> Iterator[dict[str, Any]]:
    direct, inverse = ("effort", "capacitance") if isinstance(element, C) else ("flow", "inertance")
    slope = _slope(element.law, element.state)
    if slope is not None:
        compliance = None if slope == 0 else 1 / slope
        stiff = {"stiffness": slope} if isinstance(element, C) else {}
        simple = compliance is None or slope.count_ops() <= compliance.count_ops()
        yield stiff if simple else {inverse: compliance}
        yield {inverse: compliance}
    yield {direct: element.law}
    yield {"energy": element.energy}
    yield {direct: element.law}


def _slope(law: sympy.Expr, argument: sympy.Symbol) -> sympy.Expr | None:
    """Return the factor of a law that is proportional to its argument."""
    slope = law / argument
    return None if argument in slope.free_symbols else slope


def _builds(element: Any, form: dict[str, sympy.Expr]) -> bool:
    """Whether the keywords give an element with the very same laws."""
    arguments = KINDS[type(element).__name__].laws
    laws = {
        key: _function(law, getattr(element, arguments[key])) if arguments[key] else law
        for key, law in form.items()
    }
    try:
        twin = type(element)(local(element.name), **laws)
    except (BondGraphError, TypeError, ValueError):
        return False
    own = {symbol: getattr(element, key) for key, symbol in variables_of(twin).items()}
    twin = twin.replaced(own)
    return all(
        getattr(element, item.name) == getattr(twin, item.name)
        for item in fields(element)
        if item.name not in (*VARIABLES, "name", "initial")
    )


def _function(law: sympy.Expr, argument: Any) -> Callable[[Any], Any]:
    return lambda given: law.xreplace({argument: given})


def local(label: str) -> str:
    """Return an element's own name, without its submodels."""
    return label.rpartition(".")[2]
