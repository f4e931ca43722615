"""Drawings of bond graphs: own layout, own SVG."""

from .layout import layout
from .pieces import Drawing
from .svg import to_svg

__all__ = ["Drawing", "layout", "to_svg"]
