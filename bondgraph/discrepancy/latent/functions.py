"""Rates, outputs, site signals and their derivatives, over many points at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi
import numpy
import sympy

from ...codegen.program import Program
from ...codegen.to_casadi import to_casadi
from ...equations import Equations
from ...errors import SimulationError
from ...graph import TIME
from .implicit import solved

Array = numpy.ndarray

AT_ONCE = 1024


@dataclass(frozen=True, eq=False)
class Points:
    """What a model does at many points.

    Attributes
    ----------
    rates : (nt, n) array
    outputs : (nt, ny) array
    rates_x, outputs_x : (nt, n, n) and (nt, ny, n) arrays
        Derivatives by the states.
    rates_p, outputs_p : (nt, n, q) and (nt, ny, q) arrays
        Derivatives by the parameters asked for.
    """

    rates: Array
    outputs: Array
    rates_x: Array
    outputs_x: Array
    rates_p: Array
    outputs_p: Array


class Functions:
    """Functions of a model over many points.

    Contacts slip: their direction is that of the slip, blurred near rest. Switches are open.
    Algebraic variables are solved for at each point.

    Parameters
    ----------
    equations : Equations
    outputs : sequence of str
        Of which derivatives are taken.
    wanted : sequence of str
        Parameters of the equations to take derivatives by.
    signals : mapping of str to Expr, optional
        Expressions in the graph's variables, to be evaluated as well.

    Raises
    ------
    SimulationError
        Where a parameter asked for is none of the equations'.
    """

    def __init__(
        self,
        equations: Equations,
        outputs: Sequence[str],
        wanted: Sequence[str],
        signals: Mapping[str, sympy.Expr] | None = None,
    ) -> None:
        self.equations = equations
        self.outputs, self.wanted = tuple(outputs), tuple(wanted)
        local = equations.own_symbols
        known = {name: expression.xreplace(local) for name, expression in (signals or {}).items()}
        self.signal_names = tuple(known)
        program = Program.pruned(
            "point",
            [
                ("t", [TIME]),
                ("x", equations.states),
                ("u", equations.inputs),
                ("p", equations.parameters),
                ("s", [contact.direction for contact in equations.contacts]),
                ("w", list(equations.switches.values())),
                ("z", equations.algebraic),
            ],
            equations.assignments,
            {
                "rates": equations.derivatives,
                "outputs": [equations.outputs[name] for name in outputs],
                "slip": [contact.slip for contact in equations.contacts],
                "signals": list(known.values()),
                "left": equations.residuals,
            },
        )
        plain = to_casadi(program)
        arguments = plain.sx_in()
        names = [symbol.name for symbol in equations.parameters]
        unknown = [name for name in wanted if name not in names]
        if unknown:
            raise SimulationError(f"{', '.join(unknown)}: no parameters of these equations")
        chosen = [names.index(name) for name in wanted]
        rates, found, slip, said, left = plain(*arguments)
        pushed = casadi.SX.sym("du", len(equations.inputs))
        _, x, u, p, _, _, z = arguments
        inner = casadi.densify(casadi.jacobian(left, z))

        def total(result: casadi.SX, by: casadi.SX) -> casadi.SX:
            """Jacobian of a result, what the algebraic variables do included."""
            direct = casadi.jacobian(result, by)
            if not z.numel():
                return casadi.densify(direct)
            follows = casadi.solve(inner, casadi.densify(casadi.jacobian(left, by)))
            return casadi.densify(direct - casadi.jacobian(result, z) @ follows)

        both = casadi.vertcat(rates, found)
        slopes = [total(both, x), total(both, p)[:, chosen]]
        rising = total(said, x) @ rates + total(said, u) @ pushed
        terms = casadi.fabs(inner) @ casadi.fabs(z) + casadi.fabs(left)
        self._point = casadi.Function("point", arguments, [rates, found, *slopes])
        self._slips = casadi.Function("slips", arguments, [slip])
        self._signals = casadi.Function("signals", [*arguments, pushed], [said, rising])
        self._loop = casadi.Function("loop", arguments, [left, inner, terms])

    def at(self, t: Array, x: Array, u: Array, p: Array) -> Points:
        """Evaluate rates, outputs and their derivatives.

        Parameters
        ----------
        t : (nt,) array
        x : (nt, n) array
        u : (nt, m) array
        p : (np,) array
            All parameters of the equations, in their order.
        """
        n, ny, q = x.shape[1], len(self.outputs), len(self.wanted)
        s = self._directions(t, x, u, p)
        rates, outputs, by_x, by_p = self._mapped(self._point, t, x, u, p, s)
        by_x, by_p = by_x.reshape(len(t), n, n + ny), by_p.reshape(len(t), q, n + ny)
        by_x, by_p = by_x.transpose(0, 2, 1), by_p.transpose(0, 2, 1)
        return Points(rates, outputs, by_x[:, :n], by_x[:, n:], by_p[:, :n], by_p[:, n:])

    def signals(self, t: Array, x: Array, u: Array, p: Array) -> tuple[Array, Array]:
        """Return the named signals and their rates by the model, each (nt, number of signals).

        Rates of a smoothed course would carry the model's own error, which a regression of that
        error must not contain.
        """
        s = self._directions(t, x, u, p)
        pushed = numpy.gradient(u, t, axis=0) if len(t) > 1 else numpy.zeros_like(u)
        said, rising = self._mapped(self._signals, t, x, u, p, s, pushed)
        return said, rising

    def slips(self, t: Array, x: Array, u: Array, p: Array) -> Array:
        """Return the slip of each contact, shape (nt, k)."""
        s = numpy.ones((len(t), len(self.equations.contacts)))
        return self._mapped(self._slips, t, x, u, p, s)[0]

    def _directions(self, t: Array, x: Array, u: Array, p: Array) -> Array:
        if not self.equations.contacts:
            return numpy.zeros((len(t), 0))
        slip = self.slips(t, x, u, p)
        size = numpy.quantile(numpy.abs(slip), 0.95, axis=0)
        return numpy.asarray(numpy.tanh(slip / numpy.maximum(0.01 * size, 1e-300)))

    def _mapped(
        self,
        function: casadi.Function,
        t: Array,
        x: Array,
        u: Array,
        p: Array,
        s: Array,
        *more: Array,
    ) -> list[Array]:
        """Evaluate point by point; each result has the points first."""
        z = self._algebraic(t, x, u, p, s)
        return self._evaluated(function, [*self._given(t, x, u, s), z, *more], p)

    def _given(self, t: Array, x: Array, u: Array, s: Array) -> list[Array | None]:
        """Return the arguments of a point but for the algebraic variables; None for parameters."""
        return [t[:, None], x, u, None, s, numpy.zeros((len(t), len(self.equations.switches)))]

    def _algebraic(self, t: Array, x: Array, u: Array, p: Array, s: Array) -> Array:
        """Return the algebraic variables at each point, shape (nt, number of them)."""
        size = len(self.equations.algebraic)
        if not size:
            return numpy.zeros((len(t), 0))
        given = self._given(t, x, u, s)

        def many(points: Array, z: Array) -> tuple[Array, Array, Array]:
            rows = [row if row is None else row[points] for row in given]
            left, slope, terms = self._evaluated(self._loop, [*rows, z], p)
            slope = slope.reshape(len(points), size, size).transpose(0, 2, 1)
            return left, slope, terms

        return solved(many, len(t), size)

    def _evaluated(
        self, function: casadi.Function, rows: Sequence[Array | None], p: Array
    ) -> list[Array]:
        """Evaluate point by point; each result has the points first."""
        total = len(rows[0]) if rows[0] is not None else 0
        parts: list[list[Array]] = [[] for _ in range(function.n_out())]
        count = min(AT_ONCE, total)
        many = function.map(count)
        constant = casadi.repmat(casadi.DM(p), 1, count)
        for start in range(0, total, count):
            begin = min(start, total - count)
            given = [
                constant if row is None else casadi.DM(row[begin : begin + count].T) for row in rows
            ]
            fresh = start - begin
            for part, found in zip(parts, many.call(given), strict=True):
                wide = numpy.asarray(found.full())
                width = wide.shape[1] // count
                columns = wide.T.reshape(count, width * wide.shape[0])
                part.append(columns[fresh:])
        return [numpy.concatenate(part) for part in parts]
