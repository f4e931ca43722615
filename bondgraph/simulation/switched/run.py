"""One run of a switched model: a problem goes in, a solution comes out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..hybrid import evaluator, solution_of
from ..problem import Options, Problem, Solution
from .functions import SwitchedModel
from .stepper import SwitchedStepper

if TYPE_CHECKING:
    from ..stepper import Model


def integrate_switched(problem: Problem, options: Options, model: SwitchedModel) -> Solution:
    """Integrate a switched model from event to event.

    Parameters
    ----------
    problem : Problem
    options : Options
        The backend is the virtual machine.
    model : SwitchedModel

    Returns
    -------
    Solution
    """
    made: dict[int, tuple[Model, Model]] = {}

    def functions(mask: int) -> tuple[Model, Model]:
        if mask not in made:
            numbers = model.numbers(mask)
            made[mask] = evaluator(numbers.rhs), evaluator(numbers.guard)
        return made[mask]

    stepper = SwitchedStepper(problem, options, functions, model)
    outcome = stepper.run()
    return solution_of(stepper, outcome)
