"""Trajectory: what a simulation gives, addressed by name."""

from __future__ import annotations

import csv
import functools
import logging
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy

from ..errors import BondGraphError, SimulationError
from ..parameters import unknown_name
from ..views import HtmlView, SvgView
from .compiled import CompiledModel
from .inputs import at
from .outcome import Outcome
from .problem import Event as Change

if TYPE_CHECKING:
    import pandas
    import xarray

    from .problem import Options, Problem, Solution
    from .smooth import SmoothProblem

log = logging.getLogger(__name__)

Array = numpy.ndarray


@dataclass(frozen=True)
class Event:
    """A change of mode.

    Attributes
    ----------
    t : float
        Time, s.
    element : str
        Qualified name of the contact.
    from_mode, to_mode : str
        ``"stick"``, ``"slip+"`` or ``"slip-"``.
    """

    t: float
    element: str
    from_mode: str
    to_mode: str


@dataclass(frozen=True)
class Energy:
    """Energy audit of a run, in J.

    Attributes
    ----------
    supplied : float
        By all sources, integrated along the run.
    stored : float or None
        Change of stored energy from start to end; None where a storage's law
        has no potential.
    dissipated : float
    relative_residual : float or None
        ``(supplied - stored - dissipated)`` over the largest energy involved.
    """

    supplied: float
    stored: float | None
    dissipated: float
    relative_residual: float | None


@dataclass(frozen=True, eq=False)
class Kept:
    """What a run was made from, and how it went.

    Attributes
    ----------
    problem : Problem or SmoothProblem
    options : Options
    solution : Solution or None
        With its steps; None for a smooth model.
    """

    problem: Problem | SmoothProblem
    options: Options
    solution: Solution | None = None


@dataclass(frozen=True, eq=False)
class Trajectory(HtmlView, SvgView):
    """Result of a simulation.

    Any state, output, input or port variable is had by name:
    ``trajectory["rear.mass.p"]``, ``trajectory["omega_r"]``,
    ``trajectory["friction.f"]``.

    Attributes
    ----------
    t : (nt,) array
        Times, s.
    x : (n, nt) array
        States, ordered as ``model.equations.states``.
    changes : sequence
        The events as the integrator logged them, by number of contact and code.
    outcome : Outcome
        Named; `outcome.ok` only where the run reached its end.
    t_end : float
        Last good time.
    final : dict of str to float
        Last good states and outputs.
    energy : Energy
    parameters : dict of str to float
        SI values of the run.
    backend : str
        ``"native"`` or ``"vm"``.
    solver : str
        ``"dopri5"``, ``"cvodes"``, ``"idas"`` or ``"rosenbrock"``.
    solver_reason : str
        Why that one, such as "rosenbrock: 3 algebraic variables".
    remark : str
        What the run itself adds to its outcome's advice; empty where it has nothing.
    z : (nz, nt) array
        Algebraic variables, ordered as ``model.equations.algebraic``.
    kept : Kept or None
        What the run was made from, where `sensitivities` asked for it.
    """

    t: Array
    x: Array
    codes: Array
    changes: Sequence[Change]
    outcome: Outcome
    t_end: float
    energy: Energy
    parameters: dict[str, float]
    backend: str
    steps: int
    model: CompiledModel
    inputs: Any
    x_end: Array
    codes_end: Array
    solver: str = "dopri5"
    z: Array = field(default_factory=lambda: numpy.zeros((0, 1)))
    z_end: Array = field(default_factory=lambda: numpy.zeros(0))
    solver_reason: str = ""
    remark: str = ""
    kept: Kept | None = field(default=None, repr=False)

    def __getitem__(self, name: str) -> Array:
        """Return a signal at all times, of shape (nt,)."""
        return self._along((str(getattr(name, "name", name)),))[0]

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        return (
            f"Trajectory({self.model.equations.name!r}, {self.outcome.value} at {self.t_end:g} s, "
            f"{len(self.t)} samples, {len(self.events)} events)"
        )

    @functools.cached_property
    def events(self) -> tuple[Event, ...]:
        """Changes of mode in order, with the names of elements and modes."""
        names = self.model.contact_names
        graph = self.model.equations.graph
        labels = [{code: label for label, code in graph[name].modes.items()} for name in names]
        return tuple(
            Event(
                change.t,
                names[change.switch],
                labels[change.switch][change.before],
                labels[change.switch][change.after],
            )
            for change in self.changes
        )

    @property
    def advice(self) -> str:
        """What happened at the end, and what to do about it."""
        return "; ".join(filter(None, (self.outcome.advice, self.remark)))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all signals."""
        return self.model.names

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(state.name for state in self.model.equations.states)

    @property
    def final(self) -> dict[str, float]:
        """States and outputs at the last good time."""
        names = (*self.states, *self.model.equations.outputs)
        end = numpy.array([self.t_end])
        solved = numpy.append(self.x_end, self.z_end).reshape(-1, 1)
        ((mask, (_, arguments)),) = self._sorted(end, solved, self.codes_end[None]).items()
        values = self.model.signals(mask, names)(*arguments)
        return {name: float(value[0]) for name, value in zip(names, values, strict=True)}

    @functools.cached_property
    def undefined(self) -> dict[str, float]:
        """Outputs, states and inputs that are not finite somewhere, and the first such time, s.

        A run whose states are finite has finished, but an output that divides by zero on
        the way is no result. Times are those reported and the last.
        """
        names = tuple(self.columns())
        found = {
            name: float(self.t[numpy.argmin(good)])
            for name, good in zip(names, numpy.isfinite(self._along(names)), strict=True)
            if not good.all()
        }
        for name, value in self.final.items():
            if not math.isfinite(value):
                found.setdefault(name, self.t_end)
        return found

    @property
    def modes(self) -> dict[str, Array]:
        """Mode of each contact at all times, as arrays of str."""
        return {
            name: numpy.array([self._label(name, int(code)) for code in column], dtype=object)
            for name, column in zip(self.model.contact_names, self.codes.T, strict=True)
        }

    def _codes(self, name: str) -> str:
        modes = self.model.equations.graph[name].modes
        return ", ".join(f"{code} {label}" for label, code in modes.items())

    def _label(self, name: str, code: int) -> str:
        return self.model.equations.graph[name].label(code)

    def unit(self, name: str) -> str:
        """Return the unit of a signal: declared for outputs and inputs, inferred for the rest.

        Parameters
        ----------
        name : str

        Returns
        -------
        str
            Empty where it is dimensionless or not known.
        """
        equations = self.model.equations
        if name in equations.graph.outputs:
            return equations.graph.outputs[name].unit or self.model.units.get(name) or ""
        for symbol, unit in equations.graph.inputs.items():
            if symbol.name == name:
                return unit
        return self.model.units.get(name) or ""

    def sticks(self, element: str | None = None) -> Array:
        """Return the times at which a contact begins to stick.

        Parameters
        ----------
        element : str, optional
            All contacts unless given.

        Returns
        -------
        (k,) array
        """
        return numpy.array(
            [
                event.t
                for event in self.events
                if event.to_mode == "stick" and element in (None, event.element)
            ]
        )

    def columns(self, names: tuple[str, ...] | None = None) -> dict[str, Array]:
        """Return signals by name; outputs, states and inputs unless named."""
        equations = self.model.equations
        if names is None:
            inputs = tuple(symbol.name for symbol in equations.graph.inputs)
            names = tuple(dict.fromkeys((*equations.outputs, *self.states, *inputs)))
        return dict(zip(names, self._along(names), strict=True))

    def to_xarray(self, names: tuple[str, ...] | None = None) -> xarray.Dataset:
        """Return an xarray Dataset over time, with units, modes and outcome.

        Raises
        ------
        BondGraphError
            If xarray is not installed.
        """
        xarray = _optional("xarray")
        data = {
            name: ("time", values, {"units": self.unit(name)})
            for name, values in self.columns(names).items()
        }
        modes = {
            f"{name}.mode": (
                "time",
                column.astype(numpy.int8),
                {"meaning": self._codes(name)},
            )
            for name, column in zip(self.model.contact_names, self.codes.T, strict=True)
        }
        attributes = {
            "model": self.model.equations.name,
            "outcome": self.outcome.value,
            "solver": self.solver,
            "solver_reason": self.solver_reason,
            "t_end": self.t_end,
            **{f"parameter {name}": value for name, value in self.parameters.items()},
        }
        return xarray.Dataset(
            {**data, **modes}, {"time": ("time", self.t, {"units": "s"})}, attributes
        )

    def to_dataframe(self, names: tuple[str, ...] | None = None) -> pandas.DataFrame:
        """Return a pandas DataFrame indexed by time.

        Raises
        ------
        BondGraphError
            If pandas is not installed.
        """
        pandas = _optional("pandas")
        return pandas.DataFrame(self.columns(names), index=pandas.Index(self.t, name="time"))

    def save(self, path: str | Path, names: tuple[str, ...] | None = None) -> Path:
        """Write the signals to a ``.csv`` or ``.nc`` file.

        Parameters
        ----------
        path : str or Path
        names : tuple of str, optional
            Outputs, states and inputs unless given.

        Returns
        -------
        Path

        Raises
        ------
        SimulationError
            For another ending, or a folder that cannot be written.

        Notes
        -----
        What is not finite is an empty cell in CSV, NaN in netCDF, and logged as a warning.
        """
        path = Path(path)
        if path.suffix not in (".csv", ".nc"):
            raise SimulationError(f"cannot write {path.name!r}: use the ending .csv or .nc")
        lost = [name for name in self.undefined if names is None or name in names]
        if lost:
            log.warning("%s: %s", path, self.undefined_words(lost))
        try:
            if path.suffix == ".nc":
                self.to_xarray(names).to_netcdf(path)
            else:
                self._write_csv(path, names)
        except OSError as error:
            raise SimulationError(f"cannot write {path}: {error.strerror or error}") from None
        return path

    def undefined_words(self, names: Iterable[str] | None = None) -> str:
        """Say which signals are not finite; empty where all are."""
        some = self.undefined if names is None else names
        return "; ".join(
            f"{name} is not finite at t = {self.undefined[name]:.9g} s" for name in some
        )

    def _write_csv(self, path: Path, names: tuple[str, ...] | None) -> None:
        columns = self.columns(names)
        with path.open("w", newline="", encoding="utf-8") as file:
            file.write(f"# model {self.model.equations.name}, outcome {self.outcome.value}\n")
            writer = csv.writer(file)
            units = [self.unit(name) for name in columns]
            writer.writerow(
                [
                    "time [s]",
                    *(f"{n} [{u}]" if u else n for n, u in zip(columns, units, strict=True)),
                ]
            )
            writer.writerows(
                [repr(float(v)) if math.isfinite(v) else "" for v in row]
                for row in zip(self.t, *columns.values(), strict=True)
            )

    def _along(self, names: tuple[str, ...]) -> Array:
        """Evaluate signals at all times, sample by sample in the equations of its own mode."""
        self._check(names)
        out = numpy.empty((len(names), len(self.t)))
        with numpy.errstate(all="ignore"):  # what is not finite is told by `undefined`
            for mask, (here, arguments) in self._by_mode.items():
                out[:, here] = self.model.signals(mask, names)(*arguments)
        return out

    @functools.cached_property
    def _by_mode(self) -> dict[int, tuple[Any, tuple[Array, ...]]]:
        """Where each mode holds, and there what its signals are functions of."""
        solved = numpy.concatenate([self.x, self.z]) if len(self.z) else self.x
        return self._sorted(self.t, solved, self.codes)

    def _sorted(self, t: Array, x: Array, codes: Array) -> dict[int, tuple[Any, tuple[Array, ...]]]:
        """Sort samples by mode; algebraic variables follow the states in x."""
        names = [symbol.name for symbol in self.model.equations.parameters]
        p = numpy.array([self.parameters[name] for name in names])[:, None]
        u = at(self.inputs, t)
        masks = (codes == 0) @ (1 << numpy.arange(codes.shape[1]))
        found: dict[int, tuple[Any, tuple[Array, ...]]] = {}
        for mask in numpy.unique(masks).tolist():
            here = slice(None) if (masks == mask).all() else numpy.flatnonzero(masks == mask)
            found[mask] = here, (t[None, here], x[:, here], u[:, here], p, codes[here].T)
        return found

    def _check(self, names: tuple[str, ...]) -> None:
        for name in names:
            try:
                self.model.expression(self.model.equations, name)
            except KeyError:
                raise unknown_name("signal", name, self.names) from None


def _optional(module: str) -> Any:
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError:
        raise BondGraphError(f"{module} is not installed; pip install 'halfarrow[data]'") from None
