"""Points of rest: steady states with the modes of small motions about them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy

from ..errors import BondGraphError, SteadyStateError
from ..linear import growths
from ..steady import MAX_MODE_CHANGES, find_rest, first_modes
from ..values import algebraic_guess
from .bench import Bench, Chart

Array = numpy.ndarray

# Beside the largest eigenvalue: a smaller one belongs to a state that is free to stand anywhere.
FREE = 1e-9
# A state with less than this part, squared, of the energy that the others have is rounding.
LITTLE = 1e-6


@dataclass(frozen=True, eq=False)
class Rest:
    """A steady state, and small motions about it.

    Attributes
    ----------
    modes : dict of str to str
        Of the contacts.
    states : dict of str to float
        All states of the model.
    outputs : dict of str to float
    isolated : bool
        False where a state is free to stand anywhere near by.
    poles : (k,) complex array
        Eigenvalues of what is not free.
    shapes, left : (n, k) complex arrays
        Right and left eigenvectors in the chart's states; ``left[:, i] @ shapes[:, i]`` is one.
    chart : Chart
    x : (n + nz,) array
        In the chart's states, and algebraic variables.
    u, p : arrays
    values : dict of str to float
        Parameters.
    """

    modes: dict[str, str]
    states: dict[str, float]
    outputs: dict[str, float]
    isolated: bool
    poles: Array
    shapes: Array = field(repr=False)
    left: Array = field(repr=False)
    chart: Chart = field(repr=False)
    x: Array = field(repr=False)
    u: Array = field(repr=False)
    p: Array = field(repr=False)
    values: Mapping[str, float] = field(repr=False)

    @property
    def vector(self) -> Array:
        """All states of the model, (n,) array."""
        return numpy.array(list(self.states.values()))

    @property
    def growth(self) -> int:
        """1 where a mode grows, 0 where the slowest neither grows nor decays, else -1.

        Zero eigenvalues of states that are free to stand anywhere do not count.
        """
        poles = self.poles
        if not poles.size:
            return -1
        still = numpy.abs(poles) > FREE * numpy.abs(poles).max()
        return int(growths(poles)[still].max(initial=-1))

    @property
    def stable(self) -> bool:
        """Whether all small motions decay."""
        return self.growth < 0

    def at(self, change: Array) -> Array:
        """Return all states of the model where the chart's own change by so much, (n,) array."""
        order = len(self.chart.states)
        x = numpy.array(self.x)
        x[:order] += change
        if len(x) > order:
            solved = self.chart.smooth.consistent(x[:order], self.u, self.p, x[order:])
            if solved is None:
                raise SteadyStateError(
                    "no values of the algebraic variables fulfil their equations"
                )
            x = solved
        return self.chart.whole(x, self.u, self.values)


def rest_of(
    bench: Bench,
    values: Mapping[str, float],
    x: Array | None = None,
    modes: Mapping[str, str] | None = None,
) -> Rest:
    """Find a steady state, as `bondgraph.steady_state` does; states that drive nothing may drift.

    Parameters
    ----------
    bench : Bench
    values : mapping of str to float
        All parameters.
    x : (n,) array, optional
        States to search from; the model's own start unless given.
    modes : mapping of str to str, optional
        Of the contacts, to search from; those of the start unless given.

    Returns
    -------
    Rest

    Raises
    ------
    SteadyStateError
    """
    guess = None if x is None else dict(zip(bench.names, map(float, x), strict=True))
    if modes is None:
        modes = first_modes(bench.graph, values, guess, {})
    current, tried = dict(modes), set()
    for _ in range(MAX_MODE_CHANGES):
        key = tuple(sorted(current.items()))
        if key in tried:
            break
        tried.add(key)
        chart = bench.chart(current, values)
        u = numpy.array([bench.inputs.get(s.name, 0.0) for s in chart.equations.inputs])
        p = chart.smooth.vector(values)
        start = bench.start(values, guess) if guess else bench.start(values)
        named = dict(zip(bench.names, start, strict=True))
        first = [named[name] for name in chart.states]
        found, _ = find_rest(chart.smooth, current, (first, algebraic_guess(chart.equations)), u, p)
        contacts = chart.smooth.contact_values(found, u, p)
        wrong = {
            name: better
            for name, contact in contacts.items()
            if (better := contact.better_mode(current[name])) is not None
        }
        if not wrong:
            return _described(bench, chart, found, (u, p, values))
        current |= wrong
    raise SteadyStateError(
        f"model {bench.graph.name!r} has no steady state that agrees with its contacts' modes near the "
        f"start",
        elements=list(current),
    )


def maybe_rest(*arguments: Any, **options: Any) -> tuple[Rest | None, str]:
    """Return a steady state, or None and the reason why there is none."""
    try:
        with numpy.errstate(all="ignore"):  # what overflows on the way is no steady state
            return rest_of(*arguments, **options), ""
    except BondGraphError as error:
        return None, str(error)


def _described(bench: Bench, chart: Chart, x: Array, given: tuple[Array, Array, Any]) -> Rest:
    u, p, values = given
    whole = chart.whole(x, u, values)
    poles, shapes, left = _small_motions(chart, x, u, p)
    largest = numpy.abs(poles).max(initial=0.0)
    return Rest(
        modes=dict(chart.modes),
        states=dict(zip(bench.names, map(float, whole), strict=True)),
        outputs=chart.smooth.outputs(x, u, p),
        isolated=bool((numpy.abs(poles) > FREE * largest).all()),
        poles=poles,
        shapes=shapes,
        left=left,
        chart=chart,
        x=x,
        u=u,
        p=p,
        values=dict(values),
    )


def _small_motions(chart: Chart, x: Array, u: Array, p: Array) -> tuple[Array, Array, Array]:
    """Return poles and eigenvectors of the states that drive something."""
    matrix = chart.smooth.matrices(x, u, p)[0]
    inner = matrix[numpy.ix_(chart.moving, chart.moving)]
    size = (len(chart.states), len(inner))
    shapes, rows = numpy.zeros(size, dtype=complex), numpy.zeros(size, dtype=complex)
    if not len(inner):
        return numpy.zeros(0, dtype=complex), shapes, rows
    import scipy.linalg

    scaled, transform = scipy.linalg.matrix_balance(inner, permute=False)
    poles, left, right = scipy.linalg.eig(scaled, left=True, right=True)
    scale = numpy.diag(transform)[:, None]
    order = numpy.lexsort((-poles.imag, -poles.real.round(9)))
    right, left = (right * scale)[:, order], (left.conj() / scale)[:, order]
    norms = (left * right).sum(axis=0)
    # two equal eigenvalues may share one eigenvector, and then have no left one of size one
    left = left / numpy.where(numpy.abs(norms) > 1e-12, norms, 1.0)
    shapes[chart.moving], rows[chart.moving] = right, left
    return poles[order], shapes, rows


def sizes_of(bench: Bench, values: Mapping[str, float], points: Array) -> Array:
    """Return how large each state is at points: the largest there, or what little energy makes it.

    Parameters
    ----------
    bench : Bench
    values : mapping of str to float
        All parameters.
    points : (k, n) array

    Returns
    -------
    (n,) array
    """
    largest = numpy.abs(points).max(axis=0, initial=0.0)
    scales = bench.scales(values, points[-1])
    known = scales > 0
    energies = numpy.zeros(len(largest))
    energies[known] = (largest[known] / scales[known]) ** 2
    return numpy.maximum(largest, LITTLE * scales * numpy.sqrt(energies.sum()))
