"""Dimensions: which unit every effort, flow and state of a graph has.

Efforts and flows of all bonds that meet at junctions have one dimension each,
and effort times flow is power on every bond. So a graph falls into regions
with one unknown, the dimension of effort; units of parameters, inputs and
outputs decide it, and two-ports carry it from region to region. What cannot be
known stays None; what contradicts itself is said in words. On pseudo-bonds effort
is temperature and flow is heat, and nothing more is claimed of them. What a
signal block says is one more unknown.

A bare number in a law may carry any unit, so it tells nothing.
"""

from .forms import si_unit
from .infer import Dimensions, infer

__all__ = ["Dimensions", "infer", "si_unit"]
