"""How a fit ended: named values, each with the way out."""

from __future__ import annotations

import enum

__all__ = ["FitOutcome"]


class FitOutcome(enum.Enum):
    """How a fit ended; whatever it is, the best point found is in the result.

    Examples
    --------
    >>> FitOutcome.CONVERGED.ok, FitOutcome.STALLED.ok
    (True, False)
    """

    CONVERGED = "converged"
    STEP_LIMIT = "step limit"
    TIME_BUDGET = "time budget"
    STALLED = "stalled"
    NO_START = "no start"

    @property
    def ok(self) -> bool:
        """Whether a minimum was reached."""
        return self is FitOutcome.CONVERGED

    @property
    def advice(self) -> str:
        """One sentence: what happened and what to do about it."""
        return _ADVICE[self]


_ADVICE = {
    FitOutcome.CONVERGED: "no step lowers the misfit any more",
    FitOutcome.STEP_LIMIT: (
        "as many steps as allowed; raise max_iterations, or fit fewer parameters at once"
    ),
    FitOutcome.TIME_BUDGET: (
        "the seconds allowed were used up; raise time_budget, loosen rtol, or thin the recording"
    ),
    FitOutcome.STALLED: (
        "steps along the slope no longer lower the misfit although it is not level: runs fail on "
        "the way, or the misfit is rough at this tolerance; tighten rtol, give bounds, or segments"
    ),
    FitOutcome.NO_START: (
        "the model does not run to its end at the start values nor near them, in no segment; "
        "give other start values in parameters={...}, or bounds"
    ),
}
