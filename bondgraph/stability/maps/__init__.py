"""Maps of eigenvalues over many points of parameters, worked out on arrays.

`table` evaluates parameters, `explicit` puts the equations of rest in order, `newton` searches
where that cannot be, `numbers` has the functions of a mode, `choice` the modes of contacts,
`eigen` the eigenvalues; `solver` takes a chunk of points through all of it.
"""

from .run import eigenvalue_map
from .value import EigenvalueMap, PointOutcome

__all__ = ["EigenvalueMap", "PointOutcome", "eigenvalue_map"]
