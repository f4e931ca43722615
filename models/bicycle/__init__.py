"""Parts of a bicycle that its models are built from, and their parameter sheet."""

from .parts import brake_outputs, hydraulic_line, pad_friction, rear_frame, rear_wheel
from .sheet import SYMBOLS, sheet

__all__ = [
    "SYMBOLS",
    "brake_outputs",
    "hydraulic_line",
    "pad_friction",
    "rear_frame",
    "rear_wheel",
    "sheet",
]
