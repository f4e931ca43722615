"""The choice of a solver: which can do a model, which is taken unless named, and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..errors import SimulationError
from .compiled import CompiledModel

if TYPE_CHECKING:
    import numpy

EXPLICIT = "dopri5"
SMOOTH = ("cvodes", "idas", "rosenbrock")
# Measured at rtol 1e-6 on two cores, ms and largest relative error against rtol 1e-10, rosenbrock
# beside cvodes: Robertson to 1e4 s 12, 3e-6 and 11, 7e-8; van der Pol, mu = 1000, 16, 2e-5 and 17,
# 2e-5; RC ladders of 20 and of 100 capacitors 9, 5e-8 and 8, 4e-8, 25, 1e-6 and 35, 6e-8. As fast,
# in a fifth of the steps; and it starts again at full order after each jump of an input, and damps
# oscillations that a BDF method of high order lets grow. idas is no faster on any of them.
IMPLICIT = "rosenbrock"
LARGEST = 1000  # states; a run of a ladder so long takes 7 s and a gigabyte


@dataclass(frozen=True)
class Choice:
    """A solver and why it was taken.

    Attributes
    ----------
    solver : {"dopri5", "cvodes", "idas", "rosenbrock"}
    reason : str
        Beginning with the solver's name.

    Examples
    --------
    >>> Choice("dopri5", "dopri5: asked for").solver
    'dopri5'
    """

    solver: str
    reason: str


@dataclass(frozen=True, eq=False)
class Start:
    """Where a run begins, for a look at how stiff it is.

    Attributes
    ----------
    span : (float, float)
        Start and end, s.
    x : (n,) array
    p : (np,) array
    inputs : InputTable or callable
    """

    span: tuple[float, float]
    x: numpy.ndarray
    p: numpy.ndarray
    inputs: Any


def choose(
    model: CompiledModel, solver: str, backend: str = "auto", start: Start | None = None
) -> Choice:
    """Return the solver to use, and the reason.

    Parameters
    ----------
    model : CompiledModel
    solver : {"auto", "dopri5", "cvodes", "idas", "rosenbrock"}
    backend : {"auto", "native", "vm"}
        What is to be compiled is left to dopri5.
    start : Start, optional
        Without it a model that dopri5 can do is taken for nonstiff.

    Returns
    -------
    Choice

    Raises
    ------
    SimulationError
        For a solver that cannot do the model.

    Examples
    --------
    >>> from bondgraph.models import mass_on_belt
    >>> choose(CompiledModel(mass_on_belt.graph()), "auto").reason
    'dopri5: 1 contact with modes, events are located'
    """
    equations = model.equations
    implicit = tuple(symbol.name for symbol in equations.algebraic)
    if model.switched:
        implicit = ()  # each mode has its own, and solves for them as it goes
    if solver not in ("auto", EXPLICIT, *SMOOTH):
        raise SimulationError(
            f"solver {solver!r} is not known; use auto, {', '.join((EXPLICIT, *SMOOTH))}"
        )
    if solver != "auto":
        choice = Choice(solver, f"{solver}: asked for")
    else:
        choice = _automatic(model, implicit, backend, start)
    _check(model, choice.solver, implicit, backend)
    return choice


def _automatic(
    model: CompiledModel, implicit: tuple[str, ...], backend: str, start: Start | None
) -> Choice:
    if model.contact_names:
        what = "switching element" if model.switched else "contact"
        some = _count(len(model.contact_names), what)
        return Choice(EXPLICIT, f"{EXPLICIT}: {some} with modes, events are located")
    if implicit:
        return Choice(IMPLICIT, f"{IMPLICIT}: {_count(len(implicit), 'algebraic variable')}")
    if backend == "native":
        return Choice(EXPLICIT, f"{EXPLICIT}: compiled code was asked for")
    if start is not None:
        found = model.stiffness(start.span, start.x, start.p, start.inputs)
        if found.stiff and len(start.x) > LARGEST:
            return Choice(
                EXPLICIT,
                f"{EXPLICIT}: stiff, but {len(start.x)} states are more than the dense matrices of "
                f"{IMPLICIT} are good for",
            )
        if found.stiff:
            length = start.span[1] - start.span[0]
            return Choice(
                IMPLICIT,
                f"{IMPLICIT}: stiff: fastest mode {found.rate:.1e} 1/s over {length:g} s would take "
                f"~{found.steps:.0e} explicit steps",
            )
    return Choice(EXPLICIT, f"{EXPLICIT}: explicit equations, not stiff at the start")


def _count(number: int, what: str) -> str:
    return f"{number} {what}" + ("" if number == 1 else "s")


def _check(model: CompiledModel, chosen: str, implicit: tuple[str, ...], backend: str) -> None:
    """Refuse a solver that cannot do a model."""
    name = model.equations.name
    if implicit and chosen in (EXPLICIT, "cvodes"):
        raise SimulationError(
            f"solver {chosen!r} cannot follow algebraic variables, and model {name!r} "
            f"keeps some ({', '.join(implicit)}); use solver='rosenbrock' or 'idas'",
            elements=implicit,
        )
    if model.contact_names and chosen in SMOOTH:
        raise SimulationError(
            f"solver {chosen!r} locates no events, and model {name!r} has contacts with "
            f"modes ({', '.join(model.contact_names)}); use solver='dopri5', or smooth them",
            elements=model.contact_names,
        )
    if chosen in SMOOTH and backend == "native":
        raise SimulationError(
            f"solver {chosen!r} runs on CasADi's virtual machine; leave backend='native' out"
        )


def stiff_advice(model: CompiledModel, end: Start) -> str:
    """Return what to do about a run of dopri5 that stopped early; empty where it is not stiff there.

    Parameters
    ----------
    model : CompiledModel
        Without switching elements.
    end : Start
        The last good point, and the span of the whole run.

    Returns
    -------
    str
    """
    found = model.stiffness(end.span, end.x, end.p, end.inputs, ())
    if not found.stiff:
        return ""
    return f"it is stiff here (a mode of {found.rate:.1e} 1/s): use solver={IMPLICIT!r}"
