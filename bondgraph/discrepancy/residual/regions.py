"""In which operating region the gap lies, and whether it depends on where the system is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy

from ...errors import MeasurementError
from .floor import Floor, floor_of
from .value import Residuals

Array = numpy.ndarray

BLOCKS = 4  # memories in a block that is put elsewhere: its ends are what it forgets
LEAST = 10.0  # effective samples of a bin that is not marked as thin


@dataclass(frozen=True)
class Dependence:
    """How far a quantity depends on the bin it is in.

    Attributes
    ----------
    ratio : float
        Correlation ratio: variance of the bins' means over the whole variance, 0 to 1.
    expected : float
        Its mean where blocks are put in random order: what chance alone gives.
    p : float
        Chance of a ratio as large, from the permutations; not below 1 / (1 + permutations).
    """

    ratio: float
    expected: float
    p: float


@dataclass(frozen=True, eq=False)
class RegionGaps:
    """A gap over one or two signals.

    Attributes
    ----------
    signal, unit : str
        What was binned.
    over : tuple of str
        The one or two signals that make the bins.
    over_units : tuple of str
    edges : tuple of arrays
        Of the bins of each.
    count : array of int
        Of shape (n1,) or (n1, n2), as those below.
    mean, spread : array
        Of the gap in a bin, and its standard deviation; NaN in bins without a sample.
    band : array
        Half width of the 95 % band of the mean, by effective samples.
    rmse : array
    thin : array of bool
        Bins with fewer than ten effective samples: not to be read.
    share : array
        Of the excess over the floor (of the mean square where there is no floor).
    block : int
        Samples after which the gap has forgotten itself.
    of_mean, of_power : Dependence
        Of the gap, and of its square, on the bins.
    floor : Floor or None
        None where other values than the gap were binned.
    """

    signal: str
    unit: str
    over: tuple[str, ...]
    over_units: tuple[str, ...]
    edges: tuple[Array, ...]
    count: Array
    mean: Array
    spread: Array
    band: Array
    rmse: Array
    thin: Array
    share: Array
    block: int
    of_mean: Dependence
    of_power: Dependence
    floor: Floor | None


def by_region(
    found: Residuals,
    signal: str,
    over: str | Sequence[str],
    *,
    bins: int | Sequence[Any] = 10,
    values: Any = None,
    unit: str = "",
    floor: Any = None,
    permutations: int = 499,
    seed: int = 0,
) -> RegionGaps:
    """Sort the gap of a signal into bins of another one or two.

    Dependence is told by the correlation ratio, of the gap and of its square, against the same
    with blocks of the gap in random order. A block is as long as the gap remembers itself (the sum
    of its autocorrelation to the first zero), times four; so a slow gap is not taken for one that
    depends.

    Parameters
    ----------
    found : Residuals
    signal : str
    over : str or two of them
        Signals of the residuals, such as ``"slip"`` or ``"|slip|"``; see `Residuals.along`.
    bins : int, or one for each of `over`: int or edges
        Equal ones between least and largest value, unless edges are given.
    values : (nt,) array-like, optional
        What to bin instead of the gap, such as `gap_rate`; NaN where there is none.
    unit : str
        Of `values`.
    floor : float, Floor, or mapping, optional
        As for `by_signal`.
    permutations, seed : int

    Returns
    -------
    RegionGaps

    Raises
    ------
    MeasurementError
        For unknown signals, values of another length, and bins without meaning.

    References
    ----------
    Pearson, On the general theory of skew correlation and non-linear regression, Drapers' Company
    Research Memoirs 2 (1905); Good, Permutation, Parametric, and Bootstrap Tests of Hypotheses,
    3rd ed., Springer 2005.

    Examples
    --------
    >>> rng = numpy.random.default_rng(0)
    >>> t, v = numpy.arange(4000) / 100, rng.normal(size=4000)
    >>> found = Residuals(t, {"a": 0.1 * v**2 + rng.normal(0, 0.1, 4000)}, {"a": 0 * t}, {}, {"v": v})
    >>> regions = by_region(found, "a", "|v|", bins=4, floor=0.1)
    >>> regions.of_mean.p, bool((numpy.diff(regions.mean) > 0).all())
    (0.002, True)
    """
    names = (over,) if isinstance(over, str) else tuple(over)
    gap = found.gap(signal) if values is None else numpy.array(values, dtype=float).ravel()
    if len(gap) != len(found) or not 1 <= len(names) <= 2:
        raise MeasurementError(
            f"{signal}: {len(gap)} values for {len(found)} times, over {len(names)} signals; give "
            "as many values as times, and one or two signals"
        )
    own = floor_of(found, signal, floor) if values is None else None
    where = [found.along(name) for name in names]
    good = numpy.isfinite(gap) & numpy.all([numpy.isfinite(row) for row in where], axis=0)
    edges = _edges(names, [row[good] for row in where], bins)
    inside = good.copy()
    for row, marks in zip(where, edges, strict=True):
        inside &= (row >= marks[0]) & (row <= marks[-1])
    if not inside.any():
        raise MeasurementError(f"{signal}: no sample within the bins of {' and '.join(names)}")
    gap, where = gap[inside], [row[inside] for row in where]
    shape = tuple(len(marks) - 1 for marks in edges)
    index = numpy.ravel_multi_index(
        tuple(
            numpy.clip(numpy.searchsorted(marks, row, side="right") - 1, 0, len(marks) - 2)
            for row, marks in zip(where, edges, strict=True)
        ),
        shape,
    )
    cells = int(numpy.prod(shape))
    block = memory(gap)
    count = numpy.bincount(index, minlength=cells)
    with numpy.errstate(divide="ignore", invalid="ignore"):
        mean = numpy.bincount(index, gap, cells) / count
        square = numpy.bincount(index, gap**2, cells) / count
        spread = numpy.sqrt(numpy.maximum(square - mean**2, 0.0))
        worth = _worth(index, block, cells)
        band = 1.96 * spread / numpy.sqrt(worth)
    excess = count * numpy.maximum(numpy.nan_to_num(square) - (own.sigma**2 if own else 0.0), 0.0)
    rng = numpy.random.default_rng(seed)
    share = excess / excess.sum() if excess.sum() > 0 else excess
    return RegionGaps(
        signal,
        unit or (found.unit(signal) if values is None else ""),
        names,
        tuple(found.unit(name) for name in names),
        tuple(edges),
        count.reshape(shape),
        mean.reshape(shape),
        spread.reshape(shape),
        band.reshape(shape),
        numpy.sqrt(square).reshape(shape),
        (worth < LEAST).reshape(shape),
        share.reshape(shape),
        block,
        _dependence(gap, index, cells, block, permutations, rng),
        _dependence(gap**2, index, cells, max(block, memory(gap**2)), permutations, rng),
        own,
    )


def memory(gap: Array) -> int:
    """Return after how many samples a series has forgotten itself.

    The sum of its autocorrelation, both ways, up to the first zero; one for white noise.

    Parameters
    ----------
    gap : (nt,) array

    Returns
    -------
    int

    Examples
    --------
    >>> memory(numpy.random.default_rng(0).normal(size=5000)), memory(numpy.zeros(5))
    (1, 1)
    """
    from scipy.signal import fftconvolve

    centred = gap - gap.mean()
    power = float(centred @ centred)
    if not power > 0:
        return 1
    rho = fftconvolve(centred, centred[::-1])[len(gap) - 1 :] / power
    # below what white noise shows, a lag is taken for zero
    small = numpy.flatnonzero(rho < 2 / numpy.sqrt(len(gap)))
    until = int(small[0]) if len(small) else len(gap)
    return max(1, min(int(numpy.ceil(1 + 2 * rho[1:until].sum())), len(gap)))


def _edges(names: tuple[str, ...], rows: list[Array], bins: Any) -> list[Array]:
    """Return the edges of bins over each signal."""
    if isinstance(bins, int) or (len(names) == 1 and numpy.ndim(bins[0]) == 0):
        bins = [bins] * len(names)
    if len(bins) != len(names):
        raise MeasurementError(f"{len(bins)} sets of bins over {len(names)} signals")
    out = []
    for name, row, wanted in zip(names, rows, bins, strict=True):
        if isinstance(wanted, int):
            low, high = float(row.min()), float(row.max())
            if wanted < 1 or not high > low:
                raise MeasurementError(
                    f"{wanted} bins over {name!r} from {low:g} to {high:g}: it must change, and "
                    "there must be one bin at least"
                )
            out.append(numpy.linspace(low, high, wanted + 1))
        else:
            marks = numpy.array(wanted, dtype=float).ravel()
            if len(marks) < 2 or not (numpy.diff(marks) > 0).all():
                raise MeasurementError(f"edges of bins over {name!r} must increase")
            out.append(marks)
    return out


def _worth(index: Array, block: int, cells: int) -> Array:
    """Return the effective samples of each bin: one for each block that has been in it, at most."""
    if block == 1:
        return numpy.bincount(index, minlength=cells).astype(float)
    visits = numpy.unique(numpy.arange(len(index)) // block * cells + index) % cells
    return numpy.bincount(visits, minlength=cells).astype(float)


def _dependence(
    values: Array, index: Array, cells: int, block: int, permutations: int, rng: Any
) -> Dependence:
    """Hold the correlation ratio against that of blocks in random order."""
    centred = values - values.mean()
    power = float(centred @ centred)
    # one part in 1e20 of the values' own size is rounding, not variance
    if not power > 1e-20 * float(values @ values):
        return Dependence(0.0, 0.0, 1.0)
    count = numpy.maximum(numpy.bincount(index, minlength=cells), 1)

    def ratio(row: Array) -> float:
        return float((numpy.bincount(index, row, cells) ** 2 / count).sum() / power)

    seen = ratio(centred)
    length = 1 if block == 1 else min(BLOCKS * block, len(values))
    drawn = numpy.array([ratio(_shuffled(centred, length, rng)) for _ in range(permutations)])
    p = (1 + int((drawn >= seen).sum())) / (1 + permutations)
    return Dependence(seen, float(drawn.mean()) if permutations else 0.0, p)


def _shuffled(row: Array, block: int, rng: Any) -> Array:
    """Put blocks in random order, from a random first sample on, round the end."""
    if block == 1:
        return rng.permutation(row)
    row = numpy.roll(row, int(rng.integers(len(row))))
    whole = len(row) // block * block
    parts = rng.permutation(row[:whole].reshape(-1, block), axis=0).ravel()
    return numpy.append(parts, row[whole:])
