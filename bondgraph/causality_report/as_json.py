"""The report as plain values for JSON."""

from __future__ import annotations

from typing import Any

import sympy

from .value import CausalityReport, LoopReport, ModeCausality, StorageCausality


def to_json(report: CausalityReport) -> dict[str, Any]:
    """Return what ``bondgraph show --causality --json`` prints.

    Parameters
    ----------
    report : CausalityReport

    Returns
    -------
    dict
        ``schema`` (1), ``model``, and lists of objects, each empty where a
        model has none; expressions are text in sympy's notation, or null:

        - ``bonds``: ``bond, tail, head, effort_out_of, flow_out_of, stroke_at,
          reason, because``
        - ``junctions``: ``junction, kind, shared, bond, decided_by, because,
          followers``
        - ``storages``: ``storage, kind, state, causality`` ("integral" or
          "derivative"), ``bond, because, constraint, expanded, bound_by,
          done, initial_unused``
        - ``reductions``: ``storage, carried, quantity, value``
        - ``loops``: ``kind, variables, tearing, solved`` ("linear" or
          "algebraic"), ``remedy``
        - ``signals``: ``from, to``
        - ``input_rates``: ``input, rate``
        - ``modes``: ``modes`` (label by element), ``bound`` (objects with
          ``state, value, bound_by, because``), ``algebraic, impossible``
          (null where the mode can be)
        - ``parts`` (lists of names), ``turned`` (texts)

        and the number ``possible_modes``.

    Examples
    --------
    >>> from bondgraph import C, One, R, Se, assemble
    >>> from bondgraph.causality_report import report_causality
    >>> loop = One("loop")
    >>> rc = assemble("rc", Se("E", 1) >> loop >> (R("r", 2), C("c", 3)))
    >>> to_json(report_causality(rc))["junctions"][0]["decided_by"]
    'r'
    """
    return {
        "schema": 1,
        "model": report.model,
        "bonds": [
            {
                "bond": item.bond,
                "tail": item.tail,
                "head": item.head,
                "effort_out_of": item.effort_out_of,
                "flow_out_of": item.flow_out_of,
                "stroke_at": item.flow_out_of,
                "reason": item.reason,
                "because": item.because,
            }
            for item in report.bonds
        ],
        "junctions": [
            {
                "junction": item.junction,
                "kind": item.kind,
                "shared": item.shared,
                "bond": item.bond,
                "decided_by": item.decided_by,
                "because": item.because,
                "followers": list(item.followers),
            }
            for item in report.junctions
        ],
        **findings(report),
        "modes": [_mode(item) for item in report.modes],
        "possible_modes": report.possible_modes,
        "parts": [list(part) for part in report.parts],
        "turned": list(report.turned),
    }


def findings(report: CausalityReport) -> dict[str, Any]:
    """Return the parts of the report that ``bondgraph equations --format json`` prints as well.

    Parameters
    ----------
    report : CausalityReport

    Returns
    -------
    dict
        ``storages``, ``reductions``, ``loops``, ``signals`` and ``input_rates``.
    """
    return {
        "storages": [_storage(item) for item in report.storages],
        "reductions": [
            {
                "storage": item.storage,
                "carried": list(item.carried),
                "quantity": item.quantity,
                "value": str(item.value),
            }
            for item in report.reductions
        ],
        "loops": [_loop(item) for item in report.loops],
        "signals": [
            {"from": f"{item.source}.{item.variable}", "to": item.target} for item in report.signals
        ],
        "input_rates": [{"input": name, "rate": rate} for name, rate in report.input_rates],
    }


def _storage(item: StorageCausality) -> dict[str, Any]:
    return {
        "storage": item.storage,
        "kind": item.kind,
        "state": item.state,
        "causality": "integral" if item.integral else "derivative",
        "bond": item.bond,
        "because": item.because,
        "constraint": _text(item.constraint),
        "expanded": _text(item.expanded),
        "bound_by": list(item.bound_by),
        "done": item.done,
        "initial_unused": item.idle_initial,
    }


def _loop(item: LoopReport) -> dict[str, Any]:
    return {
        "kind": item.kind,
        "variables": list(item.variables),
        "tearing": list(item.tearing),
        "solved": item.solved,
        "remedy": item.remedy,
    }


def _mode(item: ModeCausality) -> dict[str, Any]:
    return {
        "modes": dict(item.modes),
        "bound": [
            {
                "state": bound.state,
                "value": _text(bound.value),
                "bound_by": list(bound.bound_by),
                "because": bound.because,
            }
            for bound in item.bound
        ],
        "algebraic": list(item.algebraic),
        "impossible": item.impossible or None,
    }


def _text(expression: sympy.Expr | None) -> str | None:
    return None if expression is None else str(expression)
