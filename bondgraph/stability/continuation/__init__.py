"""Continuation: steady states and their edges of stability followed by arclength.

`curve` follows any curve; `path` is the branch of steady states along one parameter, with the
`crossings` on it.
"""

from .path import Path, follow_path

__all__ = ["Path", "follow_path"]
