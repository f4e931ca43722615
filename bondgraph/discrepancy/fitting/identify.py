"""What the data can tell: covariance, and the combinations of unknowns that they do not see."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy

Array = numpy.ndarray

UNSEEN = 1e-7  # singular values below this share of the largest are zero to the runs' accuracy
WEAK = 1.0  # known worse than by a factor of e
PART = 0.1  # what of a direction is named


@dataclass(frozen=True)
class Direction:
    """A combination of unknowns, in relative changes, and how well the data see it.

    Attributes
    ----------
    names : tuple of str
        The unknowns with a share in it.
    shares : tuple of float
        Their parts of the unit vector.
    uncertainty : float
        Standard deviation along it, as a relative change; infinite where unseen.
    words : str
    """

    names: tuple[str, ...]
    shares: tuple[float, ...]
    uncertainty: float
    words: str

    @property
    def seen(self) -> bool:
        """Whether the data tell it to better than a factor of e."""
        return self.uncertainty <= WEAK


@dataclass(frozen=True, eq=False)
class Known:
    """What is known of the unknowns' coordinates.

    Attributes
    ----------
    std : (q,) array
        Infinite where an unseen direction has a share.
    covariance : (q, q) array
        Infinite on the diagonal there; elsewhere that of the seen directions.
    directions : tuple of Direction
        By the data alone, least known first.
    """

    std: Array
    covariance: Array
    directions: tuple[Direction, ...]


def identified(
    rows: Array, prior: Array, scale: Array, names: Sequence[str], logs: Sequence[bool]
) -> Known:
    """Return what rows of residuals over coordinates tell of them.

    Parameters
    ----------
    rows : (m, q + 1) array
        Of the data, standardised; residuals last.
    prior : (k, q + 1) array
    scale : (q,) array
        A relative change of one, in coordinates.
    names : sequence of str
    logs : sequence of bool
        Of which a relative change is one of their logarithm.

    Returns
    -------
    Known

    Examples
    --------
    >>> found = identified(
    ...     numpy.array([[3.0, 3.0, 0.0]]), numpy.zeros((0, 3)), numpy.ones(2), ["N", "mu"], [True] * 2
    ... )
    >>> found.directions[0].words
    'only N*mu is seen: N and mu along (+0.71, -0.71) are not'
    >>> found.std.tolist()
    [inf, inf]
    """
    scaled = rows[:, :-1] * scale
    directions = _directions(*_svd(scaled), names, logs)
    size, across = _svd(numpy.concatenate([scaled, prior[:, :-1] * scale]))
    unseen = _unseen(size)
    inverse = numpy.where(unseen, 0.0, 1 / numpy.where(unseen, 1.0, size))
    covariance = (across.T * inverse**2) @ across * numpy.outer(scale, scale)
    lost = (across[unseen] ** 2).sum(axis=0) > 1e-6
    covariance[lost, lost] = numpy.inf
    return Known(numpy.sqrt(numpy.diag(covariance)), covariance, directions)


def _svd(rows: Array) -> tuple[Array, Array]:
    q = rows.shape[1]
    full = numpy.concatenate([rows, numpy.zeros((max(0, q - len(rows)), q))])
    _, size, across = numpy.linalg.svd(full, full_matrices=False)
    return size, across


def _unseen(size: Array) -> Array:
    return (size <= UNSEEN * size.max(initial=0.0)) & (size < 1 / WEAK)


def _directions(
    size: Array, across: Array, names: Sequence[str], logs: Sequence[bool]
) -> tuple[Direction, ...]:
    unseen = _unseen(size)
    found = []
    for i in range(len(size) - 1, -1, -1):
        row = across[i]
        places = [j for j in numpy.argsort(-abs(row)) if abs(row[j]) >= PART]
        places.sort()
        shares = row[places] * numpy.sign(row[places[0]])
        parts = tuple(names[j] for j in places)
        std = numpy.inf if unseen[i] else 1 / size[i]
        product = all(logs[j] for j in places)
        words = _words(parts, shares, float(std), product)
        found.append(Direction(parts, tuple(map(float, shares)), float(std), words))
    return tuple(found)


def _words(names: tuple[str, ...], shares: Array, std: float, product: bool) -> str:
    along = f"{_listed(names)} along ({', '.join(f'{share:+.2f}' for share in shares)})"
    if std <= WEAK:
        return f"{along if len(names) > 1 else names[0]} is seen to {std:.2g}"
    how = (
        "are not"
        if numpy.isinf(std)
        else f"is seen to a factor of {numpy.exp(min(std, 99)):.2g} only"
    )
    if len(names) == 1:
        return f"{names[0]} is not seen" if numpy.isinf(std) else f"{names[0]} {how}"
    if product and len(names) <= 4:
        signs = numpy.sign(shares)
        odd = [j for j in range(len(names)) if (signs == signs[j]).sum() == 1]
        pivot = odd[0] if len(odd) == 1 else 0
        joint = [
            _joint(names[pivot], names[i], -shares[pivot] / shares[i])
            for i in range(len(names))
            if i != pivot
        ]
        verb = "is" if len(joint) == 1 else "are"
        return f"only {_listed(tuple(joint))} {verb} seen: {along} {how}"
    return f"only combinations across it are seen: {along} {how}"


def _joint(first: str, other: str, power: float) -> str:
    """Write first * other^power, which does not change along the direction."""
    sized = "" if abs(abs(power) - 1) < 0.02 else f"^{abs(power):.2g}"
    return f"{first}{'*' if power > 0 else '/'}{other}{sized}"


def _listed(names: tuple[str, ...]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]]) if len(names) > 1 else names[0]
