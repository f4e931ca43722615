"""Simulators of machines with a hidden effect, which share nothing with bondgraph.

Each machine is a set of differential equations written by hand; hidden effects come in exact forms:
set-valued friction and rigid stops by located events, pure delays, roots without a laminar part.
`simulate` in `run` is the face.
"""

from .run import Drive, Hidden, simulate

__all__ = ["Drive", "Hidden", "simulate"]
