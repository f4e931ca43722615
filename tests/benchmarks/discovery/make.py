"""From a plan to recordings and to what is sealed: runs of the truth, strength, noise, flaws."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy
from scipy.optimize import least_squares

from .excite import excitation
from .plans import Plan
from .plants import PLANTS, Plant
from .truth import Drive, Hidden, simulate

Array = numpy.ndarray
Beside = Callable[[float], Sequence[Hidden]]
SIZES = (500, 800, 1200)
DRIFT = 0.05  # parameters of the truth are off by up to this share
STRONG, WEAK = 0.5, 0.15  # share of a signal's deviation that an effect changes
SEEN = 200.0  # drop of chi squared, beyond parameters, from which an effect counts as identifiable
APART = 25.0  # of chi squared, from which two sites count as told apart
SWAPS = {
    "dc_motor": ("wheel", "motor"),
    "free_motor": ("wheel", "motor"),
    "two_mass_chain": ("first", "second"),
    "undamped_chain": ("first", "second"),
    "unheld_chain": ("first", "second"),
    "two_tanks": ("first", "second"),
}
# what an effect comes down to where the machine never gets to the other side of its threshold
ONE_SIDED = {"overflow": ("flow_bias", "flow", ("conductance", "threshold"))}
FACTORS = numpy.geomspace(1 / 6, 6, 5)
HALVINGS = 5
STEPS, PATIENT = 6, 40
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
    also = elsewhere(plan, setting, hidden, signals)
    return Made(plan.id, seen, records, _sealed(plan, setting, hidden, share, gain, also))


def strength(
    setting: Setting, hidden: Sequence[Hidden], signals: Sequence[str], noise: float
) -> tuple[float, float]:
    """Return what hidden effects change, and what of it no parameter can imitate.

    Returns
    -------
    share : greatest root mean square change over a signal's deviation
    gain : drop of chi squared beyond the table's parameters, which are fitted
    """
    if not hidden:
        return 0.0, 0.0
    seen = Seen.of(setting, signals)
    gap = seen.gap(hidden)
    parts = numpy.split(gap, len(signals))
    share = max(float(numpy.sqrt(numpy.mean(part**2))) for part in parts)
    if share < 1e-6:
        return share, 0.0
    return share, seen.fitted(gap) / noise**2


@dataclass(frozen=True)
class Seen:
    """Signals of a setting over their deviations, one after the other; and what parameters do."""

    setting: Setting
    signals: Sequence[str]
    scale: Mapping[str, float]
    base: Array
    slopes: Array

    @classmethod
    def of(cls, setting: Setting, signals: Sequence[str]) -> Seen:
        without = setting.run([])
        scale = {name: float(numpy.std(without[name])) for name in signals}
        bare = cls(setting, signals, scale, numpy.zeros(()), numpy.zeros(()))
        base, slopes = bare.stacked(without), []
        for name in setting.plant.table:
            moved = setting.run([], **{name: setting.parameters[name] * 1.001})
            slopes.append((bare.stacked(moved) - base) / 1e-3)
        return replace(bare, base=base, slopes=numpy.stack(slopes, axis=1))

    def stacked(self, columns: Mapping[str, Array]) -> Array:
        return numpy.concatenate([columns[name] / self.scale[name] for name in self.signals])

    def gap(self, hidden: Sequence[Hidden]) -> Array:
        """Return what hidden effects change."""
        return self.stacked(self.setting.run(hidden)) - self.base

    def fitted(self, gap: Array, beside: Beside | None = None, steps: int = STEPS) -> float:
        """Return the sum of squares that parameters leave, in so many steps from the truth's.

        Hidden effects may stand beside them, of a size that is fitted as well.
        """
        own = {name: self.setting.parameters[name] for name in self.setting.plant.table}
        start = numpy.zeros(len(own) + (beside is not None))

        def rest(logs: Array) -> Array:
            factors = numpy.exp(logs)
            moved = {n: v * float(x) for (n, v), x in zip(own.items(), factors, strict=False)}
            run = self.setting.run(beside(float(factors[-1])) if beside else [], **moved)
            return numpy.asarray(gap - self.stacked(run) + self.base)

        found = least_squares(rest, start, bounds=(-2, 2), diff_step=1e-3, max_nfev=steps)
        return min(2 * float(found.cost), float(gap @ gap))

    def left(self, gap: Array, *more: Array) -> float:
        """Return the sum of squares beyond parameters, to first order, and beyond other changes."""
        matrix = numpy.column_stack([self.slopes, *more])
        rest = gap - matrix @ numpy.linalg.lstsq(matrix, gap, rcond=None)[0]
        return float(rest @ rest)


def elsewhere(
    plan: Plan, setting: Setting, hidden: Sequence[Hidden], signals: Sequence[str]
) -> list[list[tuple[str, str]]]:
    """Return by hidden effect what else, or where else, explains these signals as well.

    To less than `APART` of chi squared.
    """
    if plan.kind not in ("effect", "two"):
        return [[] for _ in hidden]
    seen = Seen.of(setting, signals)
    gap, least = seen.gap(hidden), APART * plan.noise**2
    return [
        [*_other_sites(plan, seen, hidden, gap, least), *_one_sided(seen, hidden, i, gap, least)]
        for i in range(len(hidden))
    ]


def _other_sites(
    plan: Plan, seen: Seen, hidden: Sequence[Hidden], gap: Array, least: float
) -> list[tuple[str, str]]:
    """Return where else an effect explains all, to first order in its strength."""
    if len(hidden) > 1 or hidden[0].site not in SWAPS.get(plan.machine, ()):
        return []
    (there,), found = hidden, []
    for site in SWAPS[plan.machine]:
        if site == there.site:
            continue
        if seen.left(gap, seen.gap([replace(there, site=site)])) < least:
            found.append((there.effect, site))
    return found


def _one_sided(
    seen: Seen, hidden: Sequence[Hidden], which: int, gap: Array, least: float
) -> list[tuple[str, str]]:
    """Return what an effect of one side is the same as, where the other side is never met."""
    here = hidden[which]
    if here.effect not in ONE_SIDED:
        return []
    effect, name, factors = ONE_SIDED[here.effect]
    size = float(numpy.prod([here.values[factor] for factor in factors]))

    def stands_in(share: float) -> list[Hidden]:
        other = Hidden(effect, here.site, {name: size * share})
        return [other if i == which else each for i, each in enumerate(hidden)]

    return [(effect, here.site)] if seen.fitted(gap, stands_in, PATIENT) < least else []


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
    seen = dict(zip(grid.tolist(), sizes.tolist(), strict=True))
    crossing = numpy.flatnonzero(numpy.diff(numpy.sign(sizes)))
    if crossing.size:
        i = min(crossing, key=lambda i: abs(i - 1.5))  # the nearest to the entry's own numbers
        low, high = float(grid[i]), float(grid[i + 1])
        for _ in range(HALVINGS):
            # not quite a secant: impacts jump, and a secant stands still at a jump
            share_low = seen[low] / (seen[low] - seen[high])
            middle = low + (high - low) * min(max(share_low, 0.25), 0.75)
            seen[middle] = float(numpy.log(share(float(numpy.exp(middle)))) - numpy.log(target))
            if abs(seen[middle]) < 0.1:
                break
            low, high = (middle, high) if seen[middle] * seen[low] > 0 else (low, middle)
    best = min(seen, key=lambda place: abs(seen[place]))
    return [at(float(numpy.exp(best)))]


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
    plan: Plan,
    setting: Setting,
    hidden: Sequence[Hidden],
    share: float,
    gain: float,
    also: Sequence[Sequence[tuple[str, str]]],
) -> dict[str, Any]:
    """Return what only the scorer may read."""
    right = [
        list(map(list, dict.fromkeys((*entry.right, *others))))
        for entry, others in zip(plan.entries, also, strict=True)
    ]
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
