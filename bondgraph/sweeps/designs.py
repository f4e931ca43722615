"""Random designs: points drawn from ranges, the same for the same seed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy

from ..errors import SweepError
from .points import Points, samples


def uniform(ranges: Mapping[str, Any], n: int, *, seed: int) -> Points:
    """Draw points independently and evenly from a box.

    Parameters
    ----------
    ranges : mapping of str to (lo, hi) or (lo, hi, unit)
    n : int
        Number of points.
    seed : int
        The same seed draws the same points.

    Returns
    -------
    Points

    Raises
    ------
    SweepError

    Examples
    --------
    >>> drawn = uniform({"V0": (0.5, 1.5)}, 100, seed=1).columns["V0"]
    >>> bool(drawn.min() >= 0.5 and drawn.max() < 1.5)
    True
    """
    return _scaled(ranges, n, lambda d: numpy.random.default_rng(seed).random((n, d)))


def latin_hypercube(ranges: Mapping[str, Any], n: int, *, seed: int) -> Points:
    """Draw points that fall once into each of n even slices of every range.

    Parameters
    ----------
    ranges : mapping of str to (lo, hi) or (lo, hi, unit)
    n : int
    seed : int

    Returns
    -------
    Points

    Raises
    ------
    SweepError

    References
    ----------
    McKay, Beckman, Conover, A comparison of three methods for selecting values
    of input variables in the analysis of output from a computer code,
    Technometrics 21 (1979) 239-245.

    Examples
    --------
    >>> drawn = latin_hypercube({"m": (0, 4), "k": (10, 14)}, 4, seed=3)
    >>> sorted(int(value) for value in drawn.columns["k"])
    [10, 11, 12, 13]
    """

    def draw(dimensions: int) -> Any:
        from scipy.stats import qmc

        return qmc.LatinHypercube(dimensions, rng=seed).random(n)

    return _scaled(ranges, n, draw)


def sobol(ranges: Mapping[str, Any], n: int, *, seed: int) -> Points:
    """Draw points of a scrambled Sobol sequence, which fill a box evenly.

    Parameters
    ----------
    ranges : mapping of str to (lo, hi) or (lo, hi, unit)
    n : int
        A power of two, at which the sequence is balanced.
    seed : int

    Returns
    -------
    Points

    Raises
    ------
    SweepError

    References
    ----------
    Sobol', On the distribution of points in a cube and the approximate
    evaluation of integrals, USSR Comput. Math. Math. Phys. 7 (1967) 86-112.

    Examples
    --------
    >>> drawn = sobol({"m": (0, 1)}, 8, seed=0).columns["m"]
    >>> sorted(int(8 * value) for value in drawn)
    [0, 1, 2, 3, 4, 5, 6, 7]
    """
    if n < 1 or n & (n - 1):
        near = 2 ** max(0, round(math.log2(max(n, 1))))
        raise SweepError(f"a Sobol sequence is even at powers of two, not at {n}; take {near}")

    def draw(dimensions: int) -> Any:
        from scipy.stats import qmc

        return qmc.Sobol(dimensions, rng=seed).random(n)

    return _scaled(ranges, n, draw)


def _scaled(ranges: Mapping[str, Any], n: int, draw: Any) -> Points:
    bounds = [_bounds(name, given) for name, given in ranges.items()]
    if not bounds or n < 1:
        raise SweepError(f"{n} points of {len(bounds)} ranges are none; give at least one of each")
    unit_box = draw(len(bounds))
    return samples(
        {
            name: (low + (high - low) * column, unit)
            for (name, low, high, unit), column in zip(bounds, unit_box.T, strict=True)
        }
    )


def _bounds(name: str, given: Any) -> tuple[str, float, float, str]:
    try:
        low, high, unit = (*given, "") if len(given) == 2 else given
        low, high = float(low), float(high)
    except (TypeError, ValueError):
        raise SweepError(
            f"range of {name!r}: write (lo, hi) or (lo, hi, unit), got {given!r}"
        ) from None
    if not (math.isfinite(low) and math.isfinite(high)) or low >= high:
        raise SweepError(
            f"range of {name!r}: {low:g} to {high:g} is none; give two finite ends, lo < hi"
        )
    return name, low, high, unit
