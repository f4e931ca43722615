"""Sensitivity: how every eigenvalue moves with every parameter, exactly."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy
import sympy

from ..linear import LinearSystem
from ..parameters import Parameter
from ..smooth import in_dependence
from ..steady import SteadyState
from .derivatives import Derivatives, Forms

Array = numpy.ndarray

# Rounding parts a double eigenvalue by the root of what it moves a simple one: nearer to another one
# than this share of the largest, an eigenvalue has no derivative to speak of.
APART = 3e-7
# Beside the terms it is made of: what is left of a rate that no state can make up for.
LEFT = 1e-8


@dataclass(frozen=True)
class Effect:
    """What a change of one parameter does to one eigenvalue, to first order.

    Attributes
    ----------
    parameter : str
    value : float
        Of the parameter, SI.
    unit : str
        The parameter's own unit, for display.
    meaning : str
    derivative : complex
        Of the eigenvalue by the parameter, 1/s per SI unit.
    derived : bool
        Whether the parameter's table derives it from others, which stay as they are here.

    Examples
    --------
    >>> softer = Effect("k", 8.0, "N/m", "spring", 0.125j, False)
    >>> round(softer.frequency(-0.1) * 2 * math.pi, 9), softer.growth(-0.1)
    (-0.1, -0.0)
    """

    parameter: str
    value: float
    unit: str
    meaning: str
    derivative: complex
    derived: bool

    @property
    def weight(self) -> float:
        """Size of the change for a relative change of one, 1/s."""
        return abs(self.derivative * self.value)

    def growth(self, change: float) -> float:
        """Return the change of the growth rate for a relative change of the parameter, 1/s."""
        return (self.derivative * self.value * change).real

    def frequency(self, change: float) -> float:
        """Return the change of the frequency for a relative change of the parameter, Hz."""
        return (self.derivative * self.value * change).imag / (2 * math.pi)


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Derivatives of all eigenvalues by all parameters and inputs.

    The steady state moves along: the derivatives are those of the whole way from parameter to
    eigenvalue. Parameters that the table derives from others follow these; one of them moved
    alone takes along only what is derived from it in turn.

    Attributes
    ----------
    names : tuple of str
        Parameters with a value, then inputs.
    values : (np,) array
        SI.
    units : tuple of str
        Each parameter's own, for display.
    meanings : tuple of str
    derived : tuple of bool
    eigenvalues : (n,) complex array
        As `LinearSystem.poles` orders them.
    derivatives : (n, np) complex array
        1/s per SI unit; nan where there is none.
    notes : tuple of str
        Why there is none.

    References
    ----------
    Lancaster, On eigenvalues of matrices dependent on a parameter, Numerische Mathematik 6 (1964)
    377-387.
    """

    names: tuple[str, ...]
    values: Array
    units: tuple[str, ...]
    meanings: tuple[str, ...]
    derived: tuple[bool, ...]
    eigenvalues: Array
    derivatives: Array
    notes: tuple[str, ...] = field(default_factory=tuple)

    def of(self, name: str) -> Array:
        """Return the derivative of each eigenvalue by one parameter, (n,) complex array."""
        return numpy.asarray(self.derivatives[:, self.names.index(name)])

    def moving(self) -> tuple[str, ...]:
        """Return what moves any eigenvalue or may, without what the table derives from others."""
        named = {item.parameter for k in range(len(self.eigenvalues)) for item in self.ranked(k)}
        unknown = ~numpy.isfinite(self.derivatives).all(axis=0)
        named |= {name for name, may in zip(self.names, unknown, strict=True) if may}
        return tuple(
            name
            for name, derived in zip(self.names, self.derived, strict=True)
            if name in named and not derived
        )

    def ranked(self, index: int, *, derived: bool = True, by: str = "both") -> tuple[Effect, ...]:
        """Return what moves an eigenvalue, by falling effect of equal relative changes.

        Parameters
        ----------
        index : int
            Of the eigenvalue.
        derived : bool
            Whether to include parameters that others give, moved alone.
        by : {"both", "growth", "frequency"}
            What counts: the whole move, or that of the real or imaginary part.

        Returns
        -------
        tuple of Effect
            Without those that do nothing.
        """
        pick = {"both": abs, "growth": lambda z: abs(z.real), "frequency": lambda z: abs(z.imag)}
        size = pick[by]
        found = [
            Effect(name, float(value), unit, meaning, complex(slope), is_derived)
            for name, value, unit, meaning, is_derived, slope in zip(
                self.names,
                self.values,
                self.units,
                self.meanings,
                self.derived,
                self.derivatives[index],
                strict=True,
            )
            if numpy.isfinite(slope) and (derived or not is_derived)
        ]
        scale = max(abs(self.eigenvalues).max(initial=0.0), 1e-300)
        told = [item for item in found if size(item.derivative * item.value) > 1e-12 * scale]
        return tuple(sorted(told, key=lambda item: -size(item.derivative * item.value)))

    def to_json(self) -> list[dict[str, Any]]:
        """Return rows by parameter, derivatives by eigenvalue; None where there is none."""
        return [
            {
                "parameter": name,
                "value": float(self.values[k]),
                "derived": self.derived[k],
                "d_growth": [_number(z.real) for z in self.derivatives[:, k]],
                "d_frequency_hz": [_number(z.imag / (2 * math.pi)) for z in self.derivatives[:, k]],
            }
            for k, name in enumerate(self.names)
        ]


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def sensitivities(
    system: LinearSystem, forms: Forms, overrides: Mapping[str, Any] | None = None
) -> Sensitivities:
    """Differentiate every eigenvalue by every parameter and input.

    Parameters
    ----------
    system : LinearSystem
        About a steady state.
    forms : Forms
        Of the same equations, with every parameter held.
    overrides : mapping, optional
        Parameters given as numbers by name: those of the table's derived ones among them do not
        follow others.

    Returns
    -------
    Sensitivities

    Notes
    -----
    With right and left eigenvectors v and w of the pencil J v = lambda M v, the derivative is
    w (dJ) v / (w M v), where dJ contains how the steady state moves.

    Examples
    --------
    >>> import sympy
    >>> from bondgraph import C, I, One, R, assemble, linearize
    >>> from bondgraph.smooth import Smooth
    >>> k = sympy.Symbol("k", positive=True)
    >>> parts = (I("m", 2), C("spring", stiffness=k), R("b", 0.5))
    >>> graph = assemble("osc", One("v") >> parts, parameters={k: (8, "N/m")})
    >>> system = linearize(graph)
    >>> found = sensitivities(system, Forms(Smooth(system.at.equations, graph, held=["k"])))
    >>> found.of("k").round(9).tolist()
    [0.125244858j, -0.125244858j]
    """
    point = system.at
    smooth = forms.smooth
    at = forms.at(point.vector, list(point.inputs.values()), smooth.vector(point.parameters))
    n, inputs = len(at.x), len(at.u)
    notes: list[str] = []
    moved, still = _moved(at, point, smooth.names, notes)
    poles, right, left = _vectors(system, at)
    gradients = numpy.zeros((len(poles), inputs + len(at.p)), dtype=complex)
    for k in range(len(poles)):
        whole = at.gradient(left[:, k], right[:, k])
        gradients[k] = whole[n:] + whole[:n] @ moved
    close = _close(poles)
    if close.any():
        told = ", ".join(f"{pole:.4g}" for pole in poles[close])
        notes.append(f"eigenvalues that stand together have no derivatives of their own: {told}")
    gradients[close] = numpy.nan
    table = _Table(point, overrides or {})
    by_parameter = table.chained(gradients[:, inputs:], smooth.names)
    lost = {name for name, fine in zip(smooth.names, still[inputs:], strict=True) if not fine}
    names = [name for name in smooth.names if math.isfinite(point.parameters.get(name, math.nan))]
    for place, name in enumerate(smooth.names):
        if table.reaches(name, lost):
            by_parameter[:, place] = numpy.nan
    keep = [smooth.names.index(name) for name in names]
    rows = {symbol.name: row for symbol, row in point.equations.graph.parameters.items()}
    by_input = numpy.where(still[:inputs], gradients[:, :inputs], numpy.nan)
    units = {symbol.name: unit for symbol, unit in point.equations.graph.inputs.items()}
    values = [*(point.parameters[name] for name in names), *point.inputs.values()]
    return Sensitivities(
        (*names, *point.inputs),
        numpy.array(values, dtype=float),
        (*(rows[name].unit for name in names), *(units.get(name, "") for name in point.inputs)),
        (*(rows[name].meaning for name in names), *("" for _ in point.inputs)),
        (*(table.follows(name) for name in names), *(False for _ in point.inputs)),
        poles,
        numpy.hstack([by_parameter[:, keep], by_input]),
        tuple(notes),
    )


def _moved(
    at: Derivatives, point: SteadyState, parameters: tuple[str, ...], notes: list[str]
) -> tuple[Array, Array]:
    """Return how the steady state moves with inputs and parameters, and with which it lasts."""
    import scipy.linalg

    slopes = numpy.nan_to_num(at.by_arguments)
    if not len(at.x):
        return numpy.zeros((0, slopes.shape[1])), numpy.ones(slopes.shape[1], dtype=bool)
    balanced, transform = scipy.linalg.matrix_balance(at.jacobian, permute=False)
    scale = numpy.diag(transform)
    right = slopes / scale[:, None]
    found, _, rank, _ = numpy.linalg.lstsq(balanced, -right, rcond=1e-12)
    lasts = numpy.ones(slopes.shape[1], dtype=bool)
    if rank < len(balanced):
        left = numpy.abs(balanced @ found + right).max(axis=0)
        lasts = left <= LEFT * numpy.maximum(numpy.abs(right).max(axis=0), 1e-300)
        if not lasts.all():
            names = [*point.inputs, *parameters]
            told = ", ".join(name for name, good in zip(names, lasts, strict=True) if not good)
            notes.append(f"with a change of {told} there is no steady state any more")
    return found * scale[:, None], lasts


def _vectors(system: LinearSystem, at: Derivatives) -> tuple[Array, Array, Array]:
    """Return poles, and right and left vectors of the whole pencil, with their product one."""
    order = len(system.states)
    poles, right, left = system.poles(), system.shapes(), system.left_shapes()
    if len(at.x) > order:
        j = at.jacobian
        inner = j[order:, order:]
        right = numpy.vstack([right, -numpy.linalg.solve(inner, j[order:, :order] @ right)])
        left = numpy.vstack([left, -numpy.linalg.solve(inner.T, j[:order, order:].T @ left)])
    with numpy.errstate(divide="ignore", invalid="ignore"):
        left = left / (left[:order] * right[:order]).sum(axis=0)
    return poles, right, numpy.nan_to_num(left)


def _close(poles: Array) -> Array:
    """Tell which eigenvalues have another one beside them."""
    if len(poles) < 2:
        return numpy.zeros(len(poles), dtype=bool)
    apart = numpy.abs(poles[:, None] - poles[None, :])
    numpy.fill_diagonal(apart, numpy.inf)
    return numpy.asarray(apart.min(axis=1) <= APART * numpy.abs(poles).max())


class _Table:
    """The parameter table as the way along which a change spreads."""

    def __init__(self, point: SteadyState, overrides: Mapping[str, Any]) -> None:
        self.values = point.parameters
        table: Mapping[sympy.Symbol, Parameter] = point.equations.graph.parameters
        derived = [
            symbol
            for symbol, row in table.items()
            if row.derived
            and symbol.name not in overrides
            and math.isfinite(self.values.get(symbol.name, math.nan))
        ]
        self.order = [(symbol, table[symbol].value) for symbol in in_dependence(derived, table)]
        self._derived = {symbol.name for symbol in derived}

    def follows(self, name: str) -> bool:
        """Whether a parameter is derived from others."""
        return name in self._derived

    def reaches(self, name: str, among: set[str]) -> bool:
        """Whether a parameter is one of some, or one of them is derived from it."""
        reached = {name}
        for symbol, expression in self.order:
            if reached & {inner.name for inner in expression.free_symbols}:
                reached.add(symbol.name)
        return bool(reached & among)

    def chained(self, slopes: Array, names: tuple[str, ...]) -> Array:
        """Return derivatives by each parameter with those that are derived from it following."""
        whole = slopes.copy()
        place = {name: index for index, name in enumerate(names)}
        for symbol, expression in reversed(self.order):
            for inner in expression.free_symbols:
                given = {item: self.values[item.name] for item in expression.free_symbols}
                slope = float(sympy.diff(expression, inner).evalf(17, subs=given))
                whole[:, place[inner.name]] += whole[:, place[symbol.name]] * slope
        return whole
