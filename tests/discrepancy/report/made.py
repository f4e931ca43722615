"""Discoveries made by hand: recordings of a machine with an effect, and models fitted to them."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np

from bondgraph import simulate
from bondgraph.discrepancy import Measurement, graft
from bondgraph.discrepancy.discovery import (
    Course,
    Discovery,
    Estimate,
    Explanation,
    Gap,
    LearnedLaw,
    NamedEffect,
    Verdict,
)
from bondgraph.discrepancy.fitting import fit
from tests.discrepancy.machines import mass_spring

NOISE = {"x": 2e-4, "v": 4e-3}
FREE = ("k", "b")
RNG = np.random.default_rng(7)


def push(t, kind):
    swing = 8 * np.sin(2 * np.pi * (2.2 if kind == "train" else 2.8) * t)
    return swing * (1 + 0.5 * np.sin(2 * np.pi * 0.31 * t))


def recording(graph, values, kind, count=2001, span=8.0):
    t = np.linspace(0, span, count)
    force = push(t, kind)
    run = simulate(graph, (0, span), values, {}, {"push": (t, force)}, t_eval=t)
    noisy = {name: run[name] + NOISE[name] * RNG.normal(size=count) for name in NOISE}
    units = {"x": "m", "v": "m/s", "push": "N"}
    holds = {"push": "linear"}
    return Measurement(t, {"push": force, **noisy}, units, holds, name=f"{kind}.csv")


def course(run, before, after):
    def simulated(graph, values):
        inputs = {"push": (run.t, run.columns["push"])}
        found = simulate(graph, (run.t[0], run.t[-1]), values, {}, inputs, t_eval=run.t)
        return {name: np.asarray(found[name]) for name in NOISE}

    measured = {name: run.columns[name] for name in NOISE}
    units = {"x": "m", "v": "m/s"}
    return Course(run.name, run.t, measured, simulated(*before), simulated(*after), NOISE, units)


def rms(values):
    return float(np.sqrt(np.nanmean(np.square(values))))


def gaps(found, nominal):
    return {
        name: Gap(
            rms(found.measured[name] - nominal.before[name]),
            rms(found.measured[name] - found.before[name]),
            rms(found.measured[name] - found.after[name]),
            NOISE[name],
            found.units[name],
        )
        for name in NOISE
    }


def estimates(done, names, units):
    return {
        key: Estimate(done.values[n], done.std[n], units.get(key, "")) for key, n in names.items()
    }


def with_values(graph, values):
    rows = {
        symbol: replace(row, value=values[symbol.name]) if symbol.name in values else row
        for symbol, row in graph.parameters.items()
    }
    return replace(graph, parameters=rows)


def plain(found):
    """The same without what makes plots, where a test is not about these."""
    return replace(found, train=(), validation=(), laws=(), gap={})


@functools.cache
def named():
    """The one effect that is there, friction on the carriage, named."""
    model = mass_spring()
    truth = graft(model, "coulomb_friction", "carriage", parameters={"level": 1.5})
    train, held = (recording(truth.graph, {"b": 5.0}, kind) for kind in ("train", "validation"))
    alone = fit(model, train, FREE, noise=NOISE)
    grown = graft(model, "coulomb_friction", "carriage")
    done = fit(grown.graph, train, (*FREE, grown.parameters["level"]), noise=NOISE)
    other = graft(model, "viscous_damping", "carriage")
    effect = NamedEffect(
        "coulomb_friction",
        grown.name,
        "carriage",
        None,
        estimates(done, grown.parameters, {"level": "N"}),
        812.3,
        "a constant effort against the flow",
    )
    rival = NamedEffect(
        "viscous_damping",
        other.name,
        "carriage",
        None,
        {"damping": Estimate(3.1, math.inf, "N*s/m")},
        101.2,
    )
    before, after = (model, alone.values), (grown.graph, done.values)
    courses = [course(run, before, after) for run in (train, held)]
    given = [course(run, (model, {}), (model, {})) for run in (train, held)]
    speed = courses[0].after["v"]
    level = done.values[grown.parameters["level"]]
    x = np.linspace(-0.3, 0.3, 61)
    points = np.column_stack([speed, level * np.sign(speed) + 0.3 * RNG.normal(size=len(speed))])
    law = LearnedLaw(
        effect.label,
        "flow of carriage",
        "effort",
        ("m/s", "N"),
        x,
        level * np.sign(x),
        0.05 + 0 * x,
        points,
    )
    best = Explanation((effect,), grown.graph, done, 812.3, 0.97, (), grown.diff)
    second = Explanation(
        (rival,),
        other.graph,
        alone,
        101.2,
        0.11,
        ("removes 11 % of the held-out gap, less than half",),
        other.diff,
    )
    itself = Explanation((), model, alone, 0.0, 0.0)
    return Discovery(
        graph=model,
        verdict=Verdict.NAMED,
        effects=(effect,),
        alternatives=(rival,),
        gap={
            "train": gaps(courses[0], given[0]),
            "validation": gaps(courses[1], given[1]),
        },
        improved=with_values(grown.graph, done.values),
        parameters=estimates(done, {n: n for n in FREE}, {"k": "N/m", "b": "N*s/m"}),
        nominal={"k": 800.0, "b": 4.0},
        ranked=(best, second, itself),
        chosen=best,
        train=(courses[0],),
        validation=(courses[1],),
        laws=(law,),
        words=(
            "coulomb_friction at carriage is missing: it removes 97 % of the held-out gap.",
            "The next best, viscous_damping at carriage, explains far less.",
        ),
        unseen=("m and k only as a ratio",),
        advice=("push harder at low speed",),
        alike=(("coulomb_friction at carriage", "stribeck_friction at carriage"),),
        warnings=("train.csv: input 'push' is taken as straight lines between samples",),
        recordings=(train,),
        held_out=(held,),
        seconds=12.3,
    )


def ambiguous():
    found = named()
    twin = replace(found.alternatives[0], delta_bic=810.0)
    return replace(
        found,
        verdict=Verdict.AMBIGUOUS,
        effects=(*found.effects, twin),
        improved=None,
        words=("One of two is missing.", "A slower push would tell them apart."),
    )


def unnamed():
    found = named()
    failed = ("leaves the residual far above the noise floor",)
    chosen = replace(found.chosen, failed=failed)
    return replace(
        found,
        verdict=Verdict.UNNAMED,
        chosen=chosen,
        ranked=(chosen, *found.ranked[1:]),
        improved=None,
        words=("Something at carriage is missing.", "No known effect explains it."),
    )


def nothing():
    """No effect: what is shown as after is the model by itself."""
    found = named()
    itself = found.ranked[-1]
    same = [replace(c, after=c.before) for c in (*found.train, *found.validation)]
    return replace(
        found,
        verdict=Verdict.NONE,
        effects=(),
        improved=None,
        chosen=itself,
        ranked=(itself, found.ranked[1]),
        train=(same[0],),
        validation=(same[1],),
        laws=(),
        words=("The model lacks nothing that these recordings show.", "All that is left is noise."),
    )


VERDICTS = {f.__name__: f for f in (named, ambiguous, unnamed, nothing)}
