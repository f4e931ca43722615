"""Elements: frozen values that know their ports and their laws.

One-ports Se, Sf, R, C and I; two-ports TF and GY; junctions Zero and One; the
multiport fields CField, IField, ICField and RField, bonded port by port; RS, whose
loss becomes heat; the switching elements Friction, Clutch, Diode, CheckValve, Switch
and EndStop; the sensors De and Df; and signal blocks with a state, Block, Integrator
and Lag. Elements compare by identity: two ``One("v")`` are two junctions.

Every port variable and state is a sympy symbol (``x.e``, ``x.f``, ``c.q``,
``m.p``) that any other law may use: that is modulation.
"""

from .base import EFFORT, FLOW, Element, OnePort
from .dissipators import R
from .fields import CField, Field, ICField, IField, RField
from .friction import Clutch, DryFriction, Friction
from .junctions import Junction, One, Zero
from .sensors import De, Df
from .signals import Block, Integrator, Lag, SignalBlock
from .sources import EffortSource, FlowSource, Se, Sf
from .storage import C, I, Storage
from .switched import Switched
from .switches import CheckValve, Diode, EndStop, OneWay, Switch
from .thermal import RS, Heat
from .two_ports import GY, TF, TwoPort

__all__ = [
    "Block",
    "C",
    "CField",
    "CheckValve",
    "Clutch",
    "De",
    "Df",
    "Diode",
    "DryFriction",
    "EFFORT",
    "EffortSource",
    "Element",
    "EndStop",
    "FLOW",
    "FlowSource",
    "Field",
    "Friction",
    "GY",
    "Heat",
    "I",
    "ICField",
    "IField",
    "Integrator",
    "Junction",
    "Lag",
    "One",
    "OneWay",
    "OnePort",
    "R",
    "RField",
    "RS",
    "Se",
    "SignalBlock",
    "Sf",
    "Storage",
    "Switch",
    "Switched",
    "TF",
    "TwoPort",
    "Zero",
]
