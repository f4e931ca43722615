"""Fit: what comes out, as a frozen value."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy

from ...simulation import Trajectory
from .descend import Iteration
from .identify import Direction
from .outcome import FitOutcome

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Channel:
    """One signal of one recording beside the model.

    Attributes
    ----------
    recording, signal : str
    t : (nt,) array, s
    residuals : (nt,) array
        Model less data, SI; NaN at gaps.
    noise : float
        Standard deviation that weighed it, given or estimated.
    rmse : float
    chi2 : float
        Mean square of residuals over noise; about 1 where all that is left is noise.
    count : int
        Samples present.
    effective : float
        How many independent ones they are worth; see `docs/fits.md`.
    """

    recording: str
    signal: str
    t: Array
    residuals: Array
    noise: float
    rmse: float
    chi2: float
    count: int
    effective: float


@dataclass(frozen=True, eq=False)
class Fit:
    """Result of a fit.

    Attributes
    ----------
    outcome : FitOutcome
    values : dict of str to float
        Parameters sought, SI.
    std : dict of str to float
        Their standard deviations; infinite where a direction that is not seen has a share.
    initial, initial_std : tuple of dict of str to float
        Start states sought, and theirs, by recording.
    names : tuple of str
        Rows of covariance and correlation: parameters, then start states.
    covariance : (q, q) array, SI
        Infinite on the diagonal as `std`; elsewhere that of the seen directions.
    directions : tuple of Direction
        Of relative changes, least known first.
    channels : tuple of Channel
    trajectories : tuple of tuple of Trajectory
        By recording: at the optimum, one for each segment.
    cost : float
        Loss at the optimum, priors included.
    gap : float
        Largest break between segments in shares of the state's range; 0 for a single shot.
    at_bounds : tuple of str
        Unknowns that a bound holds; their std is that without it.
    iterations : tuple of Iteration
    seconds : float
    logs : mapping of str to bool
        Which parameters were sought in their logarithm.
    remark : str
        What the fit adds to its outcome's advice.
    """

    outcome: FitOutcome
    values: dict[str, float]
    std: dict[str, float]
    initial: tuple[dict[str, float], ...]
    initial_std: tuple[dict[str, float], ...]
    names: tuple[str, ...]
    covariance: Array
    directions: tuple[Direction, ...]
    channels: tuple[Channel, ...]
    trajectories: tuple[tuple[Trajectory, ...], ...]
    cost: float
    gap: float
    at_bounds: tuple[str, ...]
    iterations: tuple[Iteration, ...]
    seconds: float
    logs: Mapping[str, bool]
    remark: str = ""

    def __repr__(self) -> str:
        shown = ", ".join(f"{n}={v:.6g} +- {self.std[n]:.2g}" for n, v in self.values.items())
        return f"Fit({self.outcome.value}: {shown})"

    @property
    def correlation(self) -> Array:
        """Correlation of the unknowns, of shape (q, q); 0 beside those that are not seen."""
        std = numpy.sqrt(numpy.diag(self.covariance))
        fine = numpy.isfinite(std) & (std > 0)
        scale = numpy.where(fine, 1 / numpy.where(fine, std, 1.0), 0.0)
        plain = numpy.where(numpy.isfinite(self.covariance), self.covariance, 0.0)
        found = plain * numpy.outer(scale, scale)
        numpy.fill_diagonal(found, 1.0)
        return found

    @property
    def unidentified(self) -> tuple[Direction, ...]:
        """Directions that the data do not tell to a factor of e."""
        return tuple(direction for direction in self.directions if not direction.seen)

    @property
    def advice(self) -> str:
        """What happened at the end, what is not seen, and what to do."""
        seen = [direction.words for direction in self.unidentified]
        held = [f"at a bound: {', '.join(self.at_bounds)}"] if self.at_bounds else []
        return "; ".join(filter(None, [self.outcome.advice, self.remark, *seen, *held]))

    def interval(self, name: str, width: float = 1.96) -> tuple[float, float]:
        """Return the limits of a parameter, ``width`` standard deviations about it.

        Parameters
        ----------
        name : str
        width : float

        Returns
        -------
        (float, float)
            Symmetric in the logarithm for a positive one.
        """
        value, std = self.values[name], self.std[name]
        if not self.logs[name]:
            return value - width * std, value + width * std
        share = min(width * std / value, 700.0)
        return value * math.exp(-share), value * math.exp(share)
