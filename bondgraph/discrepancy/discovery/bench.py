"""What trials are made of: effects to be grown in, what all share, drafts and fits."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ...graph import BondGraph
from ...simulation import CompiledModel
from ..candidates import Effect
from ..fitting import Fit
from ..grafting import Grafted, Site
from ..latent.relax import LOOSE
from ..measurement import Measurement
from .prepare import Prepared, floor

NEAR = 1.03  # times its noise, a gap is noise


@dataclass(frozen=True, eq=False)
class Added:
    """One effect to be grown into a graph, and where its coefficients start.

    Attributes
    ----------
    effect : Effect
    site : Site
    starts : mapping of str to float
    pair : tuple of str
        The two junctions between which the site is, where it is such a place.
    """

    effect: Effect
    site: Site
    starts: Mapping[str, float]
    pair: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """``effect at site``."""
        return f"{self.effect.name} at {self.site.name}"


def label_of(added: Iterable[Added]) -> str:
    """Return effects and sites, in one order."""
    return " + ".join(sorted(item.label for item in added))


@dataclass(frozen=True, eq=False)
class Grown:
    """A graph into which effects are grown.

    Attributes
    ----------
    added : tuple of Added
    grafts : tuple of Grafted
    graph : BondGraph
    model : CompiledModel
    """

    added: tuple[Added, ...]
    grafts: tuple[Grafted, ...]
    graph: BondGraph
    model: CompiledModel

    @property
    def label(self) -> str:
        """Effects and sites, in one order."""
        return label_of(self.added)

    @property
    def terms(self) -> int:
        """Coefficients that the effects brought, of those that data tell."""
        return sum(len(item.effect.fitted) for item in self.added)


@dataclass(frozen=True, eq=False)
class Trial(Grown):
    """A graph with effects, fitted.

    Attributes
    ----------
    fit : Fit
    measurements : tuple of Measurement
        With the start states found.
    squares, counts, effective : mapping of str to number
        By signal: sum of squared residuals, samples, and how many independent ones they are worth.
    given : mapping of str to float
        Own parameters before the fit.
    begins : int
        Start states of the effects that were sought, in all recordings.
    """

    fit: Fit
    measurements: tuple[Measurement, ...]
    squares: Mapping[str, float]
    counts: Mapping[str, int]
    effective: Mapping[str, float]
    given: Mapping[str, float]
    begins: int = 0

    @property
    def terms(self) -> int:
        """Coefficients that the effects brought, and start states that were sought with them."""
        return super().terms + self.begins

    @property
    def strain(self) -> float:
        """How far own parameters are from what was given, in squares of what is likely.

        An element may turn out not to be there at all: zero is not infinitely far.
        """
        total = 0.0
        for name, given in self.given.items():
            if name in self.fit.values and given:
                ratio = self.fit.values[name] / given
                off = abs(ratio - 1)
                total += (min(off, abs(math.log(ratio))) if ratio > 0 else off) ** 2
        return total / LOOSE**2

    def rmse(self, signal: str) -> float:
        """Return the root mean square of what is left of a signal."""
        return float((self.squares[signal] / self.counts[signal]) ** 0.5)

    @property
    def values(self) -> dict[str, float]:
        """All fitted parameters, SI."""
        return dict(self.fit.values)


def idle(trial: Trial) -> dict[str, str]:
    """Return effects whose size the data do not tell from zero, by label, and that in words."""
    found = {}
    for item, grafted in zip(trial.added, trial.grafts, strict=True):
        for key in item.effect.linear[:1]:
            name = grafted.parameters[key]
            value = trial.values.get(name, math.nan)
            std = trial.fit.std.get(name, math.inf)
            if not std < abs(value):
                found[item.label] = f"{key} of {item.label} is uncertain: {value:.3g} +- {std:.2g}"
    return found


@dataclass(frozen=True, eq=False)
class Bench:
    """What all trials share.

    Attributes
    ----------
    graph : BondGraph
    model : CompiledModel
        Of the graph.
    recordings : tuple of Prepared
    free : tuple of str
        Own parameters.
    states : tuple of str
        Whose start is sought.
    given : mapping of str to float
        Parameters as they are given, SI.
    deadline : float
        Of `time.monotonic`.
    starts : tuple of mapping of str to float
        Where the smoother says that each recording begins.
    ways : mapping of (str, str) to float
        In which the model may err, see `bondgraph.discrepancy.latent.eased`.
    seconds : float
        Limit of one fit.
    """

    graph: BondGraph
    model: CompiledModel
    recordings: tuple[Prepared, ...]
    free: tuple[str, ...]
    states: tuple[str, ...]
    given: Mapping[str, float]
    deadline: float
    starts: tuple[Mapping[str, float], ...] = field(default=())
    ways: Mapping[tuple[str, str], float] = field(default_factory=dict)
    seconds: float = math.inf

    @property
    def left(self) -> float:
        """Seconds."""
        return max(self.deadline - time.monotonic(), 1.0)

    @property
    def late(self) -> bool:
        """Whether no more is to be begun."""
        return time.monotonic() > self.deadline


@dataclass(frozen=True, eq=False)
class Draft(Grown):
    """Effects grown into the graph, and where a fit may start.

    Attributes
    ----------
    starts : tuple of mapping of str to float
        Parameters, the best guess first.
    begins : tuple of mapping of str to float
        Start states by recording.
    likelihood : float
        Twice the negative logarithm where the model hardly errs, to compare drafts by; infinite
        where that did not come to an end.
    off : float
        How far the run from the best start is from the data, see `misfit`.
    """

    starts: tuple[Mapping[str, float], ...]
    begins: tuple[Mapping[str, float], ...]
    likelihood: float = math.inf
    off: float = math.inf


def near_noise(trial: Trial, bench: Bench, times: float = NEAR) -> bool:
    """Whether all that is left of every signal is noise, or so many times it."""
    for name in trial.squares:
        sure = all(row.told.get(name, False) for row in bench.recordings if name in row.noise)
        if not sure or trial.rmse(name) > times * floor(bench.recordings, name):
            return False
    return True


def kept(current: Trial, added: Sequence[Added]) -> tuple[Added, ...]:
    """Return effects with those that are in the graph already starting from their fitted values."""
    values = {}
    for item, grafted in zip(current.added, current.grafts, strict=True):
        values[item.label] = {
            key: current.values.get(name, item.starts[key])
            for key, name in grafted.parameters.items()
        }
    return tuple(
        replace(item, starts=values[item.label]) if item.label in values else item for item in added
    )
