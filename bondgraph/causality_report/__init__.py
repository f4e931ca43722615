"""What causality made of a graph: strokes, reasons, dependent storage, loops, modes.

`report_causality` gathers it as one frozen value, `to_text` and `to_json` write it.

`value` holds the report, `gather` makes it, `constraints` says what binds dependent
storages, `remedies` how to do without a loop, `mode_table` what each mode of switching
elements does to the states.
"""

from .as_json import to_json
from .as_text import to_text
from .gather import report_causality
from .value import (
    BondCausality,
    BoundState,
    CausalityReport,
    JunctionDecision,
    LoopReport,
    ModeCausality,
    Reduction,
    StorageCausality,
)

__all__ = [
    "BondCausality",
    "BoundState",
    "CausalityReport",
    "JunctionDecision",
    "LoopReport",
    "ModeCausality",
    "Reduction",
    "StorageCausality",
    "report_causality",
    "to_json",
    "to_text",
]
