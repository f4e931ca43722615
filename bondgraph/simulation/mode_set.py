"""The modes of a model: their equations and numeric functions, made when a mode is first met."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy
import sympy

from ..codegen.program import Program
from ..codegen.to_casadi import to_casadi
from ..codegen.to_numpy import to_numpy
from ..elements import EndStop, Switched
from ..equations import Equations
from ..errors import BondGraphError, SimulationError
from ..graph import TIME
from ..modes import ModeEquations, mode_equations
from .implicit import Implicit

if TYPE_CHECKING:
    import casadi

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class ModeNumbers:
    """Numeric functions of one mode, of ``(t, x, u, p, s)`` and most also of w.

    Attributes
    ----------
    equations : ModeEquations
    rhs : callable
        To the rates of all states, supplied and dissipated power, shape (n + 2,).
    guard : callable
        To margins, then values, shape (2k,).
    relation : callable
        ``(t, x, u, p, s, w)`` to what bound states are off their relation, shape
        (b,), and its Jacobian by w, shape (b, h): w is imposed on what is held.
    push : callable
        ``(t, x, u, p, s, w)`` to the Jacobians of the state rates and powers,
        shape (n + 2, h), and of the answers, shape (k, h), by the rate of w.
    held : tuple of int
        The switch that each entry of w belongs to.
    bound : (b,) array of int
        Indices of the bound states.
    forget : callable
        Drops what the last call found of the algebraic variables.
    """

    equations: ModeEquations
    rhs: Callable[..., Array]
    guard: Callable[..., Array]
    relation: Callable[..., tuple[Array, Array]]
    push: Callable[..., tuple[Array, Array]]
    held: tuple[int, ...]
    bound: Array
    forget: Callable[[], None]


class ModeSet:
    """The switching elements of a model, and the equations and functions of its modes.

    Parameters
    ----------
    base : Equations
        Of the graph with all modes open.
    inputs : sequence of Symbol
        All inputs, with the rates that modes may need.
    parameters : sequence of Symbol
    derived : mapping of tuple of str to ModeEquations, optional
        Modes that are at hand, by what they hold.

    Attributes
    ----------
    names : tuple of str
        Qualified names of the switching elements.
    elements : tuple of Switched
    """

    def __init__(
        self,
        base: Equations,
        inputs: Sequence[sympy.Symbol],
        parameters: Sequence[sympy.Symbol],
        derived: Mapping[tuple[str, ...], ModeEquations] | None = None,
    ) -> None:
        self.base = base
        found = {name: element for name, element in base.graph.of(Switched) if element.switches}
        self.names = tuple(found)
        self.elements: tuple[Switched, ...] = tuple(found.values())
        self._inputs, self._parameters = tuple(inputs), tuple(parameters)
        self._derived = dict(derived or {})
        self._equations: dict[int, ModeEquations | BondGraphError] = {}
        self._numbers: dict[int, ModeNumbers] = {}

    def equations(self, mask: int) -> ModeEquations:
        """Return the equations of the mode in which the switches of the mask's bits are held.

        Raises
        ------
        BondGraphError
            Where the mode cannot be.
        """
        if mask not in self._equations:
            held = tuple(name for bit, name in enumerate(self.names) if mask >> bit & 1)
            try:
                mode = self._derived.get(held) or mode_equations(self.base, held)
                self._equations[mask] = self._checked(mode)
            except BondGraphError as error:
                self._equations[mask] = error
        found = self._equations[mask]
        if isinstance(found, BondGraphError):
            raise found
        return found

    def _checked(self, mode: ModeEquations) -> ModeEquations:
        known = {*self._inputs, *mode.imposed.values(), *mode.imposed_rates.values()}
        foreign = [symbol.name for symbol in mode.equations.inputs if symbol not in known]
        if foreign:
            raise SimulationError(
                f"model {self.base.name!r}: a mode needs {', '.join(foreign)}, a rate that samples cannot "
                f"give; add a compliance or inertia behind the source or switch"
            )
        return mode

    def program(self, mask: int, name: str, results: Mapping[str, Sequence[sympy.Expr]]) -> Program:
        """Build a program in ``(t, x, u, p, s, z, w, v)`` on a mode's equations.

        A result named ``relation`` is filled in; in one named ``stored`` bound states are those of
        x, not those that follow.
        """
        mode = self.equations(mask)
        stand_ins = {state: sympy.Dummy(state.name, real=True) for state in mode.bound}
        filled = dict(results)
        if "relation" in filled:
            filled["relation"] = [stand_ins[state] - state for state in mode.bound]
        if "stored" in filled:
            filled["stored"] = [energy.xreplace(stand_ins) for energy in filled["stored"]]
        return Program.pruned(
            name,
            [
                ("t", [TIME]),
                ("x", [stand_ins.get(state, state) for state in mode.states]),
                ("u", self._inputs),
                ("p", self._parameters),
                ("s", self._directions(mode)),
                ("z", mode.equations.algebraic),
                ("w", mode.imposed.values()),
                ("v", mode.imposed_rates.values()),
            ],
            mode.equations.assignments,
            filled,
        )

    def _directions(self, mode: ModeEquations) -> list[sympy.Symbol]:
        return [mode.directions.get(name, sympy.Dummy(f"{name}.direction")) for name in self.names]

    def impact(self, switch: int, p: Array) -> tuple[float, float]:
        """Return restitution and rest speed of an end stop, for a parameter vector."""
        stop = self.elements[switch]
        assert isinstance(stop, EndStop)
        given = dict(zip(self._parameters, map(float, p), strict=True))
        return float(stop.restitution.subs(given)), float(stop.rest.subs(given))

    def numbers(self, mask: int) -> ModeNumbers:
        """Return the numeric functions of a mode.

        Raises
        ------
        BondGraphError
            Where the mode cannot be.
        """
        if mask not in self._numbers:
            self._numbers[mask] = self._made(mask)
        return self._numbers[mask]

    def calm(self, mask: int) -> tuple[casadi.Function, casadi.Function]:
        """Return rates with powers, and guards, as functions of ``(t, x, u, p, s)``.

        Raises
        ------
        SimulationError
            For a mode that keeps algebraic variables.
        """
        import casadi

        algebraic = [symbol.name for symbol in self.equations(mask).equations.algebraic]
        if algebraic:
            raise SimulationError(
                f"model {self.base.name!r}: with some of its contacts held, {', '.join(algebraic)} stay "
                f"algebraic; add a compliance or inertia where they arise",
                elements=algebraic,
            )
        arguments, (rates, guards) = self.expressions(mask, ("rates", "guards"))
        given, moved = arguments[:5], casadi.vertcat(*arguments[6:])
        rates, guards = (casadi.densify(casadi.substitute(e, moved, 0)) for e in (rates, guards))
        return casadi.Function("rhs", given, [rates]), casadi.Function("guard", given, [guards])

    def expressions(self, mask: int, wanted: Sequence[str]) -> tuple[list[Any], list[Any]]:
        """Return CasADi symbols of a mode's arguments, and results in them.

        Parameters
        ----------
        mask : int
        wanted : sequence of str
            Of rates, guards, answers, relation and residual.

        Returns
        -------
        arguments : list of casadi.SX
            ``t, x, u, p, s, z, w, v``, as in `program`.
        results : list of casadi.SX
        """
        import casadi

        mode = self.equations(mask)
        results = {
            "rates": [*mode.derivatives, *_powers(mode)],
            "guards": [*mode.margins.values(), *mode.values.values()],
            "answers": list(mode.answers.values()),
            "relation": [],
            "residual": list(mode.equations.residuals),
        }
        program = self.program(mask, "mode", {key: results[key] for key in wanted})
        arguments = [casadi.SX.sym(label, len(symbols)) for label, symbols in program.arguments]
        found = to_casadi(program, fixed=("p",))(*arguments)
        return arguments, list(found) if isinstance(found, tuple | list) else [found]

    def _made(self, mask: int) -> ModeNumbers:
        mode = self.equations(mask)
        wanted = ("rates", "guards", "answers", "relation", "residual")
        arguments, results = self.expressions(mask, wanted)
        implicit = Implicit(arguments, results)
        order = list(mode.imposed)
        return ModeNumbers(
            equations=mode,
            rhs=implicit.calm(0),
            guard=implicit.calm(1),
            relation=implicit.with_slope(3, by="w"),
            push=_widened(
                implicit.slopes((0, 2), by="v"),
                [order.index(name) for name in mode.imposed_rates],
                len(order),
            ),
            held=tuple(self.names.index(name) for name in order),
            bound=numpy.array([mode.states.index(state) for state in mode.bound], dtype=int),
            forget=implicit.forget,
        )

    def forget(self) -> None:
        """Let a run begin as if it were the first."""
        for numbers in self._numbers.values():
            numbers.forget()

    def stored(self, mask: int) -> Callable[..., float] | None:
        """Return stored energy as a function of ``(t, x, u, p, s, w)``; None where no potential is known.

        With w, what the mode would have to impose, it is the energy before a jump into the mode.
        """
        energies = list(self.equations(mask).equations.energies.values())
        known = [energy for energy in energies if energy is not None]
        if len(known) < len(energies):
            return None
        function = self._function(mask, "stored", [sympy.Add(*known)])

        def energy(t: float, *given: Array) -> float:
            columns = (numpy.asarray(item, dtype=float)[:, None] for item in given)
            return float(function(numpy.array([[t]]), *columns)[0].item())

        return energy

    def signals(self, mask: int, results: Sequence[sympy.Expr]) -> Callable[..., Array]:
        """Return a NumPy function of ``(t, x, u, p, s)``, each of shape (size, nt), to results."""
        function = self._function(mask, "signals", results)
        still = numpy.zeros((len(self.equations(mask).imposed), 1))
        return lambda *given: function(*given, still)

    def _function(
        self, mask: int, name: str, results: Sequence[sympy.Expr]
    ) -> Callable[..., Array]:
        """Return a NumPy function of ``(t, x, u, p, s, w)``, its algebraic variables solved for."""
        program = self.program(mask, name, {name: results})
        function = to_numpy(program)
        calm = numpy.zeros((len(program.arguments[-1][1]), 1))
        none = numpy.zeros((0, 1))
        if not self.equations(mask).equations.algebraic:
            return lambda *given: function(*given[:5], none, given[5], calm)[0]
        implicit = Implicit(*self.expressions(mask, ["residual"]))

        def solved(*given: Array) -> Array:
            implicit.forget()
            columns = max(item.shape[1] for item in given)
            wide = [numpy.broadcast_to(item, (item.shape[0], columns)) for item in given]
            found = [implicit.solve(*(item[:, i] for item in wide)) for i in range(columns)]
            return function(*given[:5], numpy.array(found).T, given[5], calm)[0]

        return solved


def _powers(mode: ModeEquations) -> list[sympy.Expr]:
    """Supplied and dissipated power; what a switching element takes is dissipated in any mode."""
    supplied, dissipated = [], list(mode.equations.dissipated.values())
    for name, power in mode.equations.supplied.items():
        if name in mode.imposed:
            dissipated.append(-power)
        else:
            supplied.append(power)
    return [sympy.Add(*supplied), sympy.Add(*dissipated)]


def _widened(
    function: Callable[..., tuple[Array, ...]], places: list[int], size: int
) -> Callable[..., tuple[Array, Array]]:
    """Give Jacobians by some of the rates a column for each value that is imposed."""

    def evaluate(*arguments: Any) -> tuple[Array, Array]:
        found = []
        for matrix in function(*arguments):
            wide = numpy.zeros((matrix.shape[0], size))
            wide[:, places] = matrix
            found.append(wide)
        return found[0], found[1]

    return evaluate
