"""What `discover` is given, and what of its answer is kept."""

import json
from types import SimpleNamespace

import bondgraph
from bondgraph.discrepancy.discovery import Estimate, Gap, NamedEffect, Verdict

from . import files
from .judge import judged
from .make import made
from .plans import plans
from .solvers import engine


def said(effect, site, **values):
    parameters = {name: Estimate(value, 0.1 * value, "N") for name, value in values.items()}
    named = NamedEffect(effect, effect, site, None, parameters, -100.0)
    gap = {"validation": {"x": Gap(2.0, 1.0, 0.1, 0.1, "m")}}
    return SimpleNamespace(
        verdict=Verdict.NAMED,
        effects=(named,),
        gap=gap,
        chosen=SimpleNamespace(label=named.label),
        words=("it is there",),
    )


def test_the_engine_is_given_model_recordings_and_holds(tmp_path, monkeypatch):
    plan = next(p for p in plans() if p.flaw == "zero" and p.machine == "mass_spring")
    case = made(plan)
    level = case.sealed["hidden"][0]["values"]["level"]
    given = {}

    def discover(graph, measurements, validation):
        given.update(graph=graph, train=measurements, held=validation)
        return said("coulomb_friction", "carriage", level=1.05 * level)

    monkeypatch.setattr(bondgraph, "discover", discover, raising=False)
    (folder,) = files.write([case], tmp_path)
    answer = json.loads(json.dumps(engine(folder)))
    assert given["graph"].name == "mass_spring" and list(given["train"][0].columns) == [
        "push",
        "x",
        "v",
    ]
    assert given["held"][0].holds == {"push": "zero"} and len(given["held"]) == 1
    row = judged(case.sealed, answer)
    assert row.named and row.classed and row.verdict == "named"
    assert abs(row.errors[0] - 0.05) < 1e-9 and row.covered == (True,)
    assert row.removed == 1.0
