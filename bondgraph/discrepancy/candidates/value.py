"""An effect as a frozen value: where it fits, its law, its parameters and how it is built."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import sympy

from ...errors import LawError
from .features import Feature, Shape
from .place import Change, Place
from .places import KINDS

FLOW = sympy.Symbol("f", real=True)
EFFORT = sympy.Symbol("e", real=True)
DISPLACEMENT = sympy.Symbol("q", real=True)
MOMENTUM = sympy.Symbol("p", real=True)
SIGNAL = sympy.Symbol("u", real=True)
MEMORY = sympy.Symbol("z", real=True)

Build = Callable[[Place, Mapping[str, sympy.Expr], Mapping[str, sympy.Symbol]], Change]


@dataclass(frozen=True)
class Scale:
    """How large things are in the data, all positive and in SI; starting values come from it.

    Examples
    --------
    >>> Scale(effort=20, flow=2).duration
    1.0
    """

    effort: float = 1.0
    flow: float = 1.0
    displacement: float = 1.0
    duration: float = 1.0


@dataclass(frozen=True)
class Coefficient:
    """One parameter of an effect.

    Parameters
    ----------
    name : str
        A plain word.
    unit : str
        In braces ``{e}``, ``{f}``, ``{q}`` and ``{p}`` for the units of effort, flow, displacement
        and momentum at the site, ``{u}`` for that of the signal, such as ``"{e}/({f})"``.
    meaning : str
    start : callable
        From a `Scale` to a first value, SI.
    absent : float or None
        The value, zero or infinity, at which the effect is gone; None where the effect is gone
        by other parameters. All that have one take it together.
    linear : bool
        Whether the effect is proportional to it at small values: the score test's coefficient.
    signed : bool
        Whether negative values are physical.
    numerical : bool
        Whether it only keeps the law smooth: fits leave it where it starts.

    Examples
    --------
    >>> b = Coefficient("damping", "{e}/({f})", "viscous damping", lambda s: s.effort / s.flow, 0.0)
    >>> b.symbol.is_nonnegative, b.start(Scale(effort=4, flow=2))
    (True, 2.0)
    """

    name: str
    unit: str
    meaning: str
    start: Callable[[Scale], float]
    absent: float | None = None
    linear: bool = False
    signed: bool = False
    numerical: bool = False

    @property
    def symbol(self) -> sympy.Symbol:
        """The symbol that stands for it in the effect's law."""
        if self.signed:
            return sympy.Symbol(self.name, real=True)
        if self.absent == 0:
            return sympy.Symbol(self.name, nonnegative=True)
        return sympy.Symbol(self.name, positive=True)


@dataclass(frozen=True)
class Effect:
    """A physical effect that may be missing from a model.

    Parameters
    ----------
    name : str
    sites : tuple of str
        Kinds of site it fits; see `bondgraph.discrepancy.candidates.places`.
    coefficients : tuple of Coefficient
    law : mapping of str to Expr
        What is decided (``effort``, ``flow``, ``energy``, ``signal``, ``kinetic`` ...) to an
        expression in FLOW, EFFORT, DISPLACEMENT, MOMENTUM, SIGNAL, MEMORY and coefficients.
    build : callable
        ``build(place, law, symbols)``: makes the `Change`, given the law and the coefficients in
        the symbols of the graph that grows.
    meaning : str
        In a few words.
    reference : str
        Book or paper that has the law.
    domains : tuple of str
        Empty for any.
    features : tuple of Feature
        What the latent effort or flow is regressed on, one for each linear coefficient: at
        junctions and pairs what the effect takes, at sources and outputs what it adds, at an
        inertia what it adds to the flow, at a dissipator the share by which it weakens.
    shapes : tuple of Shape
        The same for laws with widths or thresholds, several of them with different ones.
    states : tuple of str
        Meanings of the states that it adds; empty for a static effect.
    passive : bool
        Whether it can give no energy that it was not given, with admissible coefficients.
    events : bool
        Whether it switches at located events.
    impacts : bool
        Whether states jump there.
    periodic : bool
        Whether another displacement to begin with is the same as other coefficients.
    limits : tuple of str
        Simpler effects that it comes down to at a limit of its coefficients, whose names they share.

    Raises
    ------
    LawError
        For an unknown kind of site, a law in unknown symbols, or two coefficients of one name.

    Examples
    --------
    >>> from bondgraph.discrepancy.candidates import EFFECTS
    >>> EFFECTS["quadratic_drag"].law["effort"]
    drag*f*Abs(f)
    """

    name: str
    sites: tuple[str, ...]
    coefficients: tuple[Coefficient, ...]
    law: Mapping[str, sympy.Expr]
    build: Build = field(repr=False)
    meaning: str
    reference: str
    domains: tuple[str, ...] = ()
    features: tuple[Feature, ...] = ()
    shapes: tuple[Shape, ...] = ()
    states: tuple[str, ...] = ()
    passive: bool = True
    events: bool = False
    impacts: bool = False
    periodic: bool = False
    limits: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        unknown = [kind for kind in self.sites if kind not in KINDS]
        if unknown or not self.sites:
            raise LawError(
                f"effect {self.name!r}: {unknown or 'nothing'} is no kind of site; use {', '.join(KINDS)}"
            )
        names = [item.name for item in self.coefficients]
        if len(set(names)) != len(names):
            raise LawError(f"effect {self.name!r} has two coefficients of one name; rename one")
        known = {FLOW, EFFORT, DISPLACEMENT, MOMENTUM, SIGNAL, MEMORY, *self.symbols.values()}
        for key, law in self.law.items():
            if strange := sorted(map(str, law.free_symbols - known)):
                raise LawError(
                    f"effect {self.name!r}, {key}: {', '.join(strange)} is no coefficient and no port "
                    f"variable; add a Coefficient or use FLOW, EFFORT, DISPLACEMENT ..."
                )
        object.__setattr__(self, "law", MappingProxyType(dict(self.law)))

    @property
    def symbols(self) -> dict[str, sympy.Symbol]:
        """Symbols of the coefficients in the law, by name."""
        return {item.name: item.symbol for item in self.coefficients}

    @property
    def static(self) -> bool:
        """Whether it adds no state."""
        return not self.states

    @property
    def fitted(self) -> tuple[str, ...]:
        """Coefficients that data tell: all but those that keep the law smooth."""
        return tuple(item.name for item in self.coefficients if not item.numerical)

    @property
    def absent(self) -> dict[str, float]:
        """Values by coefficient at which the effect is gone."""
        return {item.name: item.absent for item in self.coefficients if item.absent is not None}

    @property
    def linear(self) -> tuple[str, ...]:
        """Coefficients that the effect is proportional to, all of them absent at zero."""
        return tuple(item.name for item in self.coefficients if item.linear)

    @property
    def forms(self) -> tuple[Shape, ...]:
        """The shapes; of an effect without any, one of all features."""
        if self.shapes or not self.features:
            return self.shapes
        names = self.linear or tuple(self.symbols)
        signed = any(item.signed for item in self.coefficients)
        return (Shape(self.features, lambda a, _: dict(zip(names, a, strict=False)), signed),)

    def start(self, scale: Scale | None = None) -> dict[str, float]:
        """Return first values of the coefficients, SI.

        Parameters
        ----------
        scale : Scale, optional
            Ones unless given.
        """
        return {item.name: float(item.start(scale or Scale())) for item in self.coefficients}

    def physical(self, values: Mapping[str, Any]) -> tuple[str, ...]:
        """Return the coefficients whose sign no physical element of this kind can have.

        Parameters
        ----------
        values : mapping of str to float
            By coefficient.

        Returns
        -------
        tuple of str
            Names; empty where all are physical.
        """
        return tuple(
            item.name
            for item in self.coefficients
            if not item.signed and item.name in values and not values[item.name] >= 0
        )
