"""Floquet multipliers: what becomes of small disturbances once round a periodic orbit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy

Array = numpy.ndarray

# Below this size a multiplier counts as zero: the disturbance is gone after one period.
NONE_LEFT = 1e-9
# So near to one in size, runs of finite tolerance do not tell which side it is on.
NEUTRAL = 1e-6


@dataclass(frozen=True, eq=False)
class Floquet:
    """Multipliers of a periodic orbit.

    Attributes
    ----------
    monodromy : (n, n) array
        Jacobian of the states after one period by those before, ordered as the states.
    multipliers : (n,) complex array
        Its eigenvalues, largest first.
    trivial : int or None
        Place of the multiplier one that belongs to a shift along the orbit; None where the orbit
        is forced and has no such shift.

    Examples
    --------
    >>> found = Floquet.of(numpy.diag([0.5, 1.0]), autonomous=True)
    >>> found.verdict, found.trivial_error, [float(m.real) for m in found.others]
    ('stable', 0.0, [0.5])
    """

    monodromy: Array
    multipliers: Array
    trivial: int | None

    @classmethod
    def of(cls, monodromy: Array, autonomous: bool, along: Array | None = None) -> Floquet:
        """Find the multipliers of a monodromy matrix.

        Parameters
        ----------
        monodromy : (n, n) array
        autonomous : bool
            Whether one of them is that of a shift along the orbit.
        along : (n,) array, optional
            Direction of the orbit at its start, which tells it from another one near to one.

        Returns
        -------
        Floquet
        """
        values, vectors = numpy.linalg.eig(monodromy)
        order = numpy.argsort(-numpy.abs(values), kind="stable")
        values, vectors = values[order].astype(complex), vectors[:, order]
        trivial = None
        if autonomous and len(values):
            off = numpy.abs(values - 1)
            near = numpy.flatnonzero(off <= max(10 * off.min(), 1e-3))
            trivial = int(near[numpy.argmin(off[near])])
            if along is not None and len(near) > 1:
                aligned = numpy.abs(vectors[:, near].conj().T @ (along / numpy.linalg.norm(along)))
                trivial = int(near[numpy.argmax(aligned)])
        return cls(monodromy, values, trivial)

    @property
    def others(self) -> Array:
        """The multipliers beside the trivial one, largest first."""
        if self.trivial is None:
            return self.multipliers
        return numpy.delete(self.multipliers, self.trivial)

    @property
    def trivial_error(self) -> float:
        """How far the trivial multiplier is from one; nan where there is none."""
        if self.trivial is None:
            return float("nan")
        return float(abs(self.multipliers[self.trivial] - 1))

    @property
    def zeros(self) -> int:
        """How many multipliers are zero: a phase in which a contact sticks forgets a direction."""
        return int((numpy.abs(self.multipliers) < NONE_LEFT).sum())

    @property
    def verdict(self) -> str:
        """``"stable"``, ``"unstable"``, or ``"undecided"`` where one is as good as one in size."""
        sizes = numpy.abs(self.others)
        if (sizes > 1 + NEUTRAL).any():
            return "unstable"
        return "undecided" if (sizes >= 1 - NEUTRAL).any() else "stable"

    @property
    def stable(self) -> bool:
        """Whether every disturbance dies out."""
        return self.verdict == "stable"
