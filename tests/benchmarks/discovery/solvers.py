"""Who answers: functions from a case's folder to an answer, each named ``module:function``."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .machines import MACHINES


def engine(folder: Path) -> dict[str, Any]:
    """Ask `bondgraph.discover`."""
    from bondgraph import discover
    from bondgraph.discrepancy import Measurement

    told = json.loads((folder / "case.json").read_text(encoding="utf-8"))
    train, validate = (
        Measurement.read(folder / f"{name}.csv", holds=told.get("holds"))
        for name in ("train", "validate")
    )
    begun = time.perf_counter()
    found = discover(MACHINES[told["model"]](), [train], validation=[validate])
    return answer(found) | {"seconds": time.perf_counter() - begun}


def answer(found: Any) -> dict[str, Any]:
    """Return what a `bondgraph.discrepancy.discovery.Discovery` says, as JSON can hold it."""
    return {
        "verdict": str(found.verdict),
        "effects": [
            {
                "name": effect.name,
                "site": effect.site,
                "parameters": {
                    name: [estimate.value, estimate.std]
                    for name, estimate in effect.parameters.items()
                },
            }
            for effect in found.effects
        ],
        "gap": _gaps(found.gap.get("validation", {})),
        "chosen": found.chosen.label if found.chosen else "",
        "words": list(found.words),
    }


def _gaps(gaps: Mapping[str, Any]) -> dict[str, list[float]]:
    return {
        name: [gap.nominal, gap.before, gap.after, gap.noise_floor] for name, gap in gaps.items()
    }
