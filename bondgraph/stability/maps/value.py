"""The result of a map: eigenvalues and steady states over points of parameters."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy

from ...errors import BondGraphError

if TYPE_CHECKING:
    import xarray

Array = numpy.ndarray


class PointOutcome(enum.IntEnum):
    """How a point of a map ended.

    Examples
    --------
    >>> PointOutcome.REFUSED.label
    'refused parameter'
    """

    OK = 0
    REFUSED = 1
    NO_STEADY_STATE = 2
    NOT_FINITE = 3
    NOT_DETERMINED = 4
    NOT_TRIED = 5

    @property
    def label(self) -> str:
        """The outcome in words."""
        return _LABELS[self]


_LABELS = {
    PointOutcome.OK: "ok",
    PointOutcome.REFUSED: "refused parameter",
    PointOutcome.NO_STEADY_STATE: "no steady state",
    PointOutcome.NOT_FINITE: "not finite",
    PointOutcome.NOT_DETERMINED: "algebraic variables not determined",
    PointOutcome.NOT_TRIED: "not tried: more points than `searches` want a long search",
}


@dataclass(frozen=True, eq=False)
class EigenvalueMap:
    """Eigenvalues and steady states at points of parameters.

    Points are numbered along the first axis of all arrays; those of a product of axes stand in
    C order, see `on_grid`.

    Attributes
    ----------
    model : str
    points : dict of str to (np,) array
        What varies, SI.
    units : dict of str to str
        Of what varies, each its own, for display.
    axes : dict of str to (k,) array
        Those of the product, in order; empty where points were listed.
    states : tuple of str
    eigenvalues : (np, n) complex array
        In 1/s, least stable first, of a pair the one with positive imaginary part first; nan
        where there are none, and behind them where a mode binds states.
    steady_states : (np, n) array
        SI, nan where there is none.
    outcomes : (np,) array of int8
        Values of `PointOutcome`.
    modes : dict of str to (np,) array of int8
        Code of each contact's mode.
    labels : dict of str to dict of int to str
        Names of those codes.
    isolated : (np,) array of bool
        See `bondgraph.SteadyState`.
    reasons : dict of PointOutcome to str
        For each outcome but ok, what was wrong at the first such point.
    """

    model: str
    points: dict[str, Array]
    units: dict[str, str]
    axes: dict[str, Array]
    states: tuple[str, ...]
    eigenvalues: Array
    steady_states: Array
    outcomes: Array
    modes: dict[str, Array]
    labels: dict[str, dict[int, str]]
    isolated: Array
    reasons: Mapping[PointOutcome, str] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.outcomes)

    def __repr__(self) -> str:
        told = ", ".join(f"{count} {label}" for label, count in self.counts().items())
        return f"EigenvalueMap({self.model!r}, {' x '.join(map(str, self.shape))} points: {told})"

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the axes, or the number of points."""
        return tuple(map(len, self.axes.values())) if self.axes else (len(self),)

    @property
    def ok(self) -> Array:
        """Where there is a result, (np,) array of bool."""
        return self.outcomes == PointOutcome.OK

    @property
    def growth(self) -> Array:
        """Largest real part, 1/s, shape (np,); nan where there is none."""
        if not self.eigenvalues.shape[1]:
            return numpy.full(len(self), numpy.nan)
        return self.eigenvalues[:, 0].real.copy()

    @property
    def leading(self) -> Array:
        """Least stable eigenvalue that oscillates, of positive imaginary part, shape (np,); or nan."""
        waves = self.eigenvalues.imag > 0
        if not waves.shape[1]:
            return numpy.full(len(self), complex(numpy.nan, numpy.nan))
        first = numpy.argmax(waves, axis=1)
        found = self.eigenvalues[numpy.arange(len(self)), first]
        return numpy.where(waves.any(axis=1), found, complex(numpy.nan, numpy.nan))

    @property
    def frequency_hz(self) -> Array:
        """Frequency of the leading oscillatory mode, Hz, shape (np,)."""
        return self.leading.imag / (2 * numpy.pi)

    @property
    def damping_ratio(self) -> Array:
        """Damping ratio of the leading oscillatory mode, shape (np,); negative where it grows."""
        leading = self.leading
        return -leading.real / numpy.abs(leading)

    @property
    def stable(self) -> Array:
        """Whether all eigenvalues lie strictly in the left half plane, (np,) array of bool."""
        growing = (self.eigenvalues.real >= 0).any(axis=1)
        return self.ok & ~growing

    def on_grid(self, values: Array) -> Array:
        """Give values of the points, shape (np, ...), the shape of the axes, (k1, k2, ..., ...).

        Examples
        --------
        >>> from bondgraph.models import mass_on_belt
        >>> from bondgraph.stability import eigenvalue_map
        >>> axes = {"v_b": numpy.linspace(0.1, 0.5, 5), "v_s": numpy.array([0.1, 0.2])}
        >>> found = eigenvalue_map(mass_on_belt.graph(), axes, product=True)
        >>> found.on_grid(found.growth).shape
        (5, 2)
        """
        return numpy.asarray(values).reshape(*self.shape, *numpy.shape(values)[1:])

    def counts(self) -> dict[str, int]:
        """Return how many points ended how, by the outcomes' labels."""
        found, counts = numpy.unique(self.outcomes, return_counts=True)
        return {
            PointOutcome(int(code)).label: int(n) for code, n in zip(found, counts, strict=True)
        }

    def to_xarray(self) -> xarray.Dataset:
        """Return an xarray Dataset over the axes, or over points.

        Raises
        ------
        BondGraphError
            If xarray is not installed.
        """
        try:
            import xarray
        except ImportError:
            raise BondGraphError("xarray is not installed; pip install 'halfarrow[data]'") from None
        dims = tuple(self.axes) or ("point",)
        order, state = "eigenvalue", "state"
        columns = {
            "real": ((*dims, order), self.on_grid(self.eigenvalues.real), {"units": "1/s"}),
            "imag": ((*dims, order), self.on_grid(self.eigenvalues.imag), {"units": "1/s"}),
            "steady_state": ((*dims, state), self.on_grid(self.steady_states), {}),
            "growth": (dims, self.on_grid(self.growth), {"units": "1/s"}),
            "frequency_hz": (dims, self.on_grid(self.frequency_hz), {"units": "Hz"}),
            "damping_ratio": (dims, self.on_grid(self.damping_ratio), {}),
            "stable": (dims, self.on_grid(self.stable), {}),
            "isolated": (dims, self.on_grid(self.isolated), {}),
            "outcome": (dims, self.on_grid(self.outcomes), {"meaning": _meaning()}),
        }
        for name, codes in self.modes.items():
            told = ", ".join(f"{code} {label}" for code, label in self.labels[name].items())
            columns[f"{name}.mode"] = (dims, self.on_grid(codes), {"meaning": told})
        along = self.axes or self.points
        coords = {
            name: (name if self.axes else "point", values, {"values": "SI"})
            for name, values in along.items()
        }
        return xarray.Dataset(columns, {**coords, state: list(self.states)}, {"model": self.model})


def _meaning() -> str:
    return ", ".join(f"{int(item)} {item.label}" for item in PointOutcome)
