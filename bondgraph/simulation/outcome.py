"""How a run ended: named values, each with the way out."""

import enum

__all__ = ["Outcome"]


class Outcome(enum.Enum):
    """How a simulation ended.

    Whatever the outcome, the solution holds the last good time and state; only `FINISHED` reached
    the end of the time span.

    Examples
    --------
    >>> Outcome.STEP_UNDERFLOW.value
    'step underflow'
    >>> Outcome.STEP_UNDERFLOW.ok
    False
    """

    FINISHED = "finished"
    EVENT_LIMIT = "event limit"
    CHATTERING = "chattering"
    ZENO = "zeno"
    NO_MODE = "no consistent mode"
    STEP_UNDERFLOW = "step underflow"
    STEP_LIMIT = "step limit"
    SINGULAR = "singular"
    NON_FINITE = "non-finite"
    DIVERGED = "diverged"
    TIME_BUDGET = "time budget"

    @property
    def ok(self) -> bool:
        """Whether the run reached the end of its time span."""
        return self is Outcome.FINISHED

    @property
    def advice(self) -> str:
        """One sentence: what happened and what to do about it."""
        return _ADVICE[self]


_ADVICE = {
    Outcome.FINISHED: "the run reached the end of its time span",
    Outcome.EVENT_LIMIT: (
        "more stick and slip events than allowed; raise max_events if that many are expected"
    ),
    Outcome.CHATTERING: (
        "modes switch without time going on; check that kinetic friction at zero slip does not exceed "
        "the breakaway force, that no two frictions hold the same motion, and that a switch which "
        "changes its own command has a hysteresis or a lag; a law that jumps, such as sign(v), drives "
        "the motion back from both sides: write dry friction as Friction, or give the law a slope"
    ),
    Outcome.ZENO: (
        "impacts follow each other ever faster and pile up before the run's end; give the end stop "
        "rest=..., the closing speed below which it does not rebound"
    ),
    Outcome.NO_MODE: (
        "no set of modes of the switching elements fits this state, such as an open switch that "
        "leaves a current no way; add a diode, capacitance or resistance where it could go on"
    ),
    Outcome.STEP_UNDERFLOW: (
        "the step fell below the resolution of time; the solution may be singular here, or the "
        "model stiff or discontinuous: loosen rtol, or look at the state where it stopped"
    ),
    Outcome.STEP_LIMIT: (
        "more steps than allowed; the model may be stiff: raise max_steps, loosen rtol or shorten "
        "the time span"
    ),
    Outcome.SINGULAR: (
        "the algebraic variables are no longer determined here: their equations have no solution "
        "near by, such as past the fold of a law that falls and rises; the motion would have to "
        "jump: add a compliance or inertia where they arise"
    ),
    Outcome.NON_FINITE: (
        "the model returned NaN or infinity here; look for a division by zero, a logarithm or a "
        "root of a negative number, or an overflow in a law"
    ),
    Outcome.DIVERGED: (
        "a state grew beyond the bound; check signs and parameters for a source of energy without "
        "losses, or raise the bound"
    ),
    Outcome.TIME_BUDGET: (
        "the seconds allowed were used up; raise time_budget, loosen rtol or shorten the time span"
    ),
}
