"""How values show themselves in a notebook: hooks that find what draws and writes them.

A drawing or a plot stands above the value that it shows, so the value cannot import
it. The one import against the layers is here, made by name when a notebook asks, and
nothing but the view is lost where it fails.
"""

from __future__ import annotations

import importlib
from typing import Any


def _view(kind: str, value: Any) -> str:
    return importlib.import_module("bondgraph.notebook").view(kind, value)


class HtmlView:
    """A value that a notebook shows as HTML: what JupyterLab and VS Code take first."""

    def _repr_html_(self) -> str:
        return _view("html", self)


class SvgView:
    """A value that is a picture where a notebook takes no HTML."""

    def _repr_svg_(self) -> str:
        return _view("svg", self)


class LatexView:
    """A value that is a formula, such as where a notebook becomes a PDF."""

    def _repr_latex_(self) -> str:
        return _view("latex", self)
