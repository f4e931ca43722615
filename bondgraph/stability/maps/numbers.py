"""One mode of a graph at many points: rest, rates, Jacobian and contacts as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi
import numpy
import sympy

from ...codegen.casadi_to_numpy import on_arrays
from ...codegen.program import Program
from ...codegen.to_casadi import to_casadi
from ...elements import EndStop
from ...equations import Equations, derive
from ...graph import BondGraph
from ...modes import in_mode
from ...smooth import Smooth
from ...values import algebraic_guess, algebraic_names, start_expressions
from .eigen import diagonal_blocks
from .explicit import explicit_rest
from .newton import FLOOR, ROUNDING, balancing

Array = numpy.ndarray
Row = Any  # a number, or an (m,) array


@dataclass(frozen=True, eq=False)
class Evaluated:
    """What holds at m points.

    Attributes
    ----------
    x : (k, m) array
        States, and algebraic variables behind them.
    rates : (k, m) array
        What is left of the residuals behind the rates.
    slopes : list of float or (m,) array
        Structural nonzeros of their Jacobian in x, by columns.
    contacts : list of float or (m,) array
        Flow, effort and margins, contact by contact.
    """

    x: Array
    rates: Array
    slopes: list[Row]
    contacts: list[Row]


class ModeNumbers:
    """Functions of one mode on arrays.

    Parameters
    ----------
    graph : BondGraph
        With its contacts open.
    modes : mapping of str to str
        A mode for each contact.
    names : sequence of str
        Parameters that have a value; the order of the parameter vector.
    guess : mapping of str to float
        Where a search starts.

    Attributes
    ----------
    equations : Equations
    smooth : Smooth
        The same at one point, for points that need a longer search.
    size, order : int
        Number of states and algebraic variables together, and of states.
    rows, columns : (nnz,) arrays
        Places of the Jacobian's structural nonzeros.
    blocks : list of list of int
        See `diagonal_blocks`.
    algebraic_start : list of float
        Where algebraic variables are sought from.
    searched : bool
        Whether end stops are in contact: their gaps have to be closed before the search, which
        is done point by point.
    explicit : bool
        Whether the steady state follows without a search.
    """

    def __init__(
        self,
        graph: BondGraph,
        modes: dict[str, str],
        names: Sequence[str],
        guess: dict[str, float],
    ) -> None:
        self.modes = modes
        self.equations = equations = derive(in_mode(graph, modes))
        own = _own(equations, guess)
        self.smooth = Smooth(equations, graph, held=set(names))
        self.size = len(equations.states) + len(equations.algebraic)
        self.order = len(equations.states)
        self.algebraic_start = algebraic_guess(equations, own)
        self.searched = any(
            isinstance(self.smooth.element(name), EndStop) and mode == "contact"
            for name, mode in modes.items()
        )
        x, u, p = self._arguments()
        rates = self.smooth.symbolic(x, u, p)
        slopes = casadi.jacobian(rates, x)
        contacts = self.smooth.symbolic_contacts(x, u, p)
        rows, columns = slopes.sparsity().get_triplet()
        self.rows, self.columns = numpy.array(rows, dtype=int), numpy.array(columns, dtype=int)
        at = casadi.Function("at", [x, u, p], [rates, slopes, contacts])
        self._at = on_arrays(_shared(at))
        by_u = casadi.densify(casadi.jacobian(rates, u))
        self._by_u = on_arrays(_shared(casadi.Function("by_u", [x, u, p], [by_u])))
        program = None if self.searched else explicit_rest(equations)
        self.explicit = program is not None
        if program is not None:
            rest = self._on_vector(program)(u, p)
            found = casadi.Function("rest", [u, p], [rest, *at(rest, u, p)])
            self._rest = on_arrays(_shared(found))
        self.blocks = diagonal_blocks(self.rows, self.columns, self.size)
        self._start = on_arrays(self._on_vector(start_program(equations, own)))

    def _arguments(self) -> tuple[Any, Any, Any]:
        sizes = (self.size, len(self.equations.inputs), len(self.smooth.names))
        return tuple(casadi.SX.sym(letter, size) for letter, size in zip("xup", sizes, strict=True))

    def _on_vector(self, program: Program) -> casadi.Function:
        """Return a program in all parameters of the graph as a function of Smooth's vector."""
        _, u, p = self._arguments()
        place = {name: index for index, name in enumerate(self.smooth.names)}
        table = [symbol.name for symbol in self.equations.graph.parameters]
        full = [p[place[name]] if name in place else casadi.SX(numpy.nan) for name in table]
        found = to_casadi(program)(u, casadi.vertcat(*full))
        return casadi.Function(program.name, [u, p], [found])

    def start(self, u: Sequence[Row], p: Sequence[Row], m: int) -> Array:
        """Return the states that a search starts from, shape (n, m)."""
        return stacked(self._start(u, p)[0], m)

    def rest(self, u: Sequence[Row], p: Sequence[Row], m: int) -> Evaluated:
        """Return the steady states, where they are explicit."""
        x, rates, slopes, contacts = self._rest(u, p)
        return Evaluated(stacked(x, m), stacked(rates, m), slopes, contacts)

    def at(self, x: Array, u: Sequence[Row], p: Sequence[Row]) -> Evaluated:
        """Evaluate at states and algebraic variables, shape (k, m)."""
        rates, slopes, contacts = self._at(x, u, p)
        return Evaluated(x, stacked(rates, x.shape[1]), slopes, contacts)

    def settled(self, found: Evaluated) -> Array:
        """Whether points are at rest: rates are rounding noise beside the terms they are made of.

        As `balanced` of `newton`, nonzero by nonzero.
        """
        m = found.x.shape[1]
        finite = numpy.isfinite(found.x.sum(axis=0) + sum(found.slopes, numpy.zeros(m)))
        limits, sizes = numpy.zeros_like(found.rates), numpy.abs(found.x)
        first = int(numpy.argmax(finite))
        scale = balancing(self.dense(picked(found.slopes, [first]), 1)[0])
        steepest = numpy.zeros(m)
        with numpy.errstate(all="ignore"):
            for row, column, slope in zip(self.rows, self.columns, found.slopes, strict=True):
                steep = numpy.abs(slope)
                limits[row] += steep * sizes[column]
                steepest = numpy.maximum(steepest, steep * (scale[column] / scale[row]))
            limits *= ROUNDING
            limits += (
                FLOOR
                * steepest
                * (sizes / scale[:, None]).max(axis=0, initial=0.0)
                * scale[:, None]
            )
            return numpy.asarray(finite & (numpy.abs(found.rates) <= limits).all(axis=0))

    def by_inputs(self, x: Array, u: Sequence[Row], p: Sequence[Row]) -> Array:
        """Return the Jacobian of the rates by the inputs, shape (m, k, number of inputs)."""
        m, wide = x.shape[1], len(self.equations.inputs)
        entries = stacked(self._by_u(x, u, p)[0], m)
        return entries.reshape(wide, self.size, m).transpose(2, 1, 0)

    def dense(self, slopes: Sequence[Row], m: int) -> Array:
        """Return the Jacobian in full, shape (m, k, k)."""
        matrix = numpy.zeros((m, self.size, self.size))
        for row, column, value in zip(self.rows, self.columns, slopes, strict=True):
            matrix[:, row, column] = value
        return matrix


def _own(equations: Equations, guess: dict[str, float]) -> dict[str, float]:
    """Return the guesses that concern a mode's own variables."""
    known = {symbol.name for symbol in equations.states} | set(equations.outputs)
    known |= algebraic_names(equations)
    return {name: value for name, value in guess.items() if name in known}


def start_program(equations: Equations, guess: dict[str, float]) -> Program:
    """Write the states that a search starts from as a program in u and p.

    Parameters
    ----------
    equations : Equations
    guess : mapping of str to float
        Of states, or of outputs that fix one.

    Returns
    -------
    Program
    """
    found: list[sympy.Expr] = start_expressions(equations, guess)
    parameters = tuple(equations.graph.parameters)
    return Program.pruned("start", [("u", equations.inputs), ("p", parameters)], [], {"x": found})


def picked(rows: Sequence[Row], at: Any) -> list[Row]:
    """Return the values at some of the points; numbers are the same at all.

    Examples
    --------
    >>> picked([1.0, numpy.array([2.0, 3.0])], numpy.array([1]))
    [1.0, array([3.])]
    """
    return [row[at] if numpy.ndim(row) else row for row in rows]


def stacked(rows: Sequence[Row], m: int) -> Array:
    """Stack numbers and (m,) arrays as rows of an array.

    Examples
    --------
    >>> stacked([1.0, numpy.array([2.0, 3.0])], 2).tolist()
    [[1.0, 1.0], [2.0, 3.0]]
    """
    out = numpy.empty((len(rows), m))
    for place, row in enumerate(rows):
        out[place] = row
    return out


def _shared(function: casadi.Function) -> casadi.Function:
    """Return the function with what its results share worked out once."""
    arguments = [
        casadi.SX.sym(function.name_in(i), function.size1_in(i)) for i in range(function.n_in())
    ]
    results = casadi.cse(list(function.call(arguments)))
    return casadi.Function(function.name(), arguments, results)
