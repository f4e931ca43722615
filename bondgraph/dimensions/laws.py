"""What each kind of element asks of the dimensions of its laws."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy

from ..elements import (
    C,
    DryFriction,
    EffortSource,
    Element,
    EndStop,
    FlowSource,
    Friction,
    Heat,
    Integrator,
    Lag,
    OneWay,
    R,
    SignalBlock,
    Storage,
    Switch,
)
from ..elements.fields import port_of
from .forms import POWER, SECOND, Form, per, times

MOST_OPERATIONS = 300  # of a field's law that is expanded


@dataclass(frozen=True)
class LawClaim:
    """A law and the dimension that it must have.

    Attributes
    ----------
    form : Form or None
        None where the law need only agree with itself.
    law : Expr
    what : str
        What the law gives, for messages.
    firm : bool
        Whether it is the element's main law.
    certain : bool
        Whether it counts even where no declared unit is in the law.
    """

    form: Form | None
    law: sympy.Expr
    what: str
    firm: bool = False
    certain: bool = False


def law_claims(element: Element, forms: Mapping[sympy.Basic, Form]) -> list[LawClaim]:
    """Return what the laws of a one-port or signal block must be, each independent law once.

    Parameters
    ----------
    element : Element
    forms : mapping of Symbol to Form
        Of the port variables and states.

    Examples
    --------
    >>> from bondgraph import Se
    >>> push = Se("push", 3)
    >>> [(item.law, item.what) for item in law_claims(push, {push.e: {}})]
    [(3, 'effort')]
    """
    if isinstance(element, Storage):
        return _storage(element, forms)
    if isinstance(element, DryFriction):
        return _friction(element, forms)
    if isinstance(element, OneWay):
        slope = per(forms[element.e], forms[element.f])
        return [
            LawClaim(forms[element.e], element.drop, "its drop", firm=True),
            LawClaim(slope, element.resistance, "its resistance", firm=True),
        ]
    if isinstance(element, Switch):
        return [LawClaim(None, element.closed, "")]
    if isinstance(element, EndStop):
        return [
            LawClaim(times(forms[element.f], SECOND), element.gap, "its gap"),
            LawClaim({}, element.restitution, "its restitution"),
            LawClaim(forms[element.f], element.rest, "its speed of rest"),
        ]
    if isinstance(element, SignalBlock):
        return _block(element, forms[element.y])
    if isinstance(element, Heat):
        return [LawClaim(POWER, element.power, "its power")]
    if isinstance(element, EffortSource | R) and element.effort is not None:
        return _main(element, forms[element.e], element.effort, "effort")
    if isinstance(element, FlowSource | R) and element.flow is not None:
        return _main(element, forms[element.f], element.flow, "flow")
    return []


def _storage(element: Storage, forms: Mapping[sympy.Basic, Form]) -> list[LawClaim]:
    main = "effort" if isinstance(element, C) else "flow"
    laws = _main(element, forms[element.coenergy], element.law, main)
    return [*laws, LawClaim(forms[element.state], element.initial, "its initial state")]


def _main(element: Element, form: Form, law: sympy.Expr, what: str) -> list[LawClaim]:
    """Return the main law; of a field's port term by term, as each hears of another bond."""
    terms = [law]
    if port_of(element) is not None:
        small = law.count_ops() <= MOST_OPERATIONS
        terms = list(sympy.Add.make_args(sympy.expand(law) if small else law))
    return [LawClaim(form, term, what, firm=True) for term in terms]


def _friction(element: DryFriction, forms: Mapping[sympy.Basic, Form]) -> list[LawClaim]:
    found = [LawClaim(forms[element.e], element.kinetic, "effort", firm=True)]
    if element.breakaway != element.kinetic.xreplace({element.speed: sympy.S.Zero}):
        what = "its breakaway" if isinstance(element, Friction) else "its static capacity"
        found.append(LawClaim(forms[element.e], element.breakaway, what))
    if element.smoothing is not None:
        found.append(LawClaim(forms[element.f], element.smoothing, "its smoothing width"))
    return found


def _block(element: SignalBlock, state: Form) -> list[LawClaim]:
    initial = LawClaim(state, element.initial, "its initial state")
    if isinstance(element, Lag):
        signal, constant = lag_law(element)
        lag = LawClaim(SECOND, constant, "its time constant")
        return [LawClaim(state, signal, "its state", certain=True), lag, initial]
    # an integral has the unit of its signal times s, whatever numbers stand elsewhere
    certain = isinstance(element, Integrator)
    rate = LawClaim(per(state, SECOND), element.rate, "its rate", certain=certain)
    return [rate, initial]


def lag_law(element: Lag) -> tuple[sympy.Expr, sympy.Expr]:
    """Return signal and time constant of a lag, from its rate."""
    constant = -1 / sympy.diff(element.rate, element.y)
    rest = sympy.Add.make_args(element.rate.xreplace({element.y: sympy.S.Zero}))
    return sympy.Add(*(term * constant for term in rest)), constant
