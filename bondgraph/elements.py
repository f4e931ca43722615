"""Elements: frozen values that know their ports and their laws.

One-ports Se, Sf, R, C, I and Friction; two-ports TF and GY; junctions Zero and
One. Elements compare by identity: two ``One("v")`` are two junctions.

Every port variable and state is a sympy symbol (``x.e``, ``x.f``, ``c.q``,
``m.p``) that any other law may use: that is modulation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import Field, dataclass, fields
from typing import Any, ClassVar, Self

import sympy

from .bonds import Joinable
from .errors import GraphError, LawError
from .laws import exact, regularised

EFFORT = "effort"
FLOW = "flow"
LARGEST_EXPANSION = 4  # of a power of a sum, when a law is integrated


def _check_name(kind: str, name: Any) -> None:
    if not isinstance(name, str) or not name.strip():
        raise GraphError(f"{kind} needs a name, got {name!r}; give it a short word such as {kind}('damper', ...)")
    if "." in name or ">" in name:
        raise GraphError(f"{kind} {name!r}: '.' and '>' are kept for qualified names; use '_' instead")


def _variable(name: str) -> sympy.Dummy:
    return sympy.Dummy(name, real=True)


def _is_variable(field: Field[Any]) -> bool:
    """Whether a field holds a variable of the element itself: a law may be another's bare symbol."""
    return field.type == "sympy.Dummy"


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Element(Joinable):
    """Base of all elements: a name, symbols and law expressions.

    Attributes
    ----------
    name : str
        Unique within the graph that holds the element.
    """

    name: str
    kind: ClassVar[str] = "element"

    def _set(self, **values: Any) -> None:
        for key, value in values.items():
            object.__setattr__(self, key, value)

    def __repr__(self) -> str:
        return f"{self.kind}({self.name!r})"

    @property
    def symbols(self) -> dict[str, sympy.Dummy]:
        """Port variables and states by attribute name, as other laws use them."""
        return {field.name: getattr(self, field.name) for field in fields(self) if _is_variable(field)}

    @property
    def laws(self) -> dict[str, sympy.Expr]:
        """Law expressions by attribute name."""
        values = {field.name: getattr(self, field.name) for field in fields(self) if not _is_variable(field)}
        return {key: value for key, value in values.items() if isinstance(value, sympy.Expr)}

    def replaced(self, replacements: Mapping[sympy.Basic, sympy.Basic], name: str | None = None) -> Self:
        """Return a new element of the same kind with symbols exchanged throughout.

        Parameters
        ----------
        replacements : mapping of Symbol to Expr
            Applied to the element's own symbols and to its laws.
        name : str, optional
            The copy's name.
        """
        twin = object.__new__(type(self))
        for field in fields(self):
            value = getattr(self, field.name)
            object.__setattr__(
                twin, field.name, value.xreplace(replacements) if isinstance(value, sympy.Basic) else value
            )
        if name is not None:
            object.__setattr__(twin, "name", name)
        return twin


@dataclass(frozen=True, eq=False, init=False, repr=False)
class OnePort(Element):
    """An element with one power port.

    Attributes
    ----------
    e, f : Symbol
        Effort and flow at the port; a passive element takes the power ``e f``.
    """

    e: sympy.Dummy
    f: sympy.Dummy
    passive: ClassVar[bool] = True

    def _ports(self, name: str) -> None:
        _check_name(self.kind, name)
        self._set(name=name, e=_variable(f"{name}.e"), f=_variable(f"{name}.f"))

    def _apply(self, what: str, law: Any, argument: sympy.Symbol) -> sympy.Expr:
        """Evaluate a law given as a function, or take it as an expression."""
        try:
            return exact(law(argument) if callable(law) else law)
        except LawError as error:
            raise LawError(f"{self.kind} {self.name!r}, {what}: {error}", elements=[self.name]) from None

    def _one_of(self, **given: Any) -> tuple[str, Any]:
        """Return the one law that was given, by keyword."""
        chosen = [(key, value) for key, value in given.items() if value is not None]
        if len(chosen) != 1:
            options = ", ".join(given)
            said = "none was" if not chosen else f"{' and '.join(key for key, _ in chosen)} were"
            raise LawError(
                f"{self.kind} {self.name!r} takes exactly one of {options}; {said} given", elements=[self.name]
            )
        return chosen[0]


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Se(OnePort):
    """Source of effort.

    Parameters
    ----------
    name : str
    effort : number, Expr
        May use time, parameters, inputs and port variables (modulated: MSe).

    Examples
    --------
    >>> Se("battery", 12).effort
    12
    """

    effort: sympy.Expr
    kind: ClassVar[str] = "Se"
    passive: ClassVar[bool] = False

    def __init__(self, name: str, effort: Any) -> None:
        self._ports(name)
        self._set(effort=self._apply("effort", effort, self.f))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Sf(OnePort):
    """Source of flow.

    Parameters
    ----------
    name : str
    flow : number, Expr
        May use time, parameters, inputs and port variables (modulated: MSf).

    Examples
    --------
    >>> Sf("road", 0.5).flow
    1/2
    """

    flow: sympy.Expr
    kind: ClassVar[str] = "Sf"
    passive: ClassVar[bool] = False

    def __init__(self, name: str, flow: Any) -> None:
        self._ports(name)
        self._set(flow=self._apply("flow", flow, self.e))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class R(OnePort):
    """Dissipator: effort and flow at the same instant.

    Parameters
    ----------
    name : str
    resistance : number, Expr, optional
        Linear: ``e = resistance f``.
    effort : callable, optional
        ``effort=lambda f: ...``, the effort as a function of the flow.
    flow : callable, optional
        ``flow=lambda e: ...``, the flow as a function of the effort.

    Attributes
    ----------
    effort, flow : Expr or None
        The law in each form, in the symbols ``f`` and ``e``; None where the
        law is not known in that form.

    Raises
    ------
    LawError
        Unless exactly one law is given.

    Examples
    --------
    >>> pad = R("pad", effort=lambda f: f**3)
    >>> pad.flow is None
    True
    """

    effort: sympy.Expr | None
    flow: sympy.Expr | None
    kind: ClassVar[str] = "R"

    def __init__(
        self,
        name: str,
        resistance: Any = None,
        *,
        effort: Callable[[Any], Any] | None = None,
        flow: Callable[[Any], Any] | None = None,
    ) -> None:
        self._ports(name)
        key, law = self._one_of(resistance=resistance, effort=effort, flow=flow)
        if key == "resistance":
            value = self._apply(key, law, self.f)
            self._set(effort=value * self.f, flow=None if value == 0 else self.e / value)
        elif key == "effort":
            self._set(effort=self._apply(key, law, self.f), flow=None)
            self._set(flow=_inverse(self.effort, self.f, self.e))
        else:
            self._set(effort=None, flow=self._apply(key, law, self.e))
            self._set(effort=_inverse(self.flow, self.e, self.f))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Storage(OnePort):
    """Energy storage: a state, its co-energy variable and an energy.

    Attributes
    ----------
    law : Expr
        Co-energy variable (C: effort, I: flow) as a function of the state.
    inverse : Expr or None
        State as a function of the co-energy variable, where it is known.
    energy : Expr or None
        Stored energy as a function of the state, where it is known.
    initial : Expr
        Default initial state, in parameters.
    """

    law: sympy.Expr
    inverse: sympy.Expr | None
    energy: sympy.Expr | None
    initial: sympy.Expr

    @property
    def state(self) -> sympy.Dummy:
        """The state's symbol."""
        raise NotImplementedError

    @property
    def coenergy(self) -> sympy.Dummy:
        """The port variable that the state decides: e of a C, f of an I."""
        raise NotImplementedError

    def _store(self, key: str, law: Any, forms: Mapping[str, str], initial: Any) -> None:
        state, conjugate = self.state, self.coenergy
        value = self._apply(key, law, state)
        form = forms[key]
        if form == "compliant":
            if value == 0:
                raise LawError(f"{self.kind} {self.name!r}: {key} is zero; leave the element out", elements=[self.name])
            self._set(law=state / value, inverse=conjugate * value, energy=state**2 / (2 * value))
        elif form == "stiff":
            self._set(
                law=state * value, inverse=None if value == 0 else conjugate / value, energy=value * state**2 / 2
            )
        elif form == "law":
            self._set(law=value, inverse=_inverse(value, state, conjugate), energy=_potential(value, state))
        else:
            law_of_energy = sympy.diff(value, state)
            self._set(law=law_of_energy, inverse=_inverse(law_of_energy, state, conjugate), energy=value)
        self._set(initial=self._apply("initial", initial, state))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class C(Storage):
    """Compliance: stores displacement ``q``, decides effort.

    Parameters
    ----------
    name : str
    capacitance : number, Expr, optional
        Linear: ``e = q / capacitance``.
    stiffness : number, Expr, optional
        Linear: ``e = stiffness q``.
    effort : callable, optional
        ``effort=lambda q: ...``.
    energy : callable, optional
        ``energy=lambda q: ...``; the effort is its derivative.
    initial : number, Expr
        Initial displacement, zero unless given.

    Raises
    ------
    LawError
        Unless exactly one law is given.

    Examples
    --------
    >>> spring = C("spring", energy=lambda q: q**2 / 2 + q**4 / 4)
    >>> spring.law.subs(spring.q, 2)
    10
    """

    q: sympy.Dummy
    kind: ClassVar[str] = "C"

    def __init__(
        self,
        name: str,
        capacitance: Any = None,
        *,
        stiffness: Any = None,
        effort: Callable[[Any], Any] | None = None,
        energy: Callable[[Any], Any] | None = None,
        initial: Any = 0,
    ) -> None:
        self._ports(name)
        self._set(q=_variable(f"{name}.q"))
        key, law = self._one_of(capacitance=capacitance, stiffness=stiffness, effort=effort, energy=energy)
        forms = {"capacitance": "compliant", "stiffness": "stiff", "effort": "law", "energy": "energy"}
        self._store(key, law, forms, initial)

    @property
    def state(self) -> sympy.Dummy:
        """Displacement q."""
        return self.q

    @property
    def coenergy(self) -> sympy.Dummy:
        """Effort e."""
        return self.e


@dataclass(frozen=True, eq=False, init=False, repr=False)
class I(Storage):  # noqa: E742 - the field's name for inertia
    """Inertia: stores momentum ``p``, decides flow.

    Parameters
    ----------
    name : str
    inertance : number, Expr, optional
        Linear: ``f = p / inertance``.
    flow : callable, optional
        ``flow=lambda p: ...``.
    energy : callable, optional
        ``energy=lambda p: ...``; the flow is its derivative.
    initial : number, Expr
        Initial momentum, zero unless given.

    Raises
    ------
    LawError
        Unless exactly one law is given.

    Examples
    --------
    >>> mass = I("mass", 4)
    >>> mass.law.subs(mass.p, 2)
    1/2
    """

    p: sympy.Dummy
    kind: ClassVar[str] = "I"

    def __init__(
        self,
        name: str,
        inertance: Any = None,
        *,
        flow: Callable[[Any], Any] | None = None,
        energy: Callable[[Any], Any] | None = None,
        initial: Any = 0,
    ) -> None:
        self._ports(name)
        self._set(p=_variable(f"{name}.p"))
        key, law = self._one_of(inertance=inertance, flow=flow, energy=energy)
        self._store(key, law, {"inertance": "compliant", "flow": "law", "energy": "energy"}, initial)

    @property
    def state(self) -> sympy.Dummy:
        """Momentum p."""
        return self.p

    @property
    def coenergy(self) -> sympy.Dummy:
        """Flow f."""
        return self.f


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Friction(OnePort):
    """Dry friction: set-valued at zero slip, with modes stick, slip+ and slip-.

    Slipping, the effort is ``kinetic(|f|)`` along f. Stuck, f is zero and the
    effort is whatever keeps it so, up to ``breakaway``.

    Parameters
    ----------
    name : str
    kinetic : callable
        ``kinetic=lambda speed: ...``: magnitude of the effort at a slip speed
        of at least zero. May use parameters and port variables, such as the
        pressure that presses the pads.
    breakaway : number, Expr, optional
        Largest effort while stuck; ``kinetic(0)`` unless given.
    smoothing : number, Expr, optional
        Only for comparison: a slip width over which ``tanh`` replaces the
        jump. The element then has no modes and no real stick.

    References
    ----------
    Karnopp, Computer simulation of stick-slip friction in mechanical dynamic
    systems, J. Dyn. Sys. Meas. Control 107 (1985) 100-103.

    Examples
    --------
    >>> belt = Friction("belt", kinetic=lambda speed: 8, breakaway=12)
    >>> belt.breakaway
    12
    """

    speed: sympy.Dummy
    kinetic: sympy.Expr
    breakaway: sympy.Expr
    smoothing: sympy.Expr | None
    kind: ClassVar[str] = "Friction"

    def __init__(self, name: str, *, kinetic: Any, breakaway: Any = None, smoothing: Any = None) -> None:
        self._ports(name)
        self._set(speed=sympy.Dummy(f"{name}.speed", nonnegative=True))
        self._set(kinetic=self._apply("kinetic", kinetic, self.speed))
        highest = self.kinetic.xreplace({self.speed: sympy.S.Zero})
        self._set(breakaway=highest if breakaway is None else self._apply("breakaway", breakaway, self.speed))
        self._set(smoothing=None if smoothing is None else self._apply("smoothing", smoothing, self.speed))
        if self.smoothing is not None and self.smoothing.is_positive is False:
            raise LawError(f"Friction {name!r}: smoothing is a slip width and must be positive", elements=[name])
        if self.speed in self.breakaway.free_symbols:
            raise LawError(f"Friction {name!r}: breakaway acts at zero slip and cannot depend on speed; give a force")

    def slipping(self, direction: sympy.Expr) -> sympy.Expr:
        """Effort while slipping in ``direction`` (+1 or -1), as an expression in f."""
        return direction * self.kinetic.xreplace({self.speed: direction * self.f})

    def smoothed(self) -> sympy.Expr:
        """Effort of the smooth form, as an expression in f."""
        if self.smoothing is None:
            raise LawError(f"Friction {self.name!r} has no smoothing width", elements=[self.name])
        return regularised(self.kinetic, self.speed, self.f, self.smoothing)


@dataclass(frozen=True, eq=False, init=False, repr=False)
class TwoPort(Element):
    """Power-conserving two-port with one ratio.

    ``a >> TF("gear", n) >> b`` makes a the in side and b the out side.

    Attributes
    ----------
    e_in, f_in, e_out, f_out : Symbol
        Port variables, power taken at in and given at out.
    """

    e_in: sympy.Dummy
    f_in: sympy.Dummy
    e_out: sympy.Dummy
    f_out: sympy.Dummy
    ratio: sympy.Expr

    def __init__(self, name: str, ratio: Any) -> None:
        _check_name(self.kind, name)
        self._set(name=name)
        self._set(**{port: _variable(f"{name}.{port}") for port in ("e_in", "f_in", "e_out", "f_out")})
        try:
            self._set(ratio=exact(ratio))
        except LawError as error:
            raise LawError(f"{self.kind} {name!r}, ratio: {error}", elements=[name]) from None
        if self.ratio == 0:
            raise LawError(f"{self.kind} {name!r}: a ratio of zero joins nothing; remove the element", elements=[name])


@dataclass(frozen=True, eq=False, init=False, repr=False)
class TF(TwoPort):
    """Transformer: ``e_in = n e_out`` and ``f_out = n f_in``.

    Parameters
    ----------
    name : str
    ratio : number, Expr
        n; may use port variables and states (modulated: MTF).

    Examples
    --------
    >>> TF("gear", 0.2).ratio
    1/5
    """

    kind: ClassVar[str] = "TF"


@dataclass(frozen=True, eq=False, init=False, repr=False)
class GY(TwoPort):
    """Gyrator: ``e_in = r f_out`` and ``e_out = r f_in``.

    Parameters
    ----------
    name : str
    ratio : number, Expr
        r; may use port variables and states (modulated: MGY).

    Examples
    --------
    >>> GY("motor", 0.05).ratio
    1/20
    """

    kind: ClassVar[str] = "GY"


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Junction(Element):
    """Junction: one variable is shared by all bonds, the other sums to zero."""

    shared: ClassVar[str]


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Zero(Junction):
    """0-junction: one effort, flows sum to zero.

    Parameters
    ----------
    name : str

    Attributes
    ----------
    e : Symbol
        The shared effort.

    Examples
    --------
    >>> Zero("node").shared
    'effort'
    """

    e: sympy.Dummy
    kind: ClassVar[str] = "0"
    shared: ClassVar[str] = EFFORT

    def __init__(self, name: str) -> None:
        _check_name("Zero", name)
        self._set(name=name, e=_variable(f"{name}.e"))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class One(Junction):
    """1-junction: one flow, efforts sum to zero.

    Parameters
    ----------
    name : str

    Attributes
    ----------
    f : Symbol
        The shared flow.

    Examples
    --------
    >>> One("mass").shared
    'flow'
    """

    f: sympy.Dummy
    kind: ClassVar[str] = "1"
    shared: ClassVar[str] = FLOW

    def __init__(self, name: str) -> None:
        _check_name("One", name)
        self._set(name=name, f=_variable(f"{name}.f"))


def _inverse(law: sympy.Expr | None, argument: sympy.Symbol, value: sympy.Symbol) -> sympy.Expr | None:
    """Invert a law that is affine in its argument; None where it is not."""
    if law is None:
        return None
    slope = sympy.diff(law, argument)
    if slope == 0 or argument in slope.free_symbols:
        return None
    return (value - law.xreplace({argument: sympy.S.Zero})) / slope


def _potential(law: sympy.Expr, state: sympy.Symbol) -> sympy.Expr | None:
    """Integrate a polynomial law over the state; None for other laws, and where it would swell."""
    powers = [power for power in law.atoms(sympy.Pow) if state in power.base.free_symbols]
    swells = any(power.base != state and not _is_small(power.exp) for power in powers)
    if swells or not law.is_polynomial(state):
        return None
    return sympy.integrate(law, (state, 0, state))


def _is_small(exponent: sympy.Expr) -> bool:
    return bool(exponent.is_Integer and exponent <= LARGEST_EXPANSION)
