"""From a plan to recordings and to what is sealed: runs of the truth, strength, noise, flaws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy

from .excite import excitation
from .plans import Plan
from .plants import PLANTS, Plant
from .truth import Drive, Hidden, simulate

Array = numpy.ndarray
SIZES = (500, 800, 1200)
DRIFT = 0.05  # parameters of the truth are off by up to this share
STRONG, WEAK = 0.5, 0.15  # share of a signal's deviation that an effect changes
SEEN = 200.0  # drop of chi squared, beyond parameters, from which an effect counts as identifiable
FACTORS = numpy.geomspace(1 / 6, 6, 5)
HELPERS = ("bend", "pace")  # coefficients of the truth's own forms


@dataclass(frozen=True)
class Record:
    """One recording: times, then columns by label, with NaN in gaps."""

    t: Array
    columns: Mapping[str, Array]


@dataclass(frozen=True)
class Made:
    """A case: what the code under test may see, and what it may not."""

    id: str
    open: Mapping[str, Any]
    records: Mapping[str, Record]
    sealed: Mapping[str, Any]


@dataclass(frozen=True)
class Setting:
    """The truth's numbers and inputs of one case."""

    plant: Plant
    parameters: Mapping[str, float]
    drives: tuple[Drive, Drive]

    def run(self, hidden: Sequence[Hidden], which: int = 0, **changed: float) -> dict[str, Array]:
        return simulate(
            self.plant.truth, {**self.parameters, **changed}, hidden, self.drives[which]
        )


def made(plan: Plan) -> Made:
    """Run a plan."""
    rng = plan.rng
    setting = _setting(plan, rng)
    signals = [name for name in setting.plant.outputs if name != plan.hidden_signal]
    hidden = _strong(plan, setting, rng)
    share, gain = strength(setting, hidden, signals, plan.noise)
    if plan.kind == "effect" and gain < SEEN:
        hidden = _strong(plan, setting, rng, weak=STRONG)
        share, gain = strength(setting, hidden, signals, plan.noise)
    runs = [setting.run(hidden, which) for which in (0, 1)]
    spread = {name: float(numpy.std(column)) for name, column in runs[0].items()}
    records = {
        label: _record(plan, setting, which, runs[which], spread, signals, rng)
        for which, label in enumerate(("train", "validate"))
    }
    seen = {"model": plan.machine}
    if plan.flaw == "zero":
        seen["holds"] = {setting.plant.drive: "zero"}
    return Made(plan.id, seen, records, _sealed(plan, setting, hidden, share, gain))


def strength(
    setting: Setting, hidden: Sequence[Hidden], signals: Sequence[str], noise: float
) -> tuple[float, float]:
    """Return what hidden effects change, and what of it no parameter can imitate.

    Returns
    -------
    share : greatest root mean square change over a signal's deviation
    gain : drop of chi squared beyond the table's parameters, to first order
    """
    if not hidden:
        return 0.0, 0.0
    without, with_ = setting.run([]), setting.run(hidden)
    scale = {name: numpy.std(without[name]) for name in signals}

    def stacked(columns: Mapping[str, Array]) -> Array:
        return numpy.concatenate([columns[name] / scale[name] for name in signals])

    share = max(
        float(numpy.sqrt(numpy.mean((with_[n] - without[n]) ** 2)) / scale[n]) for n in signals
    )
    base, slopes = stacked(without), []
    for name in setting.plant.table:
        moved = setting.parameters[name] * 1.001
        slopes.append((stacked(setting.run([], **{name: moved})) - base) / 1e-3)
    matrix = numpy.stack(slopes, axis=1)
    gap = stacked(with_) - base
    left = gap - matrix @ numpy.linalg.lstsq(matrix, gap, rcond=None)[0]
    return share, float(left @ left) / noise**2


def _setting(plan: Plan, rng: numpy.random.Generator) -> Setting:
    plant = PLANTS[plan.machine]
    size = int(rng.choice(SIZES))
    if plan.flaw == "coarse":  # four samples in a period of the fastest line
        plant, size = replace(plant, step=0.25 / plant.band[1]), 500
    table = {
        name: value * (1 + DRIFT * rng.uniform(-1, 1)) * plan.wrong.get(name, 1.0)
        for name, value in plant.table.items()
    }
    numbers = {name: value * plan.wrong.get(name, 1.0) for name, value in plant.numbers.items()}
    hold = "zero" if plan.flaw == "zero" else "linear"
    t = numpy.arange(size) * plant.step
    drives = tuple(
        Drive(t, excitation(plant, kind, size, rng), hold) for kind in plan.excitations()
    )
    return Setting(plant, {**table, **numbers}, (drives[0], drives[1]))


def _strong(
    plan: Plan, setting: Setting, rng: numpy.random.Generator, weak: float = WEAK
) -> list[Hidden]:
    """Return hidden effects, each by itself as strong as drawn."""
    found = []
    for entry in plan.entries:
        drawn = {
            name: value * (1 if name in HELPERS else rng.uniform(0.9, 1.1))
            for name, value in entry.values.items()
        }
        target = float(numpy.exp(rng.uniform(numpy.log(weak), numpy.log(STRONG))))
        hidden = [Hidden(entry.effect, entry.site, drawn, entry.form)]
        if entry.scaled:
            hidden = _scaled(setting, hidden[0], entry.scaled, target)
        found += hidden
    return found


def _scaled(setting: Setting, hidden: Hidden, names: Sequence[str], target: float) -> list[Hidden]:
    """Return the effect with coefficients times a factor, so that it changes outputs as wanted."""
    without = setting.run([])

    def at(factor: float) -> Hidden:
        values = {k: v * factor if k in names else v for k, v in hidden.values.items()}
        return replace(hidden, values=values)

    def share(factor: float) -> float:
        run = setting.run([at(factor)])
        changes = [
            numpy.sqrt(numpy.mean((run[name] - base) ** 2)) / numpy.std(base)
            for name, base in without.items()
        ]
        return max(float(max(changes)), 1e-9)

    grid = numpy.log(FACTORS)
    sizes = numpy.log([share(factor) for factor in FACTORS]) - numpy.log(target)
    crossing = numpy.flatnonzero(numpy.diff(numpy.sign(sizes)))
    if not crossing.size:
        return [at(float(FACTORS[numpy.argmin(abs(sizes))]))]
    i = min(crossing, key=lambda i: abs(i - 1.5))  # the nearest to the entry's own numbers
    low, high, a, b = grid[i], grid[i + 1], sizes[i], sizes[i + 1]
    for _ in range(3):
        middle = low + (high - low) * a / (a - b)
        new = numpy.log(share(float(numpy.exp(middle)))) - numpy.log(target)
        if abs(new) < 0.05:
            break
        low, a, high, b = (middle, new, high, b) if new * a > 0 else (low, a, middle, new)
    return [at(float(numpy.exp(middle)))]


def _record(
    plan: Plan,
    setting: Setting,
    which: int,
    run: Mapping[str, Array],
    spread: Mapping[str, float],
    signals: Sequence[str],
    rng: numpy.random.Generator,
) -> Record:
    plant, drive = setting.plant, setting.drives[which]
    columns = {f"{plant.drive} [{plant.unit}]": drive.values}
    for name in signals:
        noise = plan.noise * spread[name]
        column = run[name] + noise * rng.normal(size=len(drive.t))
        if plan.flaw == "outliers":
            wild = rng.random(len(drive.t)) < 0.01
            column = column + wild * rng.normal(size=len(drive.t)) * 3 * spread[name]
        if plan.flaw == "gaps":
            for begin in rng.uniform(0.05, 0.85, 3):
                first = int(begin * len(drive.t))
                column[first : first + len(drive.t) // 20] = numpy.nan
        columns[f"{name} [{plant.outputs[name]}]"] = column
    return Record(drive.t, columns)


def _sealed(
    plan: Plan, setting: Setting, hidden: Sequence[Hidden], share: float, gain: float
) -> dict[str, Any]:
    """Return what only the scorer may read."""
    right = [list(map(list, entry.right)) for entry in plan.entries]
    if plan.kind in ("outside", "low"):
        right = []
    elif plan.right:
        right = [list(map(list, plan.right))]
    asked = [
        {
            name: value
            for name, value in h.values.items()
            if name not in HELPERS and name not in entry.unscored
        }
        for h, entry in zip(hidden, plan.entries, strict=True)
    ]
    return {
        "id": plan.id,
        "kind": plan.kind,
        "machine": plan.machine,
        "noise": plan.noise,
        "hidden": [
            {"effect": h.effect, "site": h.site, "values": dict(h.values), "form": h.law}
            for h in hidden
        ],
        "right": right,
        "asked": asked if right else [],
        "wrong": dict(plan.wrong),
        "parameters": dict(setting.parameters),
        "excitation": list(plan.excitations()),
        "samples": len(setting.drives[0].t),
        "unmeasured": plan.hidden_signal,
        "flaw": plan.flaw,
        "share": share,
        "gain": gain,
        "identifiable": bool(gain >= SEEN) and plan.kind in ("effect", "two"),
    }
