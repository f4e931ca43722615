"""Energy storage: C and I, each a state, a law and an energy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import sympy

from ..errors import LawError
from ..laws import affine_inverse
from ..terms import product
from .base import NO_PARTNERS, OnePort, variable

LARGEST_EXPANSION = 4  # of a power of a sum, when a law is integrated


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
    partners : Tuple of Symbol
        States of the other ports of the same field, with which the energy is
        shared; empty for a one-port.
    """

    law: sympy.Expr
    inverse: sympy.Expr | None
    energy: sympy.Expr | None
    initial: sympy.Expr
    partners: sympy.Tuple

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
                raise LawError(
                    f"{self.kind} {self.name!r}: {key} is zero; leave the element out",
                    elements=[self.name],
                )
            self._set(
                law=product(1 / value, state),
                inverse=product(value, conjugate),
                energy=product(1 / (2 * value), state**2),
            )
        elif form == "stiff":
            self._set(
                law=product(value, state),
                inverse=None if value == 0 else product(1 / value, conjugate),
                energy=product(value / 2, state**2) if value.is_Rational else value * state**2 / 2,
            )
        elif form == "law":
            self._set(
                law=value,
                inverse=affine_inverse(value, state, conjugate),
                energy=_potential(value, state),
            )
        else:
            law_of_energy = sympy.diff(value, state)
            self._set(
                law=law_of_energy,
                inverse=affine_inverse(law_of_energy, state, conjugate),
                energy=value,
            )
        self._set(initial=self._apply("initial", initial, state), partners=NO_PARTNERS)


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
        self._set(q=variable(f"{name}.q"))
        key, law = self._one_of(
            capacitance=capacitance, stiffness=stiffness, effort=effort, energy=energy
        )
        forms = {
            "capacitance": "compliant",
            "stiffness": "stiff",
            "effort": "law",
            "energy": "energy",
        }
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
        self._set(p=variable(f"{name}.p"))
        key, law = self._one_of(inertance=inertance, flow=flow, energy=energy)
        self._store(
            key, law, {"inertance": "compliant", "flow": "law", "energy": "energy"}, initial
        )

    @property
    def state(self) -> sympy.Dummy:
        """Momentum p."""
        return self.p

    @property
    def coenergy(self) -> sympy.Dummy:
        """Flow f."""
        return self.f


def _potential(law: sympy.Expr, state: sympy.Symbol) -> sympy.Expr | None:
    """Integrate a polynomial law over the state; None for other laws, and where it would swell."""
    powers = [power for power in law.atoms(sympy.Pow) if state in power.base.free_symbols]
    swells = any(power.base != state and not _is_small(power.exp) for power in powers)
    if swells or not law.is_polynomial(state):
        return None
    return sympy.integrate(law, (state, 0, state))


def _is_small(exponent: sympy.Expr) -> bool:
    return bool(exponent.is_Integer and exponent <= LARGEST_EXPANSION)
