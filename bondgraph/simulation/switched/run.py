"""One run of a switched model: a problem goes in, a solution comes out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..hybrid import solution_of
from ..mode_set import ModeSet
from ..problem import Options, Problem, Solution
from .stepper import SwitchedStepper

if TYPE_CHECKING:
    from ..stepper import Model


def integrate_switched(problem: Problem, options: Options, model: ModeSet) -> Solution:
    """Integrate a switched model from event to event.

    Parameters
    ----------
    problem : Problem
    options : Options
        The backend is the virtual machine.
    model : ModeSet

    Returns
    -------
    Solution
    """

    def functions(mask: int) -> tuple[Model, Model]:
        numbers = model.numbers(mask)
        return numbers.rhs, numbers.guard

    model.forget()
    stepper = SwitchedStepper(problem, options, functions, model)
    outcome = stepper.run()
    return solution_of(stepper, outcome)
