"""How many runs of one model ended, as arrays with one row a run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy

from ..parameters import unknown_name
from .compiled import CompiledModel
from .inputs import at
from .outcome import Outcome

Array = numpy.ndarray


@dataclass(frozen=True, eq=False)
class Ends:
    """Ends of the runs of a batch; a run that could not start has NaN in its row.

    Attributes
    ----------
    model : CompiledModel
    outcomes : tuple of Outcome or None
        None where a run could not start; `refusals` says why.
    refusals : mapping of int to str
        By row.
    t_end : (np,) array, s
        Last good times.
    x : (np, n) array
        States at the last good times, and algebraic variables after them.
    codes : (np, k) array of int8
        Modes of the contacts there.
    entered : (np, k, 3) array of int64
        How often each contact entered the modes of code 0 (stick), above and below zero.
    supplied, dissipated, stored : (np,) arrays, J
        Energies over the run; stored is the change, NaN where it cannot be told.
    residual : (np,) array
        What is missing between them, relative to the largest; NaN like stored.
    steps : (np,) array of int64
    p, u : (np, P) and (np, m) arrays
        Parameters and last inputs, ordered as those of ``model.equations``.
    """

    model: CompiledModel
    outcomes: tuple[Outcome | None, ...]
    refusals: Mapping[int, str]
    t_end: Array
    x: Array
    codes: Array
    entered: Array
    supplied: Array
    dissipated: Array
    stored: Array
    residual: Array
    steps: Array
    p: Array
    u: Array

    def __len__(self) -> int:
        return len(self.t_end)

    def signals(self, names: Sequence[str]) -> Array:
        """Return signals at the last good times, of shape (len(names), np)."""
        model, out = self.model, numpy.full((len(names), len(self)), math.nan)
        for name in names:
            try:
                model.expression(model.equations, name)
            except KeyError:
                raise unknown_name("signal", name, model.names) from None
        began = numpy.array([outcome is not None for outcome in self.outcomes], dtype=bool)
        masks = ((self.codes == 0) * (1 << numpy.arange(self.codes.shape[1]))).sum(axis=1)
        for mask in numpy.unique(masks[began]):
            here = began & (masks == mask)
            out[:, here] = model.signals(int(mask), tuple(names))(
                self.t_end[None, here],
                self.x[here].T,
                self.u[here].T,
                self.p[here].T,
                self.codes[here].T,
            )
        return out


def gathered(model: CompiledModel, runs: Sequence[Any]) -> Ends:
    """Gather the ends of trajectories; a text in a run's place says why it could not start.

    Parameters
    ----------
    model : CompiledModel
    runs : sequence of Trajectory or str

    Returns
    -------
    Ends
    """
    equations, size, k = model.equations, len(runs), len(model.contact_names)
    width = len(equations.states) + (0 if model.switched else len(equations.algebraic))
    names = [symbol.name for symbol in equations.parameters]
    numbers = ("t_end", "supplied", "dissipated", "stored", "residual")
    scalars = {name: numpy.full(size, math.nan) for name in numbers}
    x, p = numpy.full((size, width), math.nan), numpy.full((size, len(names)), math.nan)
    u = numpy.full((size, len(equations.inputs)), math.nan)
    codes = numpy.zeros((size, k), dtype=numpy.int8)
    entered = numpy.zeros((size, k, 3), dtype=numpy.int64)
    steps = numpy.zeros(size, dtype=numpy.int64)
    for i, run in enumerate(runs):
        if isinstance(run, str):
            continue
        scalars["t_end"][i] = run.t_end
        if run.energy.stored is not None:
            scalars["stored"][i] = run.energy.stored
            scalars["residual"][i] = run.energy.relative_residual
        scalars["supplied"][i] = run.energy.supplied
        scalars["dissipated"][i] = run.energy.dissipated
        x[i], steps[i] = numpy.append(run.x_end, run.z_end), run.steps
        p[i] = [run.parameters[name] for name in names]
        u[i] = at(run.inputs, numpy.array([run.t_end]))[:, 0]
        codes[i] = run.codes_end
        for change in run.changes:
            entered[i, change.switch, int(numpy.sign(change.after)) % 3] += 1
    return Ends(
        model=model,
        outcomes=tuple(None if isinstance(run, str) else run.outcome for run in runs),
        refusals={i: run for i, run in enumerate(runs) if isinstance(run, str)},
        x=x,
        codes=codes,
        entered=entered,
        steps=steps,
        p=p,
        u=u,
        **scalars,
    )
