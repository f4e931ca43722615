"""Which elements a file may hold, and the keys of their laws."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Any

import sympy

from ..elements import (
    GY,
    TF,
    Block,
    C,
    CheckValve,
    Clutch,
    De,
    Df,
    Diode,
    EndStop,
    Friction,
    Heat,
    I,
    Integrator,
    Lag,
    One,
    R,
    Se,
    Sf,
    Switch,
    Zero,
)


@dataclass(frozen=True)
class Kind:
    """How one kind of element stands in a file.

    Attributes
    ----------
    build : type
        The element's class.
    laws : mapping of str to str
        Keyword of the law, as in Python, to the variable that its text may
        use by its bare letter; empty where the law is no function.
    required : tuple of str
        The laws that must be given, where there is no choice.
    flags : tuple of str
        Keys that are true or false.
    references : tuple of str
        Keys that name another element, in place of a law.

    Examples
    --------
    >>> KINDS["R"].laws["effort"]
    'f'
    """

    build: type[Any]
    laws: Mapping[str, str] = field(default_factory=dict)
    required: tuple[str, ...] = ()
    flags: tuple[str, ...] = ()
    references: tuple[str, ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        """What may stand in a row, beside name and kind."""
        return (*self.laws, *self.flags, *self.references)

    @property
    def variables(self) -> dict[str, dict[str, bool]]:
        """Port variables and states, with what their symbols assume."""
        names = [item.name for item in fields(self.build)]
        return {name: VARIABLES[name] for name in names if name in VARIABLES}


VARIABLES: Mapping[str, dict[str, bool]] = MappingProxyType(
    {
        "e": {"real": True},
        "f": {"real": True},
        "q": {"real": True},
        "p": {"real": True},
        "e_in": {"real": True},
        "f_in": {"real": True},
        "e_out": {"real": True},
        "f_out": {"real": True},
        "speed": {"nonnegative": True},
        "y": {"real": True},
    }
)
KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "Se": Kind(Se, {"effort": "f"}, ("effort",)),
        "Sf": Kind(Sf, {"flow": "e"}, ("flow",)),
        "R": Kind(R, {"resistance": "", "effort": "f", "flow": "e"}),
        "C": Kind(
            C, {"capacitance": "", "stiffness": "", "effort": "q", "energy": "q", "initial": ""}
        ),
        "I": Kind(I, {"inertance": "", "flow": "p", "energy": "p", "initial": ""}),
        "Friction": Kind(
            Friction, {"kinetic": "speed", "breakaway": "", "smoothing": ""}, ("kinetic",)
        ),
        "Clutch": Kind(Clutch, {"capacity": "", "static": ""}, ("capacity",)),
        "Diode": Kind(Diode, {"drop": "", "resistance": ""}),
        "CheckValve": Kind(CheckValve, {"drop": "", "resistance": ""}),
        "Switch": Kind(Switch, {"closed": ""}, ("closed",)),
        "EndStop": Kind(
            EndStop, {"gap": "", "restitution": "", "rest": ""}, ("gap", "restitution")
        ),
        "TF": Kind(TF, {"ratio": ""}, ("ratio",)),
        "GY": Kind(GY, {"ratio": ""}, ("ratio",)),
        "Zero": Kind(Zero, flags=("pseudo",)),
        "One": Kind(One, flags=("pseudo",)),
        "Heat": Kind(Heat, {"power": ""}, flags=("pseudo",), references=("dissipator",)),
        "De": Kind(De),
        "Df": Kind(Df),
        "Block": Kind(Block, {"rate": "y", "initial": ""}, ("rate",)),
        "Integrator": Kind(Integrator, {"signal": "", "initial": ""}, ("signal",)),
        "Lag": Kind(
            Lag, {"signal": "", "time_constant": "", "initial": ""}, ("signal", "time_constant")
        ),
    }
)
RS, HEAT = "RS", "_heat"  # a resistor and its heat in one row, and how the heat is named
PORT = "Port"  # the place of a field's port in the order of elements
ALIASES: Mapping[str, str] = MappingProxyType({"0": "Zero", "1": "One"})


def variables_of(element: Any) -> dict[str, sympy.Symbol]:
    """Return an element's port variables and states by attribute name."""
    return {
        item.name: getattr(element, item.name) for item in fields(element) if item.name in VARIABLES
    }


def local(label: str) -> str:
    """Return an element's own name, without its submodels."""
    return label.rpartition(".")[2]
