"""`discover`: recordings and a model in, what the model lacks out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from ...errors import LawError, MeasurementError, ParameterError, SimulationError
from ...graph import BondGraph
from ...parameters import unknown_name
from ...simulation import CompiledModel
from ...values import parameter_values
from ..candidates import Effect
from ..candidates.table import effects as effects_of
from ..fitting.unknowns import own_parameters
from ..latent.isolability import isolability
from ..latent.steady import Steadiness, steadiness
from ..measurement import Measurement
from . import gaps as measured
from .begin import anchored
from .bench import Bench, Trial, near_noise
from .compare import delta_bic
from .judge import ABOVE, Judgement, judged
from .laws import learned
from .outliers import cleared
from .outside import advice_for, relaxed_starts
from .prepare import Prepared, distinct, held_out, prepared
from .search import Found, along_runs, searched, starts_of
from .told import alternatives, explanation, fitted, named_effects, own_estimates
from .value import Discovery
from .verdict import Verdict
from .words import unseen_words, unsteady_words, verdict_words

AS_GOOD = 0.1  # share of the gap by which a number may be behind an effect
SPARED = 0.7  # of what is left of the held-out gap: an effect more has to leave less than that
RIVALS = 3  # tested on held-out data beside the best


def discover(
    graph: BondGraph,
    measurements: Measurement | Sequence[Measurement],
    validation: Measurement | Sequence[Measurement] = (),
    *,
    free: Iterable[str] | None = None,
    parameters: Mapping[Any, Any] | None = None,
    effects: Iterable[str | Effect] | None = None,
    time_budget: float = 600.0,
    progress: Callable[[str], object] | None = None,
) -> Discovery:
    """Find what a model lacks, name it, add it, and show the gap shrink.

    Parameters
    ----------
    graph : BondGraph
        The nominal model. Its numbers may be somewhat wrong.
    measurements : Measurement or sequence of Measurement
        To learn from; columns are named like the model's inputs and outputs.
    validation : Measurement or sequence of Measurement
        To test on. Unless given, the last of several recordings is held out, or the last 30 % of
        the only one.
    free : iterable of str, optional
        Parameters that may be wrong; all that have a number of their own unless given.
    parameters : mapping, optional
        Values of parameters that count instead of the table's, as for `bondgraph.simulate`.
    effects : iterable of str or Effect, optional
        Names of the table, or values; the whole table unless given.
    time_budget : float
        Seconds after which no more fits are begun.
    progress : callable, optional
        Called with a line of text at each step.

    Returns
    -------
    Discovery

    Raises
    ------
    BondGraphError
        Where model, recordings and names do not go together, or the model cannot be run.

    Notes
    -----
    A smoother that lets the model err keeps its states near the data; every effect at every site is
    scored by what it makes likelier, with the model's own parameters free (Rao's score test in the
    innovations of a Kalman filter). The best few are grown into the graph and fitted to runs. The best
    one stays, and the search goes on beside it until it brings nothing. It is named where it passes
    all of: a drop of the Bayesian information criterion with the effective number of samples above what
    noise alone reaches; the held-out gap above the noise halved; clearly ahead of others; signs
    that a physical element can have; what is left near the noise.

    References
    ----------
    Rao, Large sample tests of statistical hypotheses, Proc. Cambridge Phil. Soc. 44 (1948) 50-57.
    Trémolet, Accounting for an imperfect model in 4D-Var, Q. J. R. Meteorol. Soc. 132 (2006)
    2483-2504.

    Examples
    --------
    >>> import numpy, sympy
    >>> from bondgraph import I, One, R, Se, assemble, simulate
    >>> b, push = sympy.Symbol("b", positive=True), sympy.Symbol("push")
    >>> def carriage(drag):
    ...     v = One("v")
    ...     film = R("film", effort=lambda f: b * f + drag * f * abs(f))
    ...     return assemble("carriage", Se("motor", push) >> v >> (I("m", 1), film),
    ...         parameters={b: 0.5}, inputs=[push], outputs={"speed": v.f})
    >>> t = numpy.linspace(0, 20, 501)
    >>> force = 3 * numpy.sin(t) + 2 * numpy.sin(0.37 * t)
    >>> run = simulate(carriage(0.4), 20, inputs={"push": (t, force)}, t_eval=t)
    >>> noisy = run["speed"] + 0.01 * numpy.random.default_rng(0).normal(size=len(t))
    >>> found = discover(carriage(0), Measurement(t, {"push": force, "speed": noisy}))
    >>> found.verdict.value, [effect.label for effect in found.effects]
    ('named', ['quadratic_drag at v'])
    """
    began = time.monotonic()
    tell = progress or (lambda text: None)
    rows = [measurements] if isinstance(measurements, Measurement) else list(measurements)
    tests = [validation] if isinstance(validation, Measurement) else list(validation)
    if not rows:
        raise MeasurementError("there is no measurement to learn from; give one or more")
    warnings: list[str] = []
    if not tests:
        rows, tests, words = held_out(rows)
        warnings.append(words)
    named = distinct([*rows, *tests])
    rows, tests = named[: len(rows)], named[len(rows) :]
    ready = [prepared(row, graph) for row in rows]
    held = [prepared(row, graph) for row in tests]
    warnings += [word for _, told in (*ready, *held) for word in told]
    bench = _bench(graph, [row for row, _ in ready], free, parameters, began + time_budget)
    others = [row for row, _ in held]
    signals = list(dict.fromkeys(name for row in bench.recordings for name in row.signals))
    known = effects_of() if effects is None else _known(effects)
    found = searched(bench, signals, known, tell)
    tell("testing on held-out data")
    return _told(
        found.bench, cleared(found, others), found, rows, tests, [*warnings, *found.warnings], began
    )


def _known(effects: Iterable[str | Effect]) -> tuple[Effect, ...]:
    chosen = tuple(effects)
    if not chosen:
        raise LawError("no effects are given to look for; name some, or leave it out for all")
    return effects_of(*chosen)


def _bench(
    graph: BondGraph,
    recordings: Sequence[Prepared],
    free: Iterable[str] | None,
    parameters: Mapping[Any, Any] | None,
    deadline: float,
) -> Bench:
    model = CompiledModel(graph)
    values = parameter_values(model.equations, parameters or {}, model.resolver)
    if not model.equations.states:
        raise SimulationError(
            f"model {graph.name!r} has no states: nothing moves that could be followed; "
            "add the inertia or the compliance that the recordings show"
        )
    own = own_parameters(model)
    for name in free or ():
        if name not in own:
            raise unknown_name("parameter", name, list(own))
    chosen = tuple(own if free is None else free)
    fixed = {getattr(key, "name", key) for key in parameters or {}}
    given = {name: values[name] for name in values if name in {*own, *fixed}}
    if not all(map(math.isfinite, given.values())):
        raise ParameterError(f"a parameter of {graph.name!r} is not finite")
    if len(recordings) == 1:  # where others begin beside it, is for the data to tell
        recordings = [anchored(recordings[0], model, values)]
    unknown = {name for row in recordings for name in row.item.free}
    states = tuple(s.name for s in model.equations.states if s.name in unknown)
    return Bench(graph, model, tuple(recordings), chosen, states, given, deadline)


def _told(
    bench: Bench,
    held: Sequence[Prepared],
    found: Found,
    rows: Sequence[Measurement],
    tests: Sequence[Measurement],
    warnings: Sequence[str],
    began: float,
) -> Discovery:
    """Test what was found, judge it and put it into words."""
    base, best = found.base, found.best
    begun = starts_of(found.sketches[0].relaxed, bench)
    starts = relaxed_starts(found.sketches[0].relaxed, held)
    ordered = sorted(found.trials, key=lambda trial: -delta_bic(base, trial))
    tested = {id(base): measured.tested(bench, base, held, starts)}
    parts = [trial for trial in ordered if _part_of(trial, best)]
    for trial in [best, *parts, *[t for t in ordered if t is not best][:RIVALS]]:
        if id(trial) not in tested:
            tested[id(trial)] = measured.tested(bench, trial, held, starts)
    given = {
        "train": measured.nominal(bench.graph, bench.recordings, bench.given, begun),
        "validation": measured.nominal(bench.graph, held, bench.given, starts),
    }
    units = {name: unit for row in bench.recordings for name, unit in row.item.units.items()}
    scale = measured.sizes([*bench.recordings, *held])

    floors = measured.noises(bench.recordings, best)

    def gap_of(trial: Trial) -> dict[str, Any]:
        first, last = tested[id(base)], tested[id(trial)]
        return {
            "train": measured.gaps(
                bench.recordings, given["train"], first.train, last.train, units, floors
            ),
            "validation": measured.gaps(
                held, given["validation"], first.held, last.held, units, floors
            ),
        }

    explained = {id(base): 0.0}
    for trial in (*parts, best):
        gap_share(explained, trial, tested, gap_of, scale)
    # an effect that new data do not ask for is left out
    most = 1 - (1 - explained[id(best)]) / SPARED
    enough = [trial for trial in parts if explained[id(trial)] >= most]
    best = max(enough, key=lambda trial: explained[id(trial)], default=best)
    gap, share = gap_of(best), explained[id(best)]
    near = max(
        (item.after / floors[name] for name, item in gap["train"].items() if floors[name] > 0),
        default=math.inf,
    )
    above = any(
        item.before > ABOVE * floors[name] and _sure(bench, name)
        for name, item in gap["train"].items()
    ) and not near_noise(base, bench)
    lenient = measured.removed(gap["validation"], scale, measured.counted(held))
    unsteady = unsteady_words(_steadiness(bench, found, best))
    said = judged(best, found.trials, max(share, lenient), near, above, unsteady)
    loose = _number_off(bench, held, starts, found, tested)
    if loose is not None:
        number_share = gap_share(explained, loose, tested, gap_of, scale)
        if number_share >= explained[id(best)] - AS_GOOD:
            said = Judgement(Verdict.NONE, (loose,), (_number_words(found),))
            warnings = [*warnings, _number_words(found)]
            best = loose
    order = [best, *(t for t in ordered if t is not best), *([base] if best is not base else [])]
    ranked = tuple(
        explanation(base, trial, gap_share(explained, trial, tested, gap_of, scale), said)
        for trial in order
    )
    shown = best if said.verdict is not Verdict.NONE or best is loose else base
    gap, share = gap_of(shown), explained[id(shown)]
    first = next(item for item, trial in zip(ranked, order, strict=True) if trial is shown)
    named = named_effects(base, said)
    return Discovery(
        graph=bench.graph,
        verdict=said.verdict,
        effects=named,
        alternatives=alternatives(ranked, named),
        gap=gap,
        improved=fitted(shown) if said.verdict in (Verdict.NAMED, Verdict.AMBIGUOUS) else None,
        parameters=own_estimates(bench, shown),
        nominal={name: bench.given[name] for name in bench.free},
        ranked=ranked,
        chosen=first,
        train=measured.courses(bench.recordings, tested[id(base)].train, tested[id(shown)].train),
        validation=measured.courses(held, tested[id(base)].held, tested[id(shown)].held),
        laws=learned(found.sketches[0], shown),
        words=verdict_words(
            bench.graph.name, said.verdict, named, said.failed, gap["validation"], share
        ),
        unseen=unseen_words(shown.fit),
        advice=advice_for(bench, found, said),
        alike=isolability(found.sketches[0]).classes,
        warnings=tuple(dict.fromkeys(warnings)),
        recordings=tuple(rows),
        held_out=tuple(tests),
        seconds=time.monotonic() - began,
    )


def _steadiness(bench: Bench, found: Found, best: Trial) -> tuple[Steadiness, ...]:
    """Return how large the effects of a trial are in parts of the recordings; none where not told.

    Where all that is left is noise, no part asks for another size; and an effect without a
    coefficient that it is proportional to has none.
    """
    sized = [item for item in best.added if item.effect.linear]
    if not sized or near_noise(best, bench):
        return ()
    signals = found.sketches[0].relaxed.functions.outputs
    effects = list({item.effect.name: item.effect for item in sized}.values())
    fitted = along_runs(bench, best, signals, effects)
    if fitted is None:
        return ()
    return steadiness(found.sketches[0], fitted, [item.label for item in sized])


def _number_off(
    bench: Bench,
    held: Sequence[Prepared],
    starts: Sequence[Mapping[str, float]],
    found: Found,
    tested: dict[int, measured.Tested],
) -> Trial | None:
    """Return the model by itself with a number of a law loose, tested; None where that is no answer."""
    if found.constant is None:
        return None
    trial = found.constant.trial
    tested[id(trial)] = measured.tested(bench, trial, held, starts)
    return trial


def _number_words(found: Found) -> str:
    assert found.constant is not None
    number = found.constant
    return (
        f"with the number of {number.element!r} {number.factor:.3g} +- {number.std:.2g} times what "
        f"the model has, it explains the recordings as well as {found.best.label}"
    )


def _part_of(trial: Trial, whole: Trial) -> bool:
    """Whether a trial has some of another's effects, and no others."""
    own, all_ = ({item.label for item in each.added} for each in (trial, whole))
    return bool(own) and own < all_


def gap_share(
    known: dict[int, float],
    trial: Trial,
    tested: Mapping[int, Any],
    gap_of: Callable[[Trial], dict[str, Any]],
    scale: Mapping[str, float],
) -> float:
    """Return the share of the held-out gap that a trial removes; NaN where it was not tested."""
    if id(trial) not in known:
        known[id(trial)] = (
            measured.removed(gap_of(trial)["validation"], scale)
            if id(trial) in tested
            else math.nan
        )
    return known[id(trial)]


def _sure(bench: Bench, name: str) -> bool:
    return all(row.told.get(name, True) for row in bench.recordings)
