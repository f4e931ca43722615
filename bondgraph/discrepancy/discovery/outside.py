"""Around a search: where held-out recordings start, and what to measure next."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy

from ..latent.columns import Candidate
from ..latent.relax import Relaxed, followed
from ..latent.screen import Sketch
from .apart import SEEN, harder, laws_part, signals_apart
from .bench import Bench, Trial
from .judge import Judgement
from .laws import latent_points
from .prepare import Prepared
from .search import Found
from .verdict import Verdict

MOST = 2  # signals to be measured that are named
PARTS = 15  # of a variable's range, in which the latent effort is averaged
TOLD = 0.5  # of the latent effort's variance

Array = numpy.ndarray


def relaxed_starts(found: Relaxed, held: Sequence[Prepared]) -> list[dict[str, float]]:
    """Return where the smoother says that other recordings begin."""
    names = [state.name for state in found.functions.equations.states]
    starts = []
    for row in held:
        course = followed(found, row.record(found.functions.outputs))
        starts.append(dict(zip(names, course.x[0].tolist(), strict=True)))
    return starts


def advice_for(bench: Bench, found: Found, said: Judgement) -> tuple[str, ...]:
    """Return what to measure next, in four lines at most.

    Parameters
    ----------
    bench : Bench
    found : Found
    said : Judgement

    Returns
    -------
    tuple of str
        Empty where an effect is named, and where nothing is missing.
    """
    if said.verdict is Verdict.AMBIGUOUS:
        return _splitting(bench, found.sketches[0], said.members)
    if said.verdict is Verdict.UNNAMED:
        return _shape(found, said.members[0])
    return ()


def _splitting(bench: Bench, sketch: Sketch, members: Sequence[Trial]) -> tuple[str, ...]:
    """Say which signals and which excitation would tell the members of a class apart."""
    lines = []
    both = _both([member.label for member in members])
    signals = signals_apart(bench, members)
    for item in signals[:MOST]:
        if item.share >= SEEN:
            lines.append(
                f"measure {item.signal}: there {both} differ by {_percent(item.share)} of its range"
            )
    if not lines:
        most = f", none by more than {_percent(signals[0].share)} of its range" if signals else ""
        lines.append(
            f"no other signal of the model tells {both} apart as it was driven{most}: excite it otherwise"
        )
    law = laws_part(members, _reach(sketch))
    if law:
        lines.append(law)
    drive = harder(bench, members)
    if drive is not None:
        factor, item = drive
        lines.append(
            f"or drive it {factor:g} times as strongly: then {item.signal} differs by "
            f"{_percent(item.share)} of its range"
        )
    return tuple(lines)


def _both(labels: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(labels[:-1]), labels[-1])))


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.1 else f"{100 * share:.2g} %"


def _reach(sketch: Sketch) -> dict[str, dict[str, float]]:
    """Return how far each variable of each candidate's site went."""
    found = {}
    for item in sketch.columns.candidates:
        signals = item.signals
        found[item.label] = {
            name: float(numpy.abs(values).max()) if numpy.isfinite(values).all() else 0.0
            for name, values in (
                ("flow", signals.flow),
                ("displacement", signals.displacement),
                ("effort", signals.effort),
            )
        }
    return found


def _shape(found: Found, nearest: Trial) -> tuple[str, ...]:
    """Say where something is missing, what it depends on, and how near the nearest effect comes."""
    lines = []
    sketch = found.sketches[0]
    first = sketch.singles[0].candidates[0] if sketch.singles else None
    label = nearest.added[0].label if nearest.added else ""
    item = next((each for each in sketch.columns.candidates if each.label == label), first)
    if item is not None:
        said = _depends(sketch, item)
        lines.append(f"what is missing acts at {item.site.name}{said}")
    if nearest.added:
        share = 1 - math.sqrt(_left(nearest, found.base))
        lines.append(
            f"the nearest, {nearest.label}, takes {_percent(max(share, 0.0))} of the gap on the data it "
            "was fitted to; hand an effect of your own to `effects` that does more"
        )
    else:
        lines.append("hand an effect of your own to `effects`, or refine the model where it is")
    return tuple(lines)


def _left(trial: Trial, base: Trial) -> float:
    """Return the share of squared residuals that is left, signals counting alike."""
    parts = [
        squares / base.squares[name]
        for name, squares in trial.squares.items()
        if base.squares.get(name, 0.0) > 0
    ]
    return float(numpy.mean(parts)) if parts else 1.0


def _depends(sketch: Sketch, item: Candidate) -> str:
    """Say on which variable of the site the latent effort or flow depends most."""
    best, most = "", TOLD
    for name in ("flow", "displacement", "effort"):
        x = getattr(item.signals, name)
        if not numpy.isfinite(x).all() or not numpy.ptp(x) > 0:
            continue
        y = latent_points(sketch, item.probe, x, len(x))[:, 1]
        share = _told(y)
        if share > most:
            way = "rises" if numpy.corrcoef(numpy.arange(len(y)), y)[0, 1] > 0 else "falls"
            most = share
            best = f", and {way} with the {name} there, which tells {share:.0%} of it"
    return (
        best or ", and is no plain function of flow, displacement or effort there: it has a memory"
    )


def _told(y: Array) -> float:
    """Return the share of the variance that averages over parts of the range tell (Pearson's eta^2)."""
    parts = numpy.array_split(y, PARTS)
    whole = float(y.var())
    within = sum(float(part.var()) * len(part) for part in parts) / len(y)
    return 1 - within / whole if whole > 0 else 0.0
