"""The edge of a basin along one direction: how hard a knock leaves a stable steady state."""

from __future__ import annotations

from collections.abc import Sequence

import numpy

from ..cycles import PeriodicOrbit
from ..errors import BondGraphError
from .bench import Bench
from .described import described, same
from .pushes import Push
from .rest import Rest
from .settle import Clock, Settled, settle
from .value import Attractor, BasinEdge

Array = numpy.ndarray

# Sizes begin at this part of one that means something and grow by a factor, or shrink by another
# where even the first leaves; the edge between is bisected to this share.
FIRST, GROWTH, SHRINK, SHARP = 0.2, 1.2, 5.0, 0.02
MOST_SIZES = 24
# A run so short, beside the fastest mode's time, tells the outputs at its start.
INSTANT = 1e-9


def edge_along(
    bench: Bench,
    rest: Rest,
    push: Push,
    found: Sequence[Attractor],
    known: Sequence[tuple[int, PeriodicOrbit]],
    clock: Clock,
    sizes: Array,
) -> BasinEdge | None:
    """Find the smallest push along a mode that does not return to the steady state.

    Sizes grow by a fifth from a fifth of the first that means something, until one leaves; between
    this and the one before, the edge is bisected. A narrow range that leaves may hide between two
    sizes that return.

    Parameters
    ----------
    bench : Bench
    rest : Rest
        Stable.
    push : Push
    found : sequence of Attractor
    known : sequence of (int, PeriodicOrbit)
    clock : Clock
    sizes : (n,) array
        Of the states.

    Returns
    -------
    BasinEdge or None
        None where the smallest push tried does not return, or the seconds ran out.
    """
    values = dict(rest.values)
    place = next(
        (i for i, old in enumerate(found) if old.kind == "steady" and old.modes == rest.modes), None
    )
    orbits = [orbit for _, orbit in known]
    tried = 0

    def leaves(size: float) -> Settled | None:
        """Return where a push went, None where it returned."""
        went = settle(bench, values, rest.at(push.change(size)), clock, sizes, orbits, bool(orbits))
        if went.kind == "steady" and went.rest is not None:
            item = described(bench, values, went, "")
            if place is not None and same(bench, found[place], item, sizes):
                return None
        return went

    low, high, size = 0.0, numpy.inf, FIRST * push.scale
    last: Settled | None = None
    for _ in range(MOST_SIZES):
        if clock.left <= 0:
            return None
        tried += 1
        try:
            went = leaves(size)
        except BondGraphError:  # a push through a stop: no state of the model
            break
        if went is None:
            low = size
        else:
            high, last = size, went
        if last is not None and low > 0:
            break
        size = size * GROWTH if last is None else size / SHRINK
    if low == 0:
        return None
    if last is None:
        return _edge(bench, rest, push, (low, high), None, tried)
    while high - low > SHARP * high and clock.left > 0:
        tried += 1
        middle = (low + high) / 2
        went = leaves(middle)
        if went is None:
            low = middle
        else:
            high, last = middle, went
    to = None
    if last.known is not None:
        to = known[last.known][0]
    else:
        item = described(bench, values, last, "")
        to = next((i for i, old in enumerate(found) if same(bench, old, item, sizes)), None)
    return _edge(bench, rest, push, (low, high), to, tried)


def _edge(
    bench: Bench, rest: Rest, push: Push, sizes: tuple[float, float], to: int | None, tried: int
) -> BasinEdge:
    low, high = sizes
    size = high if numpy.isfinite(high) else low
    x = rest.at(push.change(size))
    before, after = (_outputs(bench, rest, state) for state in (rest.vector, x))
    return BasinEdge(
        along=f"the {push.label} mode" if push.pole else push.label,
        returns=float(low),
        leaves=float(high),
        outputs={name: after[name] - before[name] for name in after},
        energy=_energy(bench, rest, x),
        to=to,
        tried=tried,
    )


def _outputs(bench: Bench, rest: Rest, x: Array) -> dict[str, float]:
    """Return outputs, or states where there are none, in the modes that a run begins in."""
    names = tuple(bench.model.equations.outputs)
    if not names:
        moving = zip(bench.names, x, bench.moving, strict=True)
        return {name: float(value) for name, value, moves in moving if moves}
    largest = float(numpy.abs(rest.poles).max(initial=0.0)) or 1.0
    run = bench.run(rest.values, x, (0.0, INSTANT / largest))
    return {name: float(run[name][0]) for name in names}


def _energy(bench: Bench, rest: Rest, x: Array) -> float | None:
    """Return the energy of a change of the states, as small motions store it, J."""
    scales = bench.scales(rest.values, rest.vector)
    change = x - rest.vector
    if ((scales == 0) & (change != 0) & bench.moving).any():
        return None
    part = change[scales > 0] / scales[scales > 0]
    return float(0.5 * (part**2).sum())
