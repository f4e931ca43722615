"""Parameters and initial states fitted to recordings, with what the data can tell of them.

`run` is the whole face. `recordings` matches columns with signals, `unknowns` has what is sought;
`shots` runs segments with their derivatives, `problem` makes rows of them, `chain` eliminates the start
states of segments, `descend` steps, `segments` and `search` decide between one shot and many,
`identify` says what is seen, `result` puts the `Fit` together.
"""

from .descend import Iteration
from .identify import Direction
from .outcome import FitOutcome
from .run import fit
from .value import Channel, Fit

__all__ = ["Channel", "Direction", "Fit", "FitOutcome", "Iteration", "fit"]
