"""Junctions: where bonds share an effort or a flow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import sympy

from .base import EFFORT, FLOW, Element, check_name, variable


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Junction(Element):
    """Junction: one variable is shared by all bonds, the other sums to zero.

    Attributes
    ----------
    pseudo : bool
        Whether its bonds are pseudo-bonds of temperature and heat flow.
    """

    pseudo: bool
    shared: ClassVar[str]


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Zero(Junction):
    """0-junction: one effort, flows sum to zero.

    Parameters
    ----------
    name : str
    pseudo : bool
        Whether the bonds here, and what they reach without a TF, GY or RS, are
        pseudo-bonds: temperature as effort, heat flow in W as flow.

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

    def __init__(self, name: str, *, pseudo: bool = False) -> None:
        check_name("Zero", name)
        self._set(name=name, pseudo=bool(pseudo), e=variable(f"{name}.e"))


@dataclass(frozen=True, eq=False, init=False, repr=False)
class One(Junction):
    """1-junction: one flow, efforts sum to zero.

    Parameters
    ----------
    name : str
    pseudo : bool
        Whether the bonds here, and what they reach without a TF, GY or RS, are
        pseudo-bonds: temperature as effort, heat flow in W as flow.

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

    def __init__(self, name: str, *, pseudo: bool = False) -> None:
        check_name("One", name)
        self._set(name=name, pseudo=bool(pseudo), f=variable(f"{name}.f"))
