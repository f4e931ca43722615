"""Continuation: steady states and their edges of stability followed by arclength.

`curve` follows any curve; `path` is the branch of steady states along one parameter, with the
`crossings` on it; `boundary` follows an edge in two parameters by the equations of `defining`;
`planes` does so with all edges that are known along two parameters.
"""

from .boundary import Boundary, Special, follow_edge
from .path import Path, follow_path
from .planes import boundaries

__all__ = ["Boundary", "Path", "Special", "boundaries", "follow_edge", "follow_path"]
