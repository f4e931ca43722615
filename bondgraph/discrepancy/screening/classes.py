"""Candidates that the data cannot tell apart, and what would."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import networkx
import numpy

from .score import scored

Array = numpy.ndarray

SAME = 0.98
"""Cosine of projected responses from which on two candidates are one class."""


def ambiguity_classes(correlation: Array, same: float = SAME) -> list[tuple[int, ...]]:
    """Group candidates whose projected responses are alike, up to their sign.

    Parameters
    ----------
    correlation : (q, q) array
        Of `Scores`.
    same : float

    Returns
    -------
    list of tuple of int
        Each candidate stands in one class, alone or with others; classes and members ordered.
        Membership is passed on: two members of one class may be less alike than `same`.

    Examples
    --------
    >>> ambiguity_classes(numpy.array([[1.0, -0.99, 0.2], [-0.99, 1.0, 0.1], [0.2, 0.1, 1.0]]))
    [(0, 1), (2,)]
    """
    alike = networkx.Graph()
    alike.add_nodes_from(range(len(correlation)))
    alike.add_edges_from(numpy.argwhere(numpy.abs(correlation) > same).tolist())
    return sorted(tuple(sorted(part)) for part in networkx.connected_components(alike))


@dataclass(frozen=True)
class Splitter:
    """A signal that would tell the members of a class apart, were it measured.

    Attributes
    ----------
    signal : str
    likeness : float
        Greatest cosine between two members that is left with it.
    """

    signal: str
    likeness: float


def splitters(
    members: Sequence[int],
    extra: Mapping[str, Array],
    parameters: Mapping[str, Array] | None = None,
    same: float = SAME,
) -> list[Splitter]:
    """Rank signals by how well they would split a class.

    Parameters
    ----------
    members : sequence of int
        Of one class.
    extra : mapping of str to (ns, q) array
        Responses of signals that are not measured, over the noise expected of them.
    parameters : mapping of str to (ns, p) array, optional
        The same by the model's own parameters.
    same : float

    Returns
    -------
    list of Splitter
        Best first; those that leave two members as alike as `same` are left out.

    Examples
    --------
    >>> t = numpy.linspace(0, 1, 100)
    >>> apart = {"v": numpy.array([t, t**3]).T, "x": numpy.array([t, 2 * t]).T}
    >>> [found.signal for found in splitters((0, 1), apart)]
    ['v']
    """
    found = []
    for name, responses in extra.items():
        own = None if parameters is None else parameters.get(name)
        alone = scored(numpy.zeros(len(responses)), responses[:, list(members)], own)
        off = numpy.abs(alone.correlation)
        numpy.fill_diagonal(off, 0.0)  # also of one that does not show, which tells it apart
        blind = (alone.left == 0).sum() > 1  # two of them do not show in it at all
        likeness = 1.0 if blind else float(off.max(initial=0.0))
        if likeness <= same:
            found.append(Splitter(name, likeness))
    return sorted(found, key=lambda item: item.likeness)
