"""Elements: frozen values that know their ports and their laws.

One-ports Se, Sf, R, C, I and Friction; two-ports TF and GY; junctions Zero and
One. Elements compare by identity: two ``One("v")`` are two junctions.

Every port variable and state is a sympy symbol (``x.e``, ``x.f``, ``c.q``,
``m.p``) that any other law may use: that is modulation.
"""

from .base import EFFORT, FLOW, Element, OnePort
from .dissipators import Friction, R
from .junctions import Junction, One, Zero
from .sources import Se, Sf
from .storage import C, I, Storage
from .two_ports import GY, TF, TwoPort

__all__ = [
    "C",
    "EFFORT",
    "Element",
    "FLOW",
    "Friction",
    "GY",
    "I",
    "Junction",
    "One",
    "OnePort",
    "R",
    "Se",
    "Sf",
    "Storage",
    "TF",
    "TwoPort",
    "Zero",
]
