"""Open the seal: what was asked, what was answered, by noise, machine and effect."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy

from ..report import Limit, Report
from .files import answers, unsealed
from .judge import Judged, judged

NAMED = {0.002: 0.9, 0.02: 0.9, 0.1: 0.8, 0.2: 0.6}


def results(folder: Path, told: Path) -> list[Judged]:
    """Judge all answers of a folder.

    Parameters
    ----------
    folder : with the sealed file
    told : the file of answers
    """
    truths = {truth["id"]: truth for truth in unsealed(folder)}
    return [judged(truths[row["id"]], row) for row in answers(told) if row["id"] in truths]


def reports(rows: Sequence[Judged]) -> list[Report]:
    """Return the tables of the page."""
    return [asked(rows), by_noise(rows), by(rows, "machine"), by(rows, "effect"), failures(rows)]


def asked(rows: Sequence[Judged]) -> Report:
    """Return what the framework asks of itself."""
    one = [row for row in single(rows)]
    clean = [row for row in one if not row.truth["flaw"] and not row.truth["unmeasured"]]
    limits: list[tuple[str, int, Limit]] = []

    def add(what: str, values: Iterable[float], limit: float, least: bool = True) -> None:
        found = [value for value in values if not math.isnan(value)]
        mean = statistics.fmean(found) if found else math.nan
        limits.append((what, len(found), Limit(what, mean, limit, least)))

    for noise, limit in NAMED.items():
        at = [row for row in clean if row.truth["noise"] == noise]
        add(f"element named right at {noise:.1%} noise", [row.named for row in at], limit)
    add("the same, one signal of two", [r.named for r in one if r.truth["unmeasured"]], 0.8)
    add("the same, flawed recordings", [r.named for r in one if r.truth["flaw"]], 0.8)
    add("the same, two effects at once", [r.named for r in two(rows)], 0.6)
    add("site right", [row.placed for row in one], 0.95)
    add("effect and site, or their class, right", [row.classed for row in one], 0.9)
    add("false names, nothing missing", [r.false for r in _kind(rows, "nothing")], 0.05, False)
    add("false names, a wrong number", [r.false for r in _kind(rows, "wrong")], 0.1, False)
    add("false names, effect not excited", [r.false for r in _kind(rows, "low")], 0.1, False)
    add(
        "unnamed, effect outside the library",
        [row.verdict == "unnamed" for row in _kind(rows, "outside")],
        0.8,
    )
    limits += _figures(rows, [row for row in one if row.named])
    cells = [
        [what, str(count), _number(limit), _asked(limit), "yes" if limit.kept else "no"]
        for what, count, limit in limits
    ]
    missed = [str(row.answer["id"]) for row in rows if row.answer.get("error")]
    notes = [f"{len(missed)} cases without an answer: {', '.join(missed)}"] if missed else []
    headings = ("", "cases", "measured", "asked", "kept")
    return Report("asked", headings, cells, notes=notes)


def single(rows: Iterable[Judged]) -> list[Judged]:
    """Return cases of one effect that the data tell."""
    return [r for r in rows if r.truth["kind"] == "effect" and r.truth["identifiable"]]


def two(rows: Iterable[Judged]) -> list[Judged]:
    """Return cases of two effects."""
    return _kind(rows, "two")


def by_noise(rows: Sequence[Judged]) -> Report:
    """Return verdicts by kind of case and noise."""
    groups: dict[tuple[str, float], list[Judged]] = {}
    for row in rows:
        kind = row.truth["kind"]
        kind += " (buried)" if kind == "effect" and not row.truth["identifiable"] else ""
        groups.setdefault((kind, row.truth["noise"]), []).append(row)
    verdicts = ("named", "ambiguous", "unnamed", "none", "error")
    cells = [
        [
            kind,
            f"{noise:.1%}",
            str(len(group)),
            str(sum(row.named for row in group)),
            *(str(sum(row.verdict == verdict for row in group)) for verdict in verdicts),
        ]
        for (kind, noise), group in sorted(groups.items())
    ]
    return Report("verdicts", ("kind", "noise", "cases", "named right", *verdicts), cells)


def by(rows: Sequence[Judged], what: str) -> Report:
    """Return identifiable cases by machine or effect."""
    key: Callable[[Mapping[str, Any]], str] = (
        (lambda truth: truth["machine"])
        if what == "machine"
        else (lambda truth: truth["hidden"][0]["effect"])
    )
    groups: dict[str, list[Judged]] = {}
    for row in single(rows):
        groups.setdefault(key(row.truth), []).append(row)
    cells = [
        [
            name,
            str(len(group)),
            *(str(sum(getattr(r, k) for r in group)) for k in ("named", "placed", "classed")),
            _worded(statistics.median(row.seconds for row in group)),
        ]
        for name, group in sorted(groups.items())
    ]
    headings = (what, "cases", "named right", "site right", "effect and site", "median s")
    return Report(what, headings, cells)


def failures(rows: Sequence[Judged]) -> Report:
    """Return all that was not as it should be."""
    cells = []
    for row in sorted(rows, key=lambda row: (row.truth["kind"], row.truth["machine"])):
        if well(row):
            continue
        truth = row.truth
        what = " + ".join(f"{h['effect']} at {h['site']}" for h in truth["hidden"])
        what = what or ", ".join(f"{k} x {v:g}" for k, v in truth["wrong"].items()) or "nothing"
        spoiled = " ".join(filter(None, (truth["flaw"], truth["unmeasured"] and "one signal")))
        said = ", ".join(f"{e['name']} at {e['site']}" for e in row.answer.get("effects", ()))
        told = row.answer.get("error") or f"{row.verdict}: {said}"
        where = f"{truth['machine']} {truth['noise']:.1%} {spoiled}".strip()
        cells.append([str(truth["id"]), truth["kind"], where, what, told.replace("|", "/")[:200]])
    return Report("failures", ("case", "kind", "machine, noise", "truth", "answer"), cells)


def well(row: Judged) -> bool:
    """Whether an answer is as it should be."""
    kind = row.truth["kind"]
    if row.answer.get("error"):
        return False
    if kind == "outside":
        return row.verdict == "unnamed"
    if kind == "wrong":  # that a number in a law is wrong may well be seen, and has no name
        return row.verdict in ("none", "unnamed") or row.classed
    if kind in ("nothing", "low"):
        return row.verdict == "none"
    if kind == "effect" and not row.truth["identifiable"]:
        return not row.false
    return row.named and row.classed


def _figures(rows: Sequence[Judged], named: Sequence[Judged]) -> list[tuple[str, int, Limit]]:
    """Return gaps, coefficients and times."""
    gone = [row.removed for row in named if not math.isnan(row.removed)]
    errors = [error for row in named for error in row.errors]
    covered = [each for row in named for each in row.covered]
    seconds = [row.seconds for row in rows if not math.isnan(row.seconds)]
    found = [
        ("held-out gap removed, median", gone, _quantile(gone, 0.5), 0.9, True),
        ("held-out gap removed, tenth percentile", gone, _quantile(gone, 0.1), 0.6, True),
        (
            "coefficients within 10 %",
            errors,
            statistics.fmean(e <= 0.1 for e in errors) if errors else math.nan,
            0.9,
            True,
        ),
        (
            "coefficients within their 95 % band (at most 0.98)",
            covered,
            statistics.fmean(covered) if covered else math.nan,
            0.9,
            True,
        ),
        ("seconds a case, median", seconds, _quantile(seconds, 0.5), 30.0, False),
        ("seconds a case, worst", seconds, max(seconds, default=math.nan), 30.0, False),
    ]
    return [
        (what, len(values), Limit(what, value, limit, least))
        for what, values, value, limit, least in found
    ]


def _kind(rows: Iterable[Judged], kind: str) -> list[Judged]:
    return [row for row in rows if row.truth["kind"] == kind]


def _quantile(values: Sequence[float], share: float) -> float:
    return float(numpy.quantile(values, share)) if values else math.nan


def _number(limit: Limit) -> str:
    return _worded(limit.value) if limit.limit > 1 else _percent(limit.value)


def _asked(limit: Limit) -> str:
    size = f"{limit.limit:g} s" if limit.limit > 1 else f"{limit.limit:.0%}"
    return f"{'at least' if limit.least else 'at most'} {size}"


def _percent(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.0%}"


def _worded(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.1f}"
