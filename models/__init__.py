"""The model library: one module a model, each with a ``graph()``.

A new model is a module here and a line in `LIBRARY`.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

LIBRARY: Mapping[str, str] = MappingProxyType(
    {
        "bicycle_brake": "rear brake with frame and wheel: stick-slip squeal",
        "frame_brake": "the same brake on a rigid wheel: the older, frame-only model",
        "mass_on_belt": "mass on a moving belt: the textbook stick-slip oscillator",
        "quarter_car": "quarter car on a road: two masses, tyre and suspension",
    }
)


def __getattr__(name: str) -> Any:
    if name not in LIBRARY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return importlib.import_module(f".{name}", __name__)


def __dir__() -> list[str]:
    return sorted([*globals(), *LIBRARY])
