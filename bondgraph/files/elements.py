"""Elements and the keywords of their laws: one from the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

import sympy

from ..dimensions.laws import lag_law
from ..elements import (
    GY,
    TF,
    C,
    Clutch,
    De,
    Df,
    DryFriction,
    Element,
    EndStop,
    Heat,
    I,
    Integrator,
    Junction,
    Lag,
    OneWay,
    R,
    Se,
    Sf,
    SignalBlock,
    Switch,
)
from ..errors import BondGraphError, GraphError, LawError
from ..expressions.words import reason
from .entries import as_expression, as_text, at, nearest
from .fields import as_function
from .kinds import KINDS, VARIABLES, Kind, local, variables_of
from .names import Names

HEATERS = (R, DryFriction)


def built(
    label: str,
    kind: Kind,
    row: Mapping[str, Any],
    names: Names,
    variables: Mapping[str, sympy.Symbol],
) -> Element:
    """Build an element whose symbols are the ones other laws already use."""
    laws: dict[str, Any] = {}
    for key, argument in kind.laws.items():
        if key in row:
            bare = {argument: variables[f"{label}.{argument}"]} if argument else {}
            law = as_expression(row[key], names.within(bare), f"element {label!r}, {key}")
            laws[key] = as_function(law, list(bare.values())) if argument else law
    laws |= {key: row.get(key, False) for key in kind.flags}
    if kind.references:
        laws["power"] = _power(label, row, laws.get("power"), variables)
    with at(f"element {label!r}"):
        try:
            element = kind.build(local(label), **laws)
        except (TypeError, ValueError, ArithmeticError, RecursionError) as error:
            raise LawError(f"its law cannot be worked out ({reason(error)}); simplify it") from None
        own = {symbol: variables[f"{label}.{key}"] for key, symbol in variables_of(element).items()}
        return element.replaced(own, name=label)


def check_heaters(
    rows: Mapping[str, tuple[Kind, Mapping[str, Any]]], kinds: Mapping[str, Kind]
) -> None:
    """Raise where a heat comes of what is no dissipator of the file."""
    heaters = [label for label, kind in kinds.items() if issubclass(kind.build, HEATERS)]
    for label, (kind, row) in rows.items():
        if not kind.references or "dissipator" not in row:
            continue
        name = as_text(row["dissipator"], f"element {label!r}, dissipator")
        if name not in heaters:
            raise GraphError(
                f"element {label!r}: there is no dissipator {name!r}; {nearest(name, heaters or ['none'])}",
                elements=[label],
            )


def _power(
    label: str, row: Mapping[str, Any], power: Any, variables: Mapping[str, sympy.Symbol]
) -> sympy.Expr:
    """Return the power that becomes heat."""
    if ("dissipator" in row) is (power is not None):
        raise LawError(
            f"element {label!r} (Heat) takes exactly one of dissipator, power; name the element whose loss it is",
            elements=[label],
        )
    if power is not None:
        return power
    return variables[f"{row['dissipator']}.e"] * variables[f"{row['dissipator']}.f"]


def laws_of(element: Any) -> dict[str, sympy.Expr]:
    """Return the keywords that build an element's laws again."""
    if isinstance(element, Se):
        return {"effort": element.effort}
    if isinstance(element, Sf):
        return {"flow": element.flow}
    if isinstance(element, TF | GY):
        return {"ratio": element.ratio}
    if isinstance(element, Heat):
        return {"power": element.power}
    if isinstance(element, DryFriction):
        return _friction_laws(element)
    if isinstance(element, OneWay | Switch | EndStop):
        return _switch_laws(element)
    if isinstance(element, SignalBlock):
        return _block_laws(element)
    if isinstance(element, Junction | De | Df):
        return {}
    assert isinstance(element, R | C | I)
    given = _resistor_forms(element) if isinstance(element, R) else _storage_forms(element)
    forms = [{key: law for key, law in form.items() if law is not None} for form in given]
    forms = [form for form in forms if form]
    chosen = next((form for form in forms if _builds(element, form)), forms[-1] if forms else {})
    return chosen | _initial(element)


def _initial(element: Any) -> dict[str, sympy.Expr]:
    initial = getattr(element, "initial", sympy.S.Zero)
    return {} if initial == 0 else {"initial": initial}


def _friction_laws(element: DryFriction) -> dict[str, sympy.Expr]:
    magnitude, most = (
        ("capacity", "static") if isinstance(element, Clutch) else ("kinetic", "breakaway")
    )
    laws = {magnitude: element.kinetic}
    if element.breakaway != element.kinetic.xreplace({element.speed: sympy.S.Zero}):
        laws[most] = element.breakaway
    if element.smoothing is not None:
        laws["smoothing"] = element.smoothing
    return laws


def _switch_laws(element: OneWay | Switch | EndStop) -> dict[str, sympy.Expr]:
    """Return the laws; what may be left out is left out where it is zero."""
    kind = KINDS[type(element).__name__]
    laws = {key: getattr(element, key) for key in kind.laws}
    return {key: law for key, law in laws.items() if key in kind.required or law != 0}


def _block_laws(element: SignalBlock) -> dict[str, sympy.Expr]:
    laws = {"rate": element.rate}
    if isinstance(element, Integrator):
        laws = {"signal": element.rate}
    elif isinstance(element, Lag):
        signal, constant = lag_law(element)
        laws = {"signal": signal, "time_constant": constant}
    return laws | _initial(element)


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
        key: as_function(law, [getattr(element, arguments[key])]) if arguments[key] else law
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
