"""What varies from outside: samples with a hold, functions of time, files, brought to one table.

`gather` is the way in: it turns what a user gives into a `table` of knots and cubics, or into
`Functions` where that cannot be. `samples` are signals with a declared hold, `curves` the cubics
through them.
"""

from .gather import Functions, at, gather
from .samples import HOLDS, Samples
from .table import InputTable

__all__ = ["HOLDS", "Functions", "InputTable", "Samples", "at", "gather"]
