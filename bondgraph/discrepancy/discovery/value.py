"""Discovery: what comes out, as frozen values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy

from ...graph import BondGraph
from ..fitting import Fit
from ..measurement import Measurement
from .verdict import Verdict

Array = numpy.ndarray


@dataclass(frozen=True)
class Estimate:
    """A parameter as the data tell it.

    Attributes
    ----------
    value, std : float
        SI; the standard deviation is infinite where the data do not tell.
    unit : str
    """

    value: float
    std: float
    unit: str = ""


@dataclass(frozen=True)
class NamedEffect:
    """An effect at its place.

    Attributes
    ----------
    name : str
        As in the table of effects.
    element : str
        Qualified name of the element that it is in the improved graph.
    site : str
        Name of the site, such as ``carriage``, ``between a and b`` or ``output v``.
    between : (str, str) or None
        The two junctions of a pair.
    parameters : mapping of str to Estimate
        By coefficient.
    delta_bic : float
        What the Bayesian information criterion loses by it, with the effective number of samples.
    words : str
        What it is, in a few words.
    """

    name: str
    element: str
    site: str
    between: tuple[str, str] | None
    parameters: Mapping[str, Estimate]
    delta_bic: float
    words: str = ""

    @property
    def label(self) -> str:
        """``effect at site``."""
        return f"{self.name} at {self.site}"


@dataclass(frozen=True)
class Gap:
    """How far a model is from one signal, root mean square over all recordings of a kind.

    Attributes
    ----------
    nominal : float
        Of the model as it was given; NaN where it does not run.
    before : float
        Of the model with its own parameters fitted.
    after : float
        With the effects that were found, fitted too.
    noise_floor : float
    unit : str
    """

    nominal: float
    before: float
    after: float
    noise_floor: float
    unit: str = ""

    @property
    def removed(self) -> float:
        """Share of what lies above the noise floor that is gone; NaN where nothing lies above."""
        before = max(self.before**2 - self.noise_floor**2, 0.0) ** 0.5
        after = max(self.after**2 - self.noise_floor**2, 0.0) ** 0.5
        return 1 - after / before if before > 0 else float("nan")


@dataclass(frozen=True, eq=False)
class Course:
    """One recording beside the model before and after.

    Attributes
    ----------
    name : str
    t : (nt,) array, s
    measured, before, after : mapping of str to (nt,) array
        By signal, SI; NaN marks gaps and times a run did not reach.
    noise : mapping of str to float
        Standard deviation by signal.
    units : mapping of str to str
    """

    name: str
    t: Array
    measured: Mapping[str, Array]
    before: Mapping[str, Array]
    after: Mapping[str, Array]
    noise: Mapping[str, float]
    units: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class LearnedLaw:
    """What an effect does, over the data that say so.

    Attributes
    ----------
    effect : str
        Its label.
    across, along : str
        What the axes show, such as ``flow of carriage`` and ``effort``.
    units : (str, str)
        Of across and along.
    x, y, std : (n,) arrays
        The law and one standard deviation about it.
    points : (m, 2) array
        What the data alone say, without the law.
    """

    effect: str
    across: str
    along: str
    units: tuple[str, str]
    x: Array
    y: Array
    std: Array
    points: Array


@dataclass(frozen=True, eq=False)
class Explanation:
    """Effects that were grown into the graph and fitted together.

    Attributes
    ----------
    effects : tuple of NamedEffect
        None of them for the model by itself.
    graph : BondGraph
        With the effects.
    fit : Fit
        Of the model's own parameters and the effects'.
    delta_bic : float
        Gain over the model by itself.
    removed : float
        Share of the held-out gap above the noise floor that is gone.
    failed : tuple of str
        Why it may not be named, in words; empty where it may.
    diff : tuple of str
        What was changed in the graph.
    """

    effects: tuple[NamedEffect, ...]
    graph: BondGraph
    fit: Fit
    delta_bic: float
    removed: float
    failed: tuple[str, ...] = ()
    diff: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """Effects and sites, joined by ``+``."""
        return " + ".join(effect.label for effect in self.effects) or "nothing missing"


@dataclass(frozen=True, eq=False)
class Discovery:
    """What a model lacks, as recordings tell it.

    Attributes
    ----------
    graph : BondGraph
        The model as it was given.
    verdict : Verdict
    effects : tuple of NamedEffect
        What is named; of an ambiguous verdict, the members of the class; of ``unnamed`` the nearest.
    alternatives : tuple of NamedEffect
        Others that were fitted, best first.
    gap : mapping of str to mapping of str to Gap
        ``train`` and ``validation``, by signal.
    improved : BondGraph or None
        The graph with the effects grown in, and fitted values in its table; None where nothing was named.
    parameters : mapping of str to Estimate
        The model's own, fitted together with the effects.
    nominal : mapping of str to float
        The same as they were given.
    ranked : tuple of Explanation
        All that was fitted, the model by itself among them, best first.
    chosen : Explanation
        What the courses show as ``after``.
    train, validation : tuple of Course
    laws : tuple of LearnedLaw
    words : tuple of str
        The verdict in two sentences.
    unseen : tuple of str
        What the data cannot tell.
    advice : tuple of str
        What to measure next.
    alike : tuple of tuple of str
        Effects at sites that these data cannot tell apart, to first order, were one of them missing.
    warnings : tuple of str
    recordings, held_out : tuple of Measurement
        What was used to learn, and to test.
    seconds : float
    """

    graph: BondGraph
    verdict: Verdict
    effects: tuple[NamedEffect, ...]
    alternatives: tuple[NamedEffect, ...]
    gap: Mapping[str, Mapping[str, Gap]]
    improved: BondGraph | None
    parameters: Mapping[str, Estimate]
    nominal: Mapping[str, float]
    ranked: tuple[Explanation, ...]
    chosen: Explanation
    train: tuple[Course, ...]
    validation: tuple[Course, ...]
    laws: tuple[LearnedLaw, ...]
    words: tuple[str, ...]
    unseen: tuple[str, ...] = ()
    advice: tuple[str, ...] = ()
    alike: tuple[tuple[str, ...], ...] = ()
    warnings: tuple[str, ...] = ()
    recordings: tuple[Measurement, ...] = field(default=(), repr=False)
    held_out: tuple[Measurement, ...] = field(default=(), repr=False)
    seconds: float = 0.0

    @property
    def diff(self) -> tuple[str, ...]:
        """What was changed in the graph, as lines of text."""
        return self.chosen.diff
