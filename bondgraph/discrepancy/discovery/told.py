"""What is told of trials: their effects, their parameters, why they were not taken."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from ...graph import BondGraph
from ...units import from_si, si_unit
from .bench import Bench, Trial
from .compare import delta_bic
from .judge import Judgement
from .value import Estimate, Explanation, NamedEffect
from .verdict import Verdict


def _label(trial: Trial) -> str:
    return trial.label or "nothing missing"


def explanation(base: Trial, trial: Trial, share: float, said: Judgement) -> Explanation:
    """Return a trial as one of the ranked explanations, with what speaks against it."""
    effects = effects_in(base, trial)
    failed: tuple[str, ...] = ()
    if trial is said.members[0]:
        failed = said.failed
    elif trial.added:
        behind = delta_bic(trial, said.members[0])
        failed = (f"the criterion prefers {_label(said.members[0])} by {behind:.3g}",)
    diff = tuple(line for grafted in trial.grafts for line in grafted.diff)
    return Explanation(effects, trial.graph, trial.fit, delta_bic(base, trial), share, failed, diff)


def effects_in(base: Trial, trial: Trial) -> tuple[NamedEffect, ...]:
    """Return the effects of a trial as they are reported."""
    gain = delta_bic(base, trial) if trial.added else 0.0
    found = []
    for item, grafted in zip(trial.added, trial.grafts, strict=True):
        table = {symbol.name: row for symbol, row in trial.graph.parameters.items()}
        parameters = {}
        for key, name in grafted.parameters.items():
            value = trial.values.get(name, item.starts.get(key, math.nan))
            unit = str(table[name].unit or "")
            std = trial.fit.std.get(name, 0.0 if key not in item.effect.fitted else math.inf)
            parameters[key] = Estimate(value, std, unit)
        pair = item.site.at if len(item.site.at) == 2 else item.pair
        between = (pair[0], pair[1]) if len(pair) == 2 else None
        found.append(
            NamedEffect(
                item.effect.name,
                grafted.name,
                item.site.name,
                between,
                parameters,
                gain,
                item.effect.meaning,
            )
        )
    return tuple(found)


def named_effects(base: Trial, said: Judgement) -> tuple[NamedEffect, ...]:
    """Return the effects of a judgement: those of its best, or of all members of a class."""
    if said.verdict is Verdict.NONE:
        return ()
    if said.verdict is not Verdict.AMBIGUOUS:
        return effects_in(base, said.members[0])
    found: dict[str, NamedEffect] = {}
    for trial in said.members:
        for effect in effects_in(base, trial):
            found.setdefault(effect.label, effect)
    return tuple(found.values())


def alternatives(
    ranked: Sequence[Explanation], named: Sequence[NamedEffect]
) -> tuple[NamedEffect, ...]:
    """Return the effects that were tried and are not among those named."""
    known = {effect.label for effect in named}
    found: dict[str, NamedEffect] = {}
    for item in ranked:
        for effect in item.effects:
            if effect.label not in known:
                found.setdefault(effect.label, effect)
    return tuple(found.values())


def own_estimates(bench: Bench, trial: Trial) -> dict[str, Estimate]:
    """Return the model's own parameters as a trial has them."""
    table = {symbol.name: row for symbol, row in bench.graph.parameters.items()}
    return {
        name: Estimate(
            trial.values[name], trial.fit.std.get(name, math.inf), si_unit(table[name].unit)
        )
        for name in bench.free
    }


def fitted(trial: Trial) -> BondGraph:
    """Return a trial's graph with the fitted values in its table, in the units that stand there."""
    table = {}
    for symbol, row in trial.graph.parameters.items():
        if symbol.name in trial.values:
            row = replace(row, value=from_si(trial.values[symbol.name], row.unit))
        table[symbol] = row
    return replace(trial.graph, parameters=table)
