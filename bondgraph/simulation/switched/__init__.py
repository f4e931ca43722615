"""Simulation of graphs with diodes, switches, end stops: modes that hold and bind states.

`jump` takes a state into a mode with impulses, `search` finds the mode that holds, `stepper` integrates from event to
event on the method of `bondgraph.simulation.stepper`, `run` puts them together.
"""

from .jump import imposed_before, jump
from .run import integrate_switched
from .search import mask_of

__all__ = ["imposed_before", "integrate_switched", "jump", "mask_of"]
