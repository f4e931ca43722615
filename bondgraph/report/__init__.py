"""Reports: one self-contained page on the stability of a model, with its plots and numbers.

`write_report` writes it. A model adds to it with sections of its own, made of
`Text`, `Bullets`, `Table` and `Figure`.
"""

from .blocks import Bullets, Figure, Panel, Section, Table, Text
from .maps import plane, stability_maps
from .write import write_report

__all__ = [
    "Bullets",
    "Figure",
    "Panel",
    "Section",
    "Table",
    "Text",
    "plane",
    "stability_maps",
    "write_report",
]
