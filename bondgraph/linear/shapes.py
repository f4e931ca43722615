"""Mode shapes as motion of named junctions."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy

from ..dimensions import infer
from ..elements import One, Storage, Zero
from .balance import port_of
from .variations import slopes

if TYPE_CHECKING:
    from .system import LinearSystem

# Beside the terms that it is a sum of, a smaller flow or effort is rounding noise: it is zero.
# So is a state beside the largest, both as roots of energies.
NOISE = 1e-13
TINY = 1e-150


@dataclass(frozen=True)
class ModeShape:
    """How the junctions move in one mode.

    All flows have one common factor, chosen so that the largest flow is one with
    phase zero, and all efforts another. They are in SI, so flows of unlike units
    compare as those units do; `within_unit` compares like with like.

    Attributes
    ----------
    pole : complex
        1/s. Everything varies as ``exp(pole t)``.
    flows : mapping of str to complex
        By 1-junction.
    efforts : mapping of str to complex
        By 0-junction.
    units : mapping of str to str
        SI unit by junction; empty where it is not known.

    Examples
    --------
    >>> shape = ModeShape(2j, {"a": 1 + 0j, "b": -0.5 + 0j}, {}, {"a": "m/s", "b": "m/s"})
    >>> shape.magnitude("b"), shape.phase("b"), shape.displacements["a"]
    (0.5, 180.0, -0.5j)
    """

    pole: complex
    flows: Mapping[str, complex]
    efforts: Mapping[str, complex]
    units: Mapping[str, str]

    @property
    def motion(self) -> dict[str, complex]:
        """Flows and efforts together, by junction."""
        return {**self.flows, **self.efforts}

    @property
    def displacements(self) -> dict[str, complex]:
        """Flow over pole, by 1-junction; nan for a pole at zero.

        In the scale of `flows`: where those are one, a displacement is ``1 / pole``.
        """
        pole = self.pole or complex(math.nan, math.nan)
        return {name: value / pole for name, value in self.flows.items()}

    def magnitude(self, junction: str) -> float:
        """Return the magnitude of a junction's flow or effort.

        Parameters
        ----------
        junction : str

        Returns
        -------
        float
        """
        return abs(self.motion[junction])

    def phase(self, junction: str) -> float:
        """Return the phase of a junction's flow or effort, degrees in (-180, 180].

        Parameters
        ----------
        junction : str

        Returns
        -------
        float
            Zero for what does not move.
        """
        found = math.degrees(cmath.phase(self.motion[junction]))
        return 180.0 if found <= -180 + 1e-9 else found

    def within_unit(self) -> dict[str, complex]:
        """Return flows and efforts, each divided by the largest of its own unit.

        Returns
        -------
        dict of str to complex
            Phases stay.
        """
        return {
            name: value / (largest or 1.0)
            for part in (self.flows, self.efforts)
            for name, value in part.items()
            for largest in [
                max(abs(v) for n, v in part.items() if self.units.get(n) == self.units.get(name))
            ]
        }


def mode_shapes(system: LinearSystem) -> tuple[ModeShape, ...]:
    """Return the shape of every mode.

    Parameters
    ----------
    system : LinearSystem

    Returns
    -------
    tuple of ModeShape
        In the order of ``system.poles()``.

    References
    ----------
    Karnopp, Margolis, Rosenberg, System Dynamics, ch. 9: eigenvectors of states.

    Examples
    --------
    Two equal masses on three equal springs move against each other or, slower, together:

    >>> from bondgraph import C, I, One, Zero, assemble, linearize
    >>> a, b, middle = One("a"), One("b"), Zero("middle")
    >>> ends = a >> (I("m_a", 1), C("k_a", 1)), b >> (I("m_b", 1), C("k_b", 1))
    >>> graph = assemble("pair", *ends, a >> middle >> b, middle >> C("k", 1))
    >>> shapes = mode_shapes(linearize(graph))
    >>> [round(shape.flows["b"].real, 9) for shape in shapes if abs(shape.pole) > 1e-6]
    [-1.0, 1.0, 1.0, -1.0]
    """
    graph = system.at.equations.graph
    ones = [name for name, _ in graph.of(One)]
    zeros = [name for name, _ in graph.of(Zero)]
    ports = system.at.equations.ports
    rows = [*(ports[f"{name}.f"] for name in ones), *(ports[f"{name}.e"] for name in zeros)]
    known = infer(graph).units
    labels = [f"{name}.f" for name in ones] + [f"{name}.e" for name in zeros]
    units = MappingProxyType(
        {name: known.get(label) or "" for name, label in zip((*ones, *zeros), labels, strict=True)}
    )
    poles, vectors = system.poles(), _without_noise(system, system.shapes())
    matrix = slopes(system.at, rows).states if rows and len(poles) else numpy.zeros((len(rows), 0))
    return tuple(
        ModeShape(
            complex(pole),
            _named(ones, _normal(matrix[: len(ones)], vector)),
            _named(zeros, _normal(matrix[len(ones) :], vector)),
            units,
        )
        for pole, vector in zip(poles, vectors.T, strict=True)
    )


def _without_noise(system: LinearSystem, vectors: numpy.ndarray) -> numpy.ndarray:
    """Put components of eigenvectors at zero whose energy is that of rounding.

    Measured by the root of the energy that they stand for, states of all kinds compare.
    """
    equations = system.at.equations
    stored = {
        place: name
        for place, name in enumerate(state.rpartition(".")[0] for state in system.states)
        if isinstance(equations.graph.elements.get(name), Storage)
    }
    if not stored or not vectors.size:
        return vectors
    coenergies = [
        port_of(equations, name, equations.graph[name].coenergy) for name in stored.values()
    ]
    places = list(stored)
    stiffness = numpy.abs(slopes(system.at, coenergies).states[range(len(places)), places])
    sizes = numpy.zeros(vectors.shape)
    sizes[places] = numpy.sqrt(stiffness)[:, None] * numpy.abs(vectors[places])
    held = numpy.zeros(len(vectors), dtype=bool)
    held[places] = stiffness > 0
    faint = held[:, None] & (sizes <= NOISE * sizes.max(axis=0))
    return numpy.where(faint, 0.0, vectors)


def _normal(matrix: numpy.ndarray, vector: numpy.ndarray) -> numpy.ndarray:
    """Return variations whose largest is one; what is no more than rounding is zero."""
    values = matrix @ vector
    values = numpy.where(
        numpy.abs(values) > NOISE * (numpy.abs(matrix) @ numpy.abs(vector)), values, 0.0
    )
    if not (numpy.abs(values) > TINY).any():
        return numpy.zeros(len(values), dtype=complex)
    # of several that are equal but for the last bit, the first is the one with phase zero
    sizes = numpy.abs(values)
    first = numpy.argmax(sizes >= (1 - 1e-9) * sizes.max())
    found = values / values[first]
    found[first] = 1.0
    return found


def _named(names: list[str], values: numpy.ndarray) -> Mapping[str, complex]:
    return MappingProxyType({n: complex(v) for n, v in zip(names, values, strict=True)})
