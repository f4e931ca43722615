"""Reports: one self-contained page on the stability of a model, with its plots and numbers.

`write_report` writes it, `write_index` a page that leads to several. A model adds to its report
with sections of its own, made of `Text`, `Bullets`, `Table` and `Figure`.
"""

from .blocks import Bullets, Figure, Panel, Section, Table, Text
from .index import Entry, write_index
from .maps import Plane, plane, stability_planes
from .summary import headline, ranked, unmoved
from .write import write_report

__all__ = [
    "Bullets",
    "Entry",
    "Figure",
    "Panel",
    "Plane",
    "Section",
    "Table",
    "Text",
    "headline",
    "plane",
    "ranked",
    "stability_planes",
    "unmoved",
    "write_index",
    "write_report",
]
