"""What all sensitivity runs of one model share: derivatives of its modes, of its table, of signals."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from .seeds import Seeds
from .signals import SignalSlopes
from .switched import SwitchedTangents
from .tangents import TangentTable

if TYPE_CHECKING:
    from ..compiled import CompiledModel
    from ..smooth import SmoothFunctions


class ForwardModel:
    """The derivatives of a model, made when first needed and kept.

    Parameters
    ----------
    model : CompiledModel

    Attributes
    ----------
    signals : SignalSlopes
    """

    def __init__(self, model: CompiledModel) -> None:
        self._model = model
        self.signals = SignalSlopes(model)
        self._beside: dict[int, SmoothFunctions] = {}
        self._seeds: dict[tuple[tuple[str, ...], frozenset[str], frozenset[str]], Seeds] = {}

    @functools.cached_property
    def tangents(self) -> TangentTable:
        """Derivatives of the modes."""
        return TangentTable(self._model.modes)

    @functools.cached_property
    def switched(self) -> SwitchedTangents:
        """Derivatives of the modes of a switched model."""
        equations = self._model.equations
        sizes = len(equations.states), len(equations.inputs), len(equations.parameters)
        return SwitchedTangents(self._model.mode_set, sizes)

    def beside(self, q: int) -> SmoothFunctions:
        """Return functions of a smooth model together with q columns of sensitivities."""
        if q not in self._beside:
            from .smooth import augmented

            self._beside[q] = augmented(self._model.smooth, q)
        return self._beside[q]

    def seeds(
        self, wrt: tuple[str, ...], overridden: tuple[str, ...], initial: tuple[str, ...]
    ) -> Seeds:
        """Return the derivatives at the start; see `Seeds`."""
        key = wrt, frozenset(overridden), frozenset(initial)
        if key not in self._seeds:
            self._seeds[key] = Seeds(self._model.equations, wrt, key[1], key[2])
        return self._seeds[key]
