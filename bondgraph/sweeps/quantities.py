"""What a sweep keeps of each run: frozen values that say what they need of it.

A quantity with ``needs = ENDS`` is had from the end of a run and its counts of mode changes,
which a whole chunk of points gives at once; one with ``needs = RUN`` looks at each run's course.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy

from ..errors import SweepError
from .known import check_after, check_mode, check_signal, unit_of

if TYPE_CHECKING:
    from ..simulation import CompiledModel, Trajectory
    from ..simulation.ends import Ends

Array = numpy.ndarray
Span = tuple[float, float]

ENDS: Literal["ends"] = "ends"
RUN: Literal["run"] = "run"


@dataclass(frozen=True)
class Quantity:
    """Base of what is kept of a run: one number of each.

    Attributes
    ----------
    label : str
        As on the command line, such as ``peak:x_c@0.1``.
    needs : {"ends", "run"}
    optional : bool
        Whether NaN is an answer, such as the time of what did not happen.
    """

    needs: ClassVar[str] = RUN
    optional: ClassVar[bool] = False

    @property
    def label(self) -> str:
        """Name in the result unless another is given."""
        raise NotImplementedError

    def unit(self, model: CompiledModel) -> str:
        """Return the unit of the number; empty where it is none or not known."""
        return ""

    def check(self, model: CompiledModel, span: Span) -> None:
        """Raise SweepError where a model cannot give this."""

    def of_run(self, run: Trajectory) -> float:
        """Return the number of a finished run."""
        raise NotImplementedError

    def of_ends(self, ends: Ends) -> Array:
        """Return the numbers of finished runs, of shape (np,); for ``needs = ENDS`` alone."""
        raise NotImplementedError


@dataclass(frozen=True)
class Final(Quantity):
    """A signal at the end of the run.

    Attributes
    ----------
    signal : str
        A state, output, input or port variable.

    Examples
    --------
    >>> Final("V_c").label
    'final:V_c'
    """

    signal: str
    needs: ClassVar[str] = ENDS

    @property
    def label(self) -> str:
        """Name in the result unless another is given."""
        return f"final:{self.signal}"

    def unit(self, model: CompiledModel) -> str:
        """Return the signal's unit."""
        return unit_of(model, self.signal)

    def check(self, model: CompiledModel, span: Span) -> None:
        """Raise SweepError for an unknown signal."""
        check_signal(model, self.signal)

    def of_run(self, run: Trajectory) -> float:
        """Return the signal at the last time."""
        from ..simulation.ends import gathered

        return float(gathered(run.model, [run]).signals([self.signal])[0, 0])

    def of_ends(self, ends: Ends) -> Array:
        """Return the signal at the last times."""
        return ends.signals([self.signal])[0]


@dataclass(frozen=True)
class _Along(Quantity):
    """A signal, looked at from a time on."""

    signal: str
    after: float | None = None
    word: ClassVar[str]

    @property
    def label(self) -> str:
        """Name in the result unless another is given."""
        return f"{self.word}:{self.signal}{_since(self.after)}"

    def unit(self, model: CompiledModel) -> str:
        """Return the signal's unit."""
        return unit_of(model, self.signal)

    def check(self, model: CompiledModel, span: Span) -> None:
        """Raise SweepError for an unknown signal, or a time outside the run."""
        check_signal(model, self.signal)
        check_after(self.label, self.after, span)

    def of_run(self, run: Trajectory) -> float:
        """Return the number of a finished run."""
        chosen = slice(None) if self.after is None else run.t >= self.after
        times = run.t[chosen]
        if len(times) < 2:
            raise SweepError(f"{self.label}: t_eval has fewer than two times there; give more")
        return float(self._number(times, run[self.signal][chosen]))

    def _number(self, t: Array, values: Array) -> Any:
        raise NotImplementedError


class Peak(_Along):
    """The largest value of a signal, among the times of ``t_eval``.

    Examples
    --------
    >>> Peak("x_c", after=0.1).label
    'peak:x_c@0.1'
    """

    word: ClassVar[str] = "peak"

    def _number(self, t: Array, values: Array) -> Any:
        return values.max()


class Minimum(_Along):
    """The least value of a signal, among the times of ``t_eval``.

    Examples
    --------
    >>> Minimum("slip").label
    'min:slip'
    """

    word: ClassVar[str] = "min"

    def _number(self, t: Array, values: Array) -> Any:
        return values.min()


class Mean(_Along):
    """The mean of a signal over time, by the trapezoidal rule.

    Examples
    --------
    >>> Mean("N").label
    'mean:N'
    """

    word: ClassVar[str] = "mean"

    def _number(self, t: Array, values: Array) -> Any:
        return numpy.trapezoid(values, t) / (t[-1] - t[0])


class Rms(_Along):
    """The root of the mean square of a signal over time, by the trapezoidal rule.

    Examples
    --------
    >>> Rms("V_c").label
    'rms:V_c'
    """

    word: ClassVar[str] = "rms"

    def _number(self, t: Array, values: Array) -> Any:
        return numpy.sqrt(numpy.trapezoid(values * values, t) / (t[-1] - t[0]))


@dataclass(frozen=True)
class Count(Quantity):
    """How often a switching element enters a mode.

    Attributes
    ----------
    element : str
    mode : str
        Such as ``"stick"``.

    Examples
    --------
    >>> Count("friction", "stick").label
    'count:friction:stick'
    """

    element: str
    mode: str
    needs: ClassVar[str] = ENDS

    @property
    def label(self) -> str:
        """Name in the result unless another is given."""
        return f"count:{self.element}:{self.mode}"

    def check(self, model: CompiledModel, span: Span) -> None:
        """Raise SweepError for an unknown element or mode."""
        check_mode(model, self.element, self.mode)

    def of_run(self, run: Trajectory) -> float:
        """Return the number of entries."""
        return float(len(_entries(run, self.element, self.mode)))

    def of_ends(self, ends: Ends) -> Array:
        """Return the numbers of entries."""
        column = ends.model.contact_names.index(self.element)
        code = ends.model.equations.graph[self.element].modes[self.mode]
        return ends.entered[:, column, int(numpy.sign(code)) % 3].astype(float)


@dataclass(frozen=True)
class Share(Quantity):
    """The part of the time that a switching element spends in a mode, 0 to 1.

    Attributes
    ----------
    element, mode : str
    after : float, optional
        Looked at from this time on, s.

    Examples
    --------
    >>> Share("friction", "stick").label
    'share:friction:stick'
    """

    element: str
    mode: str
    after: float | None = None

    @property
    def label(self) -> str:
        """Name in the result unless another is given."""
        return f"share:{self.element}:{self.mode}{_since(self.after)}"

    def check(self, model: CompiledModel, span: Span) -> None:
        """Raise SweepError for an unknown element or mode, or a time outside the run."""
        check_mode(model, self.element, self.mode)
        check_after(self.label, self.after, span)

    def of_run(self, run: Trajectory) -> float:
        """Return the part, from the located times of events."""
        changes = [event for event in run.events if event.element == self.element]
        column = run.model.contact_names.index(self.element)
        first = changes[0].from_mode if changes else _label(run, column)
        edges = numpy.array([-math.inf, *(event.t for event in changes), run.t_end])
        start = float(run.t[0]) if self.after is None else self.after
        lengths = numpy.diff(numpy.clip(edges, start, None))
        inside = [mode == self.mode for mode in (first, *(event.to_mode for event in changes))]
        return float(lengths[inside].sum() / (run.t_end - start))


@dataclass(frozen=True)
class EventTime(Quantity):
    """When a switching element enters a mode, in s; NaN where it does not so often.

    Attributes
    ----------
    element, mode : str
    index : int
        Which of the entries, from 0; negative counts from the last.

    Examples
    --------
    >>> EventTime("friction", "stick").label
    'time:friction:stick:0'
    """

    element: str
    mode: str
    index: int = 0
    optional: ClassVar[bool] = True

    @property
    def label(self) -> str:
        """Name in the result unless another is given."""
        return f"time:{self.element}:{self.mode}:{self.index}"

    def unit(self, model: CompiledModel) -> str:
        """Return s."""
        return "s"

    def check(self, model: CompiledModel, span: Span) -> None:
        """Raise SweepError for an unknown element or mode."""
        check_mode(model, self.element, self.mode)

    def of_run(self, run: Trajectory) -> float:
        """Return the time of the entry."""
        times = _entries(run, self.element, self.mode)
        inside = -len(times) <= self.index < len(times)
        return times[self.index] if inside else math.nan


ENERGIES = {"supplied": "J", "stored": "J", "dissipated": "J", "residual": ""}


@dataclass(frozen=True)
class Energy(Quantity):
    """One term of the energy audit, or the relative residual.

    NaN where a storage's law has no potential, so that its energy is not known.

    Attributes
    ----------
    term : {"residual", "supplied", "stored", "dissipated"}

    Examples
    --------
    >>> Energy("supplied").label
    'energy:supplied'
    """

    term: str = "residual"
    needs: ClassVar[str] = ENDS
    optional: ClassVar[bool] = True

    @property
    def label(self) -> str:
        """Name in the result unless another is given."""
        return f"energy:{self.term}"

    def unit(self, model: CompiledModel) -> str:
        """Return J; nothing for the residual."""
        return ENERGIES[self.term]

    def check(self, model: CompiledModel, span: Span) -> None:
        """Raise SweepError for an unknown term."""
        if self.term not in ENERGIES:
            raise SweepError(f"energy {self.term!r} is not known; use {', '.join(ENERGIES)}")

    def of_run(self, run: Trajectory) -> float:
        """Return the term of the run's audit."""
        name = "relative_residual" if self.term == "residual" else self.term
        value = getattr(run.energy, name)
        return math.nan if value is None else float(value)

    def of_ends(self, ends: Ends) -> Array:
        """Return the terms of the runs' audits."""
        return numpy.asarray(getattr(ends, self.term))


def _since(after: float | None) -> str:
    return "" if after is None else f"@{after!r}"


def _entries(run: Trajectory, element: str, mode: str) -> list[float]:
    return [event.t for event in run.events if (event.element, event.to_mode) == (element, mode)]


def _label(run: Trajectory, column: int) -> str:
    """Return the mode of a switching element that never changes it."""
    element = run.model.equations.graph[run.model.contact_names[column]]
    return str(element.label(int(run.codes_end[column])))
