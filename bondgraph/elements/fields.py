"""Multiport fields: several ports that share one law, each bonded by its name.

Each port of a field is an element of its own, whose law names the variables of the
other ports. Causality is thus decided port by port, and a port that cannot have
the causality its law wants is worked out like any other.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Generic, TypeVar

import sympy

from ..errors import GraphError, LawError
from ..laws import affine_inverse, exact
from .base import Element, check_name
from .dissipators import R
from .matrices import inverse_of, is_symmetric
from .storage import C, I

P = TypeVar("P", bound=C | I | R)


class Field(Generic[P]):
    """Base of the multiport fields: a name, and an element for each port.

    Attributes
    ----------
    name : str
    ports : mapping of str to element
        In the order given; an element is bonded like any other, and is named
        ``field.port``.
    """

    kind = "field"

    def __init__(self, name: str, elements: Mapping[str, P]) -> None:
        self.name = name
        self.ports: Mapping[str, P] = elements

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r}, {list(self.ports)})"

    def __getitem__(self, port: str) -> P:
        """Return the element of one port, to be bonded."""
        try:
            return self.ports[port]
        except KeyError:
            raise GraphError(
                f"{type(self).__name__} {self.name!r} has no port {port!r}; it has {', '.join(self.ports)}",
                elements=[self.name],
            ) from None

    # Not iterable: a tuple fans out, and a field must not by accident.
    __iter__ = None


class _StorageField(Field[Any]):
    """A field of storages, from the energy that its ports share."""

    def __init__(
        self,
        name: str,
        ports: Mapping[str, type[C] | type[I]],
        energy: Callable[..., Any],
        initial: Mapping[str, Any] | None,
    ) -> None:
        names = _port_names(type(self).__name__, name, ports)
        start = dict(initial or {})
        unknown = [port for port in start if port not in names]
        if unknown:
            raise LawError(
                f"{type(self).__name__} {name!r}: initial names {', '.join(unknown)}; the ports are {', '.join(names)}",
                elements=[name],
            )
        states = {
            port: sympy.Dummy(f"{name}.{port}.{'q' if ports[port] is C else 'p'}", real=True)
            for port in names
        }
        shared = _evaluated(type(self).__name__, name, "energy", energy, states.values())
        super().__init__(
            name,
            {
                port: _storage_port(ports[port], f"{name}.{port}", port, states, shared, start)
                for port in names
            },
        )


def _storage_port(
    kind: type[C] | type[I],
    label: str,
    port: str,
    states: Mapping[str, sympy.Dummy],
    energy: sympy.Expr,
    initial: Mapping[str, Any],
) -> C | I:
    """Return one port of a storage field; the first one carries the energy of all."""
    element = kind("port", energy=lambda state: state**2, initial=initial.get(port, 0))
    own = states[port]
    element = element.replaced({element.state: own}, name=label)
    law = sympy.diff(energy, own)
    first = port == next(iter(states))
    element._set(
        e=sympy.Dummy(f"{label}.e", real=True),
        f=sympy.Dummy(f"{label}.f", real=True),
        law=law,
        energy=energy if first else sympy.S.Zero,
        partners=sympy.Tuple(*(state for state in states.values() if state is not own)),
    )
    others = law.free_symbols & {state for state in states.values() if state is not own}
    inverse = None if others else affine_inverse(law, own, element.coenergy)
    element._set(inverse=inverse)
    return element


class CField(_StorageField):
    """C-field: compliances that share one energy of their displacements.

    Parameters
    ----------
    name : str
    ports : iterable of str
        Names of the ports.
    stiffness : (n, n) matrix, optional
        Symmetric: ``e = stiffness q``.
    compliance : (n, n) matrix, optional
        Symmetric and invertible: ``q = compliance e``.
    energy : callable, optional
        ``energy=lambda q1, q2, ...: ...``, a displacement for each port; each
        effort is the derivative by its own displacement.
    initial : mapping of str to number or Expr, optional
        Initial displacement by port.

    Raises
    ------
    LawError
        Unless exactly one law is given; for a matrix that is not symmetric,
        which would not store energy but make it.

    References
    ----------
    Karnopp, Margolis, Rosenberg, System Dynamics, ch. 7: multiport fields.

    Examples
    --------
    >>> beam = CField("beam", ("tip", "middle"), stiffness=[[2, -5], [-5, 16]])
    >>> beam["tip"].law
    -5*_beam.middle.q + 2*_beam.tip.q
    """

    def __init__(
        self,
        name: str,
        ports: Iterable[str],
        *,
        stiffness: Any = None,
        compliance: Any = None,
        energy: Callable[..., Any] | None = None,
        initial: Mapping[str, Any] | None = None,
    ) -> None:
        names = tuple(ports)
        laws = {"stiffness": stiffness, "compliance": compliance, "energy": energy}
        law = _energy_of("CField", name, len(names), laws, inverted="compliance")
        super().__init__(name, dict.fromkeys(names, C), law, initial)


class IField(_StorageField):
    """I-field: inertias that share one energy of their momenta.

    Parameters
    ----------
    name : str
    ports : iterable of str
        Names of the ports.
    inertance : (n, n) matrix, optional
        Symmetric and invertible: ``p = inertance f``, such as mutual inductance.
    energy : callable, optional
        ``energy=lambda p1, p2, ...: ...``; each flow is its derivative.
    initial : mapping of str to number or Expr, optional
        Initial momentum by port.

    Raises
    ------
    LawError
        As for `CField`.

    Examples
    --------
    >>> coils = IField("coils", ("primary", "secondary"), inertance=[[2, 1], [1, 2]])
    >>> coils["primary"].law
    2*_coils.primary.p/3 - _coils.secondary.p/3
    """

    def __init__(
        self,
        name: str,
        ports: Iterable[str],
        *,
        inertance: Any = None,
        energy: Callable[..., Any] | None = None,
        initial: Mapping[str, Any] | None = None,
    ) -> None:
        names = tuple(ports)
        laws = {"inertance": inertance, "energy": energy}
        law = _energy_of("IField", name, len(names), laws, inverted="inertance")
        super().__init__(name, dict.fromkeys(names, I), law, initial)


class ICField(_StorageField):
    """Mixed field: an energy of displacements and momenta, as of a solenoid.

    Parameters
    ----------
    name : str
    ports : mapping of str to {"C", "I"}
        What each port is; in the order of the energy's arguments.
    energy : callable
        ``energy=lambda flux, gap: ...``: a displacement for each C port, a
        momentum for each I port.
    initial : mapping of str to number or Expr, optional
        Initial state by port.

    References
    ----------
    Karnopp, Margolis, Rosenberg, System Dynamics, ch. 8: energy-storing transducers.

    Examples
    --------
    >>> solenoid = ICField("solenoid", {"coil": "I", "gap": "C"}, energy=lambda flux, x: flux**2 * x / 2)
    >>> solenoid["coil"].law, solenoid["gap"].law
    (_solenoid.coil.p*_solenoid.gap.q, _solenoid.coil.p**2/2)
    """

    def __init__(
        self,
        name: str,
        ports: Mapping[str, str],
        *,
        energy: Callable[..., Any],
        initial: Mapping[str, Any] | None = None,
    ) -> None:
        kinds: dict[str, type[C] | type[I]] = {"C": C, "I": I}
        wrong = [f"{port}={kind!r}" for port, kind in ports.items() if kind not in kinds]
        if wrong:
            raise LawError(
                f"ICField {name!r}: a port is 'C' or 'I', not {', '.join(wrong)}", elements=[name]
            )
        super().__init__(name, {port: kinds[kind] for port, kind in ports.items()}, energy, initial)


class RField(Field[R]):
    """R-field: dissipation through several ports at once.

    Parameters
    ----------
    name : str
    ports : iterable of str
        Names of the ports.
    resistance : (n, n) matrix, optional
        ``e = resistance f``.
    conductance : (n, n) matrix, optional
        ``f = conductance e``.
    effort : callable, optional
        ``effort=lambda f1, f2, ...: (e1, e2, ...)``.
    flow : callable, optional
        ``flow=lambda e1, e2, ...: (f1, f2, ...)``, such as heat conduction
        between two temperatures, which makes entropy.

    Raises
    ------
    LawError
        Unless exactly one law is given, of one expression a port.

    Examples
    --------
    >>> g = 3
    >>> wall = RField("wall", ("hot", "cold"), flow=lambda t, u: (g * (t - u) / t, g * (u - t) / u))
    >>> wall["hot"].effort is None
    True
    """

    def __init__(
        self,
        name: str,
        ports: Iterable[str],
        *,
        resistance: Any = None,
        conductance: Any = None,
        effort: Callable[..., Sequence[Any]] | None = None,
        flow: Callable[..., Sequence[Any]] | None = None,
    ) -> None:
        names = _port_names("RField", name, ports)
        laws = {
            "resistance": resistance,
            "conductance": conductance,
            "effort": effort,
            "flow": flow,
        }
        key, law = _only_one("RField", name, laws)
        gives = "effort" if key in ("resistance", "effort") else "flow"
        elements = {port: R("port", effort=lambda f: f, flow=None) for port in names}
        for port, element in elements.items():
            label = f"{name}.{port}"
            element._set(
                name=label,
                e=sympy.Dummy(f"{label}.e", real=True),
                f=sympy.Dummy(f"{label}.f", real=True),
            )
        given = [element.f if gives == "effort" else element.e for element in elements.values()]
        if key in ("resistance", "conductance"):
            matrix = _square("RField", name, key, law, len(names))
            rows = list(matrix * sympy.Matrix(given))
        else:
            rows = _rows("RField", name, key, law, given)
        for element, own, row in zip(elements.values(), given, rows, strict=True):
            partners = sympy.Tuple(*(variable for variable in given if variable is not own))
            element._set(effort=None, flow=None, partners=partners)
            element._set(**{gives: row})
        super().__init__(name, elements)


def _port_names(kind: str, name: Any, ports: Iterable[str]) -> tuple[str, ...]:
    check_name(kind, name)
    names = tuple(ports) if not isinstance(ports, str) else (ports,)
    for port in names:
        check_name(f"{kind} {name!r}: a port", port)
    if len(names) < 2 or len(set(names)) < len(names):
        raise GraphError(
            f"{kind} {name!r} needs two ports or more, of different names, got {names!r}",
            elements=[name],
        )
    return names


def _only_one(kind: str, name: Any, laws: Mapping[str, Any]) -> tuple[str, Any]:
    given = [(key, law) for key, law in laws.items() if law is not None]
    if len(given) != 1:
        said = " and ".join(key for key, _ in given) + " were" if given else "none was"
        raise LawError(
            f"{kind} {name!r} takes exactly one of {', '.join(laws)}; {said} given", elements=[name]
        )
    return given[0]


def _energy_of(
    kind: str, name: Any, size: int, laws: Mapping[str, Any], inverted: str
) -> Callable[..., sympy.Expr]:
    """Return the energy behind whichever law was given."""
    key, law = _only_one(kind, name, laws)
    if key == "energy":
        return law
    matrix = _square(kind, name, key, law, size)
    if not is_symmetric(matrix):
        raise LawError(
            f"{kind} {name!r}: the {key} matrix is not symmetric; such ports do not store energy, they make it",
            elements=[name],
        )
    if key == inverted:
        inverse = inverse_of(matrix)
        if inverse is None:
            raise LawError(
                f"{kind} {name!r}: the {key} matrix is singular; leave out the port that follows from the others",
                elements=[name],
            )
        matrix = inverse

    def energy(*states: sympy.Expr) -> sympy.Expr:
        squares = (matrix[i, i] * state**2 / 2 for i, state in enumerate(states))
        pairs = itertools.combinations(range(size), 2)
        return sympy.Add(*squares, *(matrix[i, j] * states[i] * states[j] for i, j in pairs))

    return energy


def _square(kind: str, name: Any, key: str, law: Any, size: int) -> sympy.Matrix:
    try:
        rows = law.tolist() if hasattr(law, "tolist") else law
        matrix = sympy.Matrix([[exact(entry) for entry in row] for row in rows])
    except (TypeError, ValueError, LawError) as error:
        raise LawError(
            f"{kind} {name!r}: {key} must be a square matrix of numbers or expressions ({error})",
            elements=[name],
        ) from None
    if matrix.shape != (size, size):
        raise LawError(
            f"{kind} {name!r}: {key} is {matrix.rows} by {matrix.cols}; {size} ports need {size} by {size}",
            elements=[name],
        )
    return matrix


def _evaluated(
    kind: str, name: str, key: str, law: Callable[..., Any], arguments: Iterable[sympy.Symbol]
) -> sympy.Expr:
    try:
        return exact(law(*arguments))
    except (LawError, TypeError) as error:
        raise LawError(f"{kind} {name!r}, {key}: {error}", elements=[name]) from None


def _rows(
    kind: str, name: str, key: str, law: Callable[..., Any], given: Sequence[sympy.Symbol]
) -> list[sympy.Expr]:
    try:
        rows = [exact(row) for row in law(*given)]
    except (LawError, TypeError) as error:
        raise LawError(f"{kind} {name!r}, {key}: {error}", elements=[name]) from None
    if len(rows) != len(given):
        raise LawError(
            f"{kind} {name!r}: {key} gives {len(rows)} expressions for {len(given)} ports",
            elements=[name],
        )
    return rows


def port_of(element: Element) -> tuple[str, str] | None:
    """Return the names of field and port of a field's port; None for other elements.

    Only a port of a field has a dot in its own name.

    Examples
    --------
    >>> port_of(CField("beam", ("tip", "root"), stiffness=[[2, 1], [1, 2]])["tip"])
    ('beam', 'tip')
    """
    field, dot, port = element.name.rpartition(".")
    return (field, port) if dot else None
