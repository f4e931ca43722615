"""Continuation: steady states and their edges of stability followed by arclength.

`curve` follows any curve; `path` is the branch of steady states along one parameter, with the
`crossings` on it; `boundary` follows an edge in two parameters by the equations of `defining`.
"""

from .boundary import Boundary, Special, follow_edge
from .path import Path, follow_path

__all__ = ["Boundary", "Path", "Special", "follow_edge", "follow_path"]
