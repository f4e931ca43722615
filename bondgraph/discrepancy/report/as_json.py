"""The numbers of a discovery as one JSON object, which `bondgraph discover --json` prints."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ..discovery import Discovery, Estimate, Explanation, Gap, NamedEffect


def to_json(found: Discovery, improved_model: str | None = None) -> dict[str, Any]:
    """Return what a discovery found, as plain values that JSON can hold.

    Parameters
    ----------
    found : Discovery
    improved_model : str, optional
        Where the improved model was written.

    Returns
    -------
    dict
        Numbers are SI. What is not finite is None: a standard deviation that the data do not
        tell, a gap of a model that did not run.

    Examples
    --------
    >>> import sympy
    >>> from bondgraph import C, One, R, assemble
    >>> from bondgraph.discrepancy import Measurement
    >>> from bondgraph.discrepancy.discovery import Discovery, Explanation, Verdict
    >>> from bondgraph.discrepancy.fitting import fit
    >>> tau = sympy.Symbol("tau", positive=True)
    >>> bonds = One("loop") >> (R("r", tau), C("c", 1, initial=2))
    >>> graph = assemble("decay", bonds, parameters={tau: 1})
    >>> done = fit(graph, Measurement([0, 1, 2], {"c.q": [2, 0.74, 0.27]}), ["tau"])
    >>> itself = Explanation((), graph, done, delta_bic=0.0, removed=0.0)
    >>> none = {"effects": (), "alternatives": (), "gap": {}, "improved": None, "laws": ()}
    >>> none |= {"parameters": {}, "nominal": {}, "train": (), "validation": ()}
    >>> words = ("Nothing is missing.",)
    >>> found = Discovery(graph, Verdict.NONE, ranked=(itself,), chosen=itself, words=words, **none)
    >>> told = to_json(found)
    >>> told["verdict"], told["effects"], told["words"]
    ('none', [], ['Nothing is missing.'])
    """
    return {
        "schema": 1,
        "model": found.graph.name,
        "verdict": str(found.verdict),
        "effects": [_effect(effect) for effect in found.effects],
        "alternatives": [_effect(effect) for effect in found.alternatives],
        "gap": {
            kind: {signal: _gap(gap) for signal, gap in found.gap.get(kind, {}).items()}
            for kind in ("train", "validation")
        },
        "improved_model": improved_model,
        "words": list(found.words),
        "parameters": {
            name: {"nominal": _number(found.nominal.get(name, math.nan)), **_estimate(estimate)}
            for name, estimate in found.parameters.items()
        },
        "explanations": [_explanation(item) for item in found.ranked],
        "diff": list(found.diff),
        "unseen": list(found.unseen),
        "advice": list(found.advice),
        "alike": [list(members) for members in found.alike],
        "warnings": list(found.warnings),
        "recordings": [run.name for run in found.recordings],
        "held_out": [run.name for run in found.held_out],
        "seconds": _number(found.seconds),
    }


def _effect(effect: NamedEffect) -> dict[str, Any]:
    return {
        "name": effect.name,
        "element": effect.element,
        "site": effect.site,
        "between": None if effect.between is None else list(effect.between),
        "parameters": _estimates(effect.parameters),
        "delta_bic": _number(effect.delta_bic),
    }


def _estimates(estimates: Mapping[str, Estimate]) -> dict[str, Any]:
    return {name: _estimate(estimate) for name, estimate in estimates.items()}


def _estimate(estimate: Estimate) -> dict[str, Any]:
    return {
        "value": _number(estimate.value),
        "std": _number(estimate.std),
        "unit": estimate.unit,
    }


def _gap(gap: Gap) -> dict[str, Any]:
    return {
        "before": _number(gap.before),
        "after": _number(gap.after),
        "noise_floor": _number(gap.noise_floor),
        "unit": gap.unit,
        "nominal": _number(gap.nominal),
        "removed": _number(gap.removed),
    }


def _explanation(item: Explanation) -> dict[str, Any]:
    return {
        "label": item.label,
        "effects": [_effect(effect) for effect in item.effects],
        "delta_bic": _number(item.delta_bic),
        "removed": _number(item.removed),
        "failed": list(item.failed),
    }


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
