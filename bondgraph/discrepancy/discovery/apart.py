"""Explanations that data cannot tell apart: what else to measure, and how to drive, so that they could."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy

from ...errors import BondGraphError
from ...simulation import Samples, simulate
from ..latent.isolability import carried
from .begin import states_of
from .bench import Bench, Trial
from .follow import sampled
from .laws import coefficients, law_of

Array = numpy.ndarray

SEEN = 0.01  # of a signal's range: what a plausible sensor still shows
HARDER = (1.5, 2.0, 3.0)  # times as strongly driven
OVER = 3.0  # times the noise, for a difference that shows
PARTED = 0.2  # of the larger of two laws
AS_FAR = 4.0  # times what was reached: no further is looked
GRID = 301
SECONDS = 5.0  # of one run
ALIKE = 1e-9


@dataclass(frozen=True)
class Apart:
    """How far explanations are apart in one signal, the nearest two of them.

    Attributes
    ----------
    signal : str
    difference : float
        Root mean square, in the signal's own unit.
    range : float
        Of the signal.
    """

    signal: str
    difference: float
    range: float

    @property
    def share(self) -> float:
        """Of the signal's range."""
        return self.difference / self.range if self.range > 0 else 0.0


def signals_apart(bench: Bench, members: Sequence[Trial]) -> list[Apart]:
    """Rank signals that are not measured by how far the members differ there.

    Parameters
    ----------
    bench : Bench
    members : sequence of Trial
        Fitted.

    Returns
    -------
    list of Apart
        Most different first; signals that follow a measured one exactly are left out.
    """
    measured = [name for row in bench.recordings for name in row.signals]
    names = _signals(bench, measured)
    runs = _runs(bench, members, [*measured, *names], 1.0)
    if len(runs) < 2:
        return []
    whole = {name: numpy.concatenate([run[name] for run in runs]) for name in runs[0]}
    known = [whole[name] for name in dict.fromkeys(measured)]
    fresh = [name for name in names if not any(_same(whole[name], other) for other in known)]
    return sorted((_apart(name, runs) for name in fresh), key=lambda item: -item.share)


def harder(bench: Bench, members: Sequence[Trial]) -> tuple[float, Apart] | None:
    """Find how much more strongly to drive, for measured signals to tell the members apart.

    Returns
    -------
    float
        Times the inputs, or the initial states where there are no inputs.
    Apart
        The signal that shows it best.

    None where three times do not do.
    """
    names = list(dict.fromkeys(name for row in bench.recordings for name in row.signals))
    noise = {
        name: max(row.noise[name] for row in bench.recordings if name in row.noise)
        for name in names
    }
    for factor in HARDER:
        runs = _runs(bench, members, names, factor)
        if len(runs) < 2:
            return None
        best = max(
            (_apart(name, runs) for name in names),
            key=lambda item: item.difference / noise[item.signal],
        )
        if best.difference > OVER * noise[best.signal]:
            return factor, best
    return None


def laws_part(members: Sequence[Trial], reach: Mapping[str, Mapping[str, float]]) -> str:
    """Say beyond which flow, displacement or effort the laws of two members part.

    Parameters
    ----------
    members : sequence of Trial
    reach : mapping of str to mapping of str to float
        By label of an effect: how far each variable of its site went.

    Returns
    -------
    str
        Empty where the laws are not functions of one and the same variable.
    """
    for one, other in itertools.combinations(members, 2):
        if len(one.added) != 1 or len(other.added) != 1:
            continue
        laws = [law_of(member.added[0].effect) for member in (one, other)]
        if laws[0] is None or laws[1] is None or laws[0][:2] != laws[1][:2]:
            continue
        across = laws[0][0]
        far = reach.get(one.added[0].label, {}).get(across, 0.0)
        if not far > 0:
            continue
        x = numpy.linspace(far, AS_FAR * far, GRID)
        values = [
            law[2](x, coefficients(member.added[0], member.grafts[0], member))
            for law, member in zip(laws, (one, other), strict=True)
            if law is not None
        ]
        off = numpy.abs(values[0] - values[1]) > PARTED * numpy.abs(values).max(axis=0)
        if off.any() and not off.all():
            return (
                f"a larger {across} would tell {one.label} from {other.label}: the recordings reach "
                f"{far:.3g}, beyond {x[int(off.argmax())]:.3g} their laws differ by more than "
                f"{PARTED:.0%}"
            )
    return ""


def _signals(bench: Bench, measured: Sequence[str]) -> list[str]:
    """Return outputs, displacements and what junctions carry, as far as not measured."""
    graph = bench.graph
    names = [*graph.outputs]
    names += [state.name for state in bench.model.equations.states if state.name.endswith(".q")]
    names += carried(graph)
    return [name for name in dict.fromkeys(names) if name not in measured]


def _runs(
    bench: Bench, members: Sequence[Trial], names: Sequence[str], factor: float
) -> list[dict[str, Array]]:
    """Return signals of all recordings in a row, by member that runs through all of them."""
    found = []
    for member in members:
        try:
            parts = [_run(bench, member, number, names, factor) for number in _rows(bench)]
        except BondGraphError:
            continue
        table = {name: numpy.concatenate([part[name] for part in parts]) for name in names}
        if all(numpy.isfinite(values).all() for values in table.values()):
            found.append(table)
    return found


def _rows(bench: Bench) -> range:
    return range(len(bench.recordings))


def _run(
    bench: Bench, member: Trial, number: int, names: Sequence[str], factor: float
) -> dict[str, Array]:
    recording, start = bench.recordings[number], member.measurements[number].initial
    t = recording.plain.t
    inputs = {
        name: _times(item, factor) if isinstance(item, Samples) else item
        for name, item in recording.item.inputs.items()
    }
    states = states_of(member.model)
    own = {name: value for name, value in start.items() if name in states}
    if not inputs:
        own = {name: factor * value for name, value in own.items()}
    run = simulate(
        member.model,
        (t[0], t[-1]),
        {**bench.given, **member.values},
        own,
        inputs,
        t_eval=t,
        time_budget=SECONDS,
    )
    return sampled(run, names, len(t))


def _times(samples: Samples, factor: float) -> Samples:
    return samples if factor == 1 else replace(samples, values=factor * samples.values)


def _apart(name: str, runs: Sequence[Mapping[str, Array]]) -> Apart:
    courses = [run[name] for run in runs]
    least = min(
        float(numpy.sqrt(numpy.mean((one - other) ** 2)))
        for one, other in itertools.combinations(courses, 2)
    )
    return Apart(name, least, float(max(map(numpy.ptp, courses))))


def _same(one: Array, other: Array) -> bool:
    """Whether one is a multiple of the other."""
    product = float(one @ other) ** 2
    return product >= (1 - ALIKE) * float(one @ one) * float(other @ other)
