"""Views of values in a notebook, as HTML, SVG and LaTeX.

Front ends take HTML first where a value has it, so it holds what is most useful:
the drawing of a graph beside its counts, equations as MathML, which needs no library,
a run's outcome with its curves. SVG is the picture alone, and LaTeX is for documents
that are typeset. Every text that comes from a model is escaped.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

# Class and kind of view to the module here whose function of that kind writes it.
VIEWS: Mapping[tuple[str, str], str] = MappingProxyType(
    {
        ("BondGraph", "html"): "graphs",
        ("BondGraph", "svg"): "graphs",
        ("CausalGraph", "html"): "graphs",
        ("CausalGraph", "svg"): "graphs",
        ("Equations", "html"): "equations",
        ("Equations", "latex"): "equations",
        ("LinearSystem", "html"): "systems",
        ("LinearSystem", "latex"): "systems",
        ("StabilityResult", "html"): "stability",
        ("SteadyState", "html"): "points",
        ("Trajectory", "html"): "runs",
        ("Trajectory", "svg"): "runs",
    }
)


def view(kind: str, value: Any) -> str:
    """Return a view of a value.

    Parameters
    ----------
    kind : str
        ``"html"``, ``"svg"`` or ``"latex"``.
    value : object
        Of a class in `VIEWS`.

    Returns
    -------
    str

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> view("svg", mass_on_belt.graph()).startswith("<svg")
    True
    """
    home = VIEWS[type(value).__name__, kind]
    return getattr(importlib.import_module(f"{__name__}.{home}"), kind)(value)


__all__ = ["VIEWS", "view"]
