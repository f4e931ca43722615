"""Around a search: where held-out recordings start, and what to measure next."""

from __future__ import annotations

from collections.abc import Sequence

from ..latent.relax import Relaxed, followed
from .judge import Judgement
from .prepare import Prepared
from .search import Found
from .trial import Bench
from .verdict import Verdict


def relaxed_starts(found: Relaxed, held: Sequence[Prepared]) -> list[dict[str, float]]:
    """Return where the smoother says that other recordings begin."""
    names = [state.name for state in found.functions.equations.states]
    starts = []
    for row in held:
        course = followed(found, row.record(found.functions.outputs))
        starts.append(dict(zip(names, course.x[0].tolist(), strict=True)))
    return starts


def advice_for(bench: Bench, found: Found, said: Judgement) -> tuple[str, ...]:
    """Return what to measure next."""
    if said.verdict is Verdict.AMBIGUOUS:
        return ("measure a signal nearer to where the candidates differ, or excite more strongly",)
    return ()
