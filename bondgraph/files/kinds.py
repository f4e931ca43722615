"""Which elements a file may hold, and the keys of their laws."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Any

import sympy

from ..elements import GY, TF, C, Friction, I, One, R, Se, Sf, Zero


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
    required : str
        The law that must be given, where there is no choice.

    Examples
    --------
    >>> KINDS["R"].laws["effort"]
    'f'
    """

    build: type[Any]
    laws: Mapping[str, str] = field(default_factory=dict)
    required: str = ""

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
    }
)
KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "Se": Kind(Se, {"effort": "f"}, "effort"),
        "Sf": Kind(Sf, {"flow": "e"}, "flow"),
        "R": Kind(R, {"resistance": "", "effort": "f", "flow": "e"}),
        "C": Kind(
            C, {"capacitance": "", "stiffness": "", "effort": "q", "energy": "q", "initial": ""}
        ),
        "I": Kind(I, {"inertance": "", "flow": "p", "energy": "p", "initial": ""}),
        "Friction": Kind(
            Friction, {"kinetic": "speed", "breakaway": "", "smoothing": ""}, "kinetic"
        ),
        "TF": Kind(TF, {"ratio": ""}, "ratio"),
        "GY": Kind(GY, {"ratio": ""}, "ratio"),
        "Zero": Kind(Zero),
        "One": Kind(One),
    }
)
ALIASES: Mapping[str, str] = MappingProxyType({"0": "Zero", "1": "One"})


def variables_of(element: Any) -> dict[str, sympy.Symbol]:
    """Return an element's port variables and states by attribute name."""
    return {
        item.name: getattr(element, item.name) for item in fields(element) if item.name in VARIABLES
    }
