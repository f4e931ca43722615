"""Plain matrices of a transfer: what zeros, gains and responses are computed from.

Where a dependent storage follows an input, the equations need the input's rate.
The rate is then no input of its own here: states are shifted by the input, so
that ``y = C (s I - A)^-1 B u + (D0 + D1 s + ...) u``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy

from ..elements import Se, Sf
from ..errors import BondGraphError
from ..graph import BondGraph
from ..parameters import unknown_name

if TYPE_CHECKING:
    from .transfers import Transfers

Array = numpy.ndarray
EPS = float(numpy.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class Realisation:
    """Matrices of ``C (s I - A)^-1 B + D0 + D1 s + ...``.

    Attributes
    ----------
    A : (n, n) array
    B : (n, m) array
    C : (k, n) array
    direct : tuple of (k, m) array
        ``D0, D1, ...``, by power of s; the last is not zero unless it is the only one.

    Examples
    --------
    >>> lag = Realisation(*(numpy.array([[x]]) for x in (-2.0, 1.0, 6.0)), (numpy.zeros((1, 1)),))
    >>> lag.at(numpy.array([0.0]))[:, 0, 0].real.tolist()
    [3.0]
    """

    A: Array
    B: Array
    C: Array
    direct: tuple[Array, ...]

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.A)

    def channel(self, output: int, input: int) -> Realisation:
        """Return the part from one input to one output."""
        direct = [part[[output]][:, [input]] for part in self.direct]
        return Realisation(self.A, self.B[:, [input]], self.C[[output]], _trimmed(direct))

    def at(self, s: Array) -> Array:
        """Evaluate at complex frequencies.

        Parameters
        ----------
        s : (w,) complex array

        Returns
        -------
        (w, k, m) complex array
            Infinite where s is a pole.
        """
        points = numpy.asarray(s, dtype=complex)
        found = sum(part * points[:, None, None] ** power for power, part in enumerate(self.direct))
        if not self.order:
            return numpy.broadcast_to(found, (len(points), *self.direct[0].shape)).astype(complex)
        matrices = points[:, None, None] * numpy.eye(self.order) - self.A
        try:
            moved = numpy.linalg.solve(
                matrices, numpy.broadcast_to(self.B, (len(points), *self.B.shape))
            )
        except numpy.linalg.LinAlgError:
            if len(points) == 1:
                return self._at_pole(points[0])[None]
            return numpy.concatenate([self.at(points[[place]]) for place in range(len(points))])
        return found + self.C @ moved

    def _at_pole(self, s: complex) -> Array:
        """Evaluate where s is a pole: infinite, but for channels that do not see it."""
        from .transfer import transfer_of

        rows, columns = self.direct[0].shape
        found = numpy.empty((rows, columns), dtype=complex)
        for row, column in numpy.ndindex(rows, columns):
            found[row, column] = transfer_of(self.channel(row, column), "", "", "")(s)
        return found

    def filtered(self, rate: float) -> Realisation:
        """Return the same behind low-pass filters ``1 / (s + rate)^r`` that make it proper.

        The filters have no zeros: the zeros stay what they are.
        """
        power = len(self.direct) - 1
        if not power:
            return self
        inputs = self.B.shape[1]
        # of one input: its value and rates up to that of order r - 1, in a chain
        last = -numpy.poly(numpy.full(power, -rate))[:0:-1]
        chain = numpy.vstack([numpy.eye(power)[1:], last])
        one = numpy.eye(inputs)
        a = numpy.block(
            [
                [self.A, numpy.kron(numpy.eye(1, power), self.B)],
                [numpy.zeros((power * inputs, self.order)), numpy.kron(chain, one)],
            ]
        )
        b = numpy.vstack(
            [numpy.zeros((self.order, inputs)), numpy.kron(numpy.eye(power)[:, [-1]], one)]
        )
        through = sum(
            part @ numpy.kron(row[None], one)
            for part, row in zip(self.direct, numpy.vstack([numpy.eye(power), last]), strict=True)
        )
        return Realisation(a, b, numpy.hstack([self.C, through]), (self.direct[-1],))

    def scaled(self) -> Scaled:
        """Return a realisation whose entries are of like size.

        States, inputs, outputs and time are measured in units of their own, powers of
        two. Ranks are decided there, and nothing is rounded on the way.
        """
        n, inputs = self.B.shape
        pencil = numpy.block([[self.A, self.B], [self.C, self.direct[0]]])
        rate = 1.0
        into, out = numpy.ones(inputs), numpy.ones(len(self.C))
        for _ in range(20):
            before = pencil.copy()
            for place in range(n):
                row, column = _off(pencil[place], place), _off(pencil[:, place], place)
                if row > 0 and column > 0:
                    factor = _power_of_two(numpy.sqrt(row / column))
                    pencil[place] /= factor
                    pencil[:, place] *= factor
            step = _power_of_two(numpy.abs(pencil[:n, :n]).max(initial=0.0))
            pencil[:n] /= step
            rate *= step
            for place in range(inputs):
                factor = _power_of_two(numpy.linalg.norm(pencil[:, n + place]))
                pencil[:, n + place] /= factor
                into[place] /= factor
            for place in range(len(self.C)):
                factor = _power_of_two(numpy.linalg.norm(pencil[n + place]))
                pencil[n + place] /= factor
                out[place] /= factor
            if numpy.array_equal(pencil, before):
                break
        parts = tuple(
            out[:, None] * part * into * rate**power for power, part in enumerate(self.direct)
        )
        return Scaled(
            Realisation(pencil[:n, :n], pencil[:n, n:], pencil[n:, :n], parts), rate, into, out
        )


@dataclass(frozen=True, eq=False)
class Scaled:
    """A realisation in units of its own.

    Attributes
    ----------
    plant : Realisation
        ``plant(s / rate) = out original(s) into``.
    rate : float
        Unit of s, 1/s.
    into : (m,) array
    out : (k,) array
    """

    plant: Realisation
    rate: float
    into: Array
    out: Array


def realisation(system: Transfers) -> Realisation:
    """Return a linear system without rates of inputs as inputs of their own.

    Parameters
    ----------
    system : LinearSystem

    Returns
    -------
    Realisation
        Columns are ordered as ``system.sources``.
    """
    places = [[system.inputs.index(name) for name in chain] for chain in _chains(system)]
    most = max((len(chain) for chain in places), default=1)
    shape = (len(system.states), len(places)), (len(system.outputs), len(places))
    driven = [numpy.zeros(shape[0]) for _ in range(most)]
    direct = [numpy.zeros(shape[1]) for _ in range(most)]
    for column, chain in enumerate(places):
        for power, place in enumerate(chain):
            driven[power][:, column] = system.B[:, place]
            direct[power][:, column] = system.D[:, place]
    # (s I - A)^-1 s = I + (s I - A)^-1 A, from the highest power down
    for power in range(most - 1, 0, -1):
        direct[power - 1] = direct[power - 1] + system.C @ driven[power]
        driven[power - 1] = driven[power - 1] + system.A @ driven[power]
    return Realisation(system.A, driven[0], system.C, _trimmed(direct))


def check_channels(system: Transfers) -> None:
    """Refuse a system without inputs or without outputs, for what leads from one to the other.

    Raises
    ------
    BondGraphError
    """
    model = system.at.equations.name
    if not system.sources:
        some = _parameter_of_a_source(system.at.equations.graph)
        raise BondGraphError(
            f"model {model!r} has no inputs: all its sources are constant; declare one, as "
            f"assemble(..., inputs={{u: 'N'}}) with Se('push', u)"
            + (f", or take a parameter, as system.with_inputs({some!r})" if some else "")
        )
    if not system.outputs:
        some = next(iter(system.states), "mass.f")
        raise BondGraphError(
            f"model {model!r} has no outputs; declare them, as assemble(..., outputs={{'x': spring.q}}), "
            f"or take states and port variables, as system.with_outputs({some!r})"
        )


def _parameter_of_a_source(graph: BondGraph) -> str:
    """Return a parameter that a source rests on, else any; empty where there is none."""
    used = [
        symbol.name
        for _, source in graph.of((Se, Sf))
        for law in source.laws.values()
        for symbol in sorted(law.free_symbols & graph.parameters.keys(), key=str)
    ]
    return next(iter([*used, *(symbol.name for symbol in graph.parameters)]), "")


def place_of(kind: str, given: object, known: tuple[str, ...], other: tuple[str, ...]) -> int:
    """Return where a name stands among the inputs or outputs.

    Raises
    ------
    ParameterError
        For a name that is not known.
    """
    name = str(getattr(given, "name", given))
    if name in known:
        return known.index(name)
    error = unknown_name(kind, name, known)
    if name in other:
        raise type(error)(f"{error} The output comes first, then the input.", elements=[name])
    raise error


def _chains(system: Transfers) -> list[list[str]]:
    """Return each input that is no rate, followed by its rates."""
    rates = {symbol.name: rate.name for symbol, rate in system.at.equations.input_rates.items()}
    chains = []
    for name in system.sources:
        chain = [name]
        while chain[-1] in rates:
            chain.append(rates[chain[-1]])
        chains.append(chain)
    return chains


def _trimmed(direct: list[Array]) -> tuple[Array, ...]:
    """Leave out the highest powers whose parts are zero, keeping the first."""
    parts = list(direct)
    while len(parts) > 1 and not parts[-1].any():
        parts.pop()
    return tuple(parts)


def _off(values: Array, place: int) -> float:
    """Return the norm of all but one entry."""
    return float(numpy.linalg.norm(numpy.delete(values, place)))


def _power_of_two(value: float | numpy.floating[Any]) -> float:
    return float(2.0 ** numpy.round(numpy.log2(value))) if value > 0 else 1.0
