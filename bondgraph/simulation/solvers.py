"""The choice of a solver: which can do a model, and which is taken unless named."""

from __future__ import annotations

from ..errors import SimulationError
from .compiled import CompiledModel

EXPLICIT = "dopri5"
SMOOTH = ("cvodes", "idas", "rosenbrock")
# Beside idas it is as fast and nearer to the tolerance asked for, and starts again at full order
# after each jump of an input.
IMPLICIT = "rosenbrock"


def choose(model: CompiledModel, solver: str, backend: str = "auto") -> str:
    """Return the solver to use.

    Parameters
    ----------
    model : CompiledModel
    solver : {"auto", "dopri5", "cvodes", "idas", "rosenbrock"}
    backend : {"auto", "native", "vm"}

    Returns
    -------
    str
        Any but auto.

    Raises
    ------
    SimulationError
        For one that cannot do the model.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> choose(CompiledModel(mass_on_belt.graph()), "auto")
    'dopri5'
    """
    equations = model.equations
    implicit = tuple(symbol.name for symbol in equations.algebraic)
    if model.switched:
        implicit = ()  # each mode has its own, and solves for them as it goes
    if solver not in ("auto", EXPLICIT, *SMOOTH):
        raise SimulationError(
            f"solver {solver!r} is not known; use auto, {', '.join((EXPLICIT, *SMOOTH))}"
        )
    chosen = solver if solver != "auto" else IMPLICIT if implicit else EXPLICIT
    if implicit and chosen in (EXPLICIT, "cvodes"):
        raise SimulationError(
            f"solver {chosen!r} cannot follow algebraic variables, and model {equations.name!r} "
            f"keeps some ({', '.join(implicit)}); use solver='rosenbrock' or 'idas'",
            elements=implicit,
        )
    if model.contact_names and chosen in SMOOTH:
        raise SimulationError(
            f"solver {chosen!r} locates no events, and model {equations.name!r} has contacts with "
            f"modes ({', '.join(model.contact_names)}); use solver='dopri5', or smooth them",
            elements=model.contact_names,
        )
    if chosen in SMOOTH and backend == "native":
        raise SimulationError(
            f"solver {chosen!r} runs on CasADi's virtual machine; leave backend='native' out"
        )
    return chosen
