"""Brakes drawn over engineering ranges, with answers stored so that tests need not solve them.

``python -m tests.oracles.random_brakes`` writes ``random_brakes.json`` afresh (two minutes);
the drawing depends on the seed alone.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .brake import STATES, Brake, Run, parameters, sliding_matrix, solve

STORE = Path(__file__).with_name("random_brakes.json")
T_END = 0.5
GRID = np.arange(4, 61, 4) * 1e-3
FIRST = 5

# log-uniform between the two ends; mu_s is drawn as a ratio to mu_k
RANGES: Mapping[str, tuple[float, float]] = {
    "k_f": (120e3, 900e3),
    "k_w": (30e3, 250e3),
    "f_f": (150.0, 600.0),
    "f_w": (80.0, 400.0),
    "r_r": (0.07, 0.11),
    "r_t": (0.25, 0.37),
    "zeta_f": (0.01, 0.1),
    "zeta_w": (0.01, 0.1),
    "V0": (0.2, 2.0),
    "mu_k": (0.25, 0.55),
    "v_s": (0.02, 0.3),
    "F_k": (200.0, 1500.0),
    "tau": (0.005, 0.1),
}
STATIC_RATIO = (1.0, 1.5)


@dataclass(frozen=True)
class Case:
    """A brake, its start where that differs from steady rolling, and why it was kept."""

    brake: Brake
    kind: str
    initial: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Conditioning:
    """How firmly the order of events is decided.

    Attributes
    ----------
    margin : least dimensionless distance to another order of events, as `brake.solve` defines it
    spread : greatest change of the first stick and slip times between rtol 1e-12 and 1e-9, s
    gain : greatest change of any event time, s, over the relative change of parameters causing it
    clearance : time between `t_end` and the event nearest to it, s
    """

    margin: float
    spread: float
    gain: float
    clearance: float

    @property
    def sound(self) -> bool:
        """Whether another solver at moderate accuracy must find the same number of events."""
        return (
            self.margin > 1e-2 and self.spread < 1e-8 and self.gain < 5.0 and self.clearance > 1e-4
        )


class Solved(NamedTuple):
    """A case, its solution and how well conditioned it is."""

    case: Case
    run: Run
    conditioning: Conditioning


def draw(rng: np.random.Generator) -> Brake:
    """One brake with every parameter drawn."""
    values = {
        name: float(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.4g}")
        for name, (low, high) in RANGES.items()
    }
    values["mu_s"] = float(f"{values['mu_k'] * rng.uniform(*STATIC_RATIO):.4g}")
    return Brake(**values)


def condition(case: Case, run: Run) -> Conditioning | None:
    """Conditioning of a run, or None where a slight change already alters the events."""
    loose = solve(case.brake, T_END, initial=case.initial, rtol=1e-9)
    bump = 1e-8
    # every parameter moves, in no common proportion, so that no symmetry hides a sensitivity
    moved = {
        name: value * (1 + bump * math.cos(1.7 * i))
        for i, (name, value) in enumerate(parameters(case.brake).items())
    }
    near = solve(Brake(**moved), T_END, initial=case.initial)
    sequence = [event[1:] for event in run.events]
    if any([event[1:] for event in other.events] != sequence for other in (loose, near)):
        return None

    def change(other: Run, count: int | None) -> float:
        pairs = zip(run.events[:count], other.events[:count], strict=True)
        return max((abs(a.t - b.t) for a, b in pairs), default=0.0)

    return Conditioning(
        margin=run.margin,
        spread=change(loose, 2 * FIRST),
        gain=change(near, None) / bump,
        clearance=min((T_END - e.t for e in run.events[-1:]), default=T_END),
    )


def judge(case: Case) -> Solved | None:
    """Solve a case; None if it is not sound."""
    run = solve(case.brake, T_END, t_eval=GRID, initial=case.initial)
    found = condition(case, run)
    return Solved(case, run, found) if found is not None and found.sound else None


def parameter_sets(n: int, seed: int) -> list[Solved]:
    """Draw `n` brakes whose events are decided firmly enough for any solver to find them all."""
    rng = np.random.default_rng(seed)
    return list(islice(_sound(lambda: Case(draw(rng), "drawn")), n))


def _sound(
    make: Callable[[], Case], accept: Callable[[Run], bool] = lambda run: True
) -> Iterator[Solved]:
    while True:
        solved = judge(make())
        if solved is not None and accept(solved.run):
            yield solved


def varied_sets(seed: int) -> list[Solved]:
    """The stored choice: every kind of behaviour the automaton can show, some of it several times.

    ``quiet`` never sticks, ``brief`` sticks one to five times, ``cycle`` keeps sticking,
    ``coulomb`` has equal coefficients of friction, ``crossing`` starts with a ringing frame whose
    slip reverses under light pads, and two ``tau`` cases differ in the rate of application alone:
    one settles, one keeps its limit cycle, so steady sliding and the cycle coexist.
    """
    rng = np.random.default_rng(seed)

    def drawn(kind: str) -> Callable[[], Case]:
        return lambda: Case(draw(rng), kind)

    def coulomb() -> Case:
        brake = draw(rng)
        return Case(replace(brake, mu_s=brake.mu_k), "coulomb")

    def ringing() -> Case:
        brake = draw(rng)
        speed = brake.V0 * rng.uniform(1.5, 4.0)
        start = {"x_c": float(f"{speed / (2 * math.pi * brake.f_f):.4g}"), "V_c": 0.0}
        return Case(brake, "crossing", start)

    kinds: list[tuple[int, Callable[[], Case], Callable[[Run], bool]]] = [
        (1, drawn("quiet"), lambda run: not run.stick_times),
        (2, drawn("brief"), lambda run: 1 <= len(run.stick_times) <= 5),
        (5, drawn("cycle"), lambda run: len(run.stick_times) > 10),
        (1, coulomb, lambda run: len(run.stick_times) > 0),
        (2, ringing, lambda run: len(run.crossing_times) > 2 and len(run.stick_times) > 5),
    ]
    found = [s for n, make, accept in kinds for s in islice(_sound(make, accept), n)]
    return found + _tau_pair(rng)


def _tau_pair(rng: np.random.Generator) -> list[Solved]:
    while True:
        brake = draw(rng)
        if np.linalg.eigvals(sliding_matrix(brake)).real.max() > -5:
            continue
        pair = [judge(Case(replace(brake, tau=tau), "tau")) for tau in (0.1, 0.01)]
        slow, fast = (0 if s is None else len(s.run.stick_times) for s in pair)
        if None not in pair and slow == 0 and fast > 10:
            return [s for s in pair if s is not None]


def record(solved: Solved) -> dict[str, Any]:
    """What is stored of a solved case."""
    case, run = solved.case, solved.run
    return {
        "kind": case.kind,
        "parameters": parameters(case.brake),
        "initial": dict(case.initial),
        "n_stick": len(run.stick_times),
        "n_slip": len(run.slip_times),
        "n_crossing": len(run.crossing_times),
        "t_stick": run.stick_times[:FIRST],
        "t_slip": run.slip_times[:FIRST],
        "t_crossing": run.crossing_times[:FIRST],
        "states": np.column_stack([run.t, run.states]).tolist(),
        "final": run.final.tolist(),
        "energy": dict(run.energies),
        "conditioning": asdict(solved.conditioning),
    }


def stored() -> list[dict[str, Any]]:
    """The stored cases; columns of ``states`` are t and the names of `brake.STATES`."""
    cases: list[dict[str, Any]] = json.loads(STORE.read_text(encoding="utf-8"))["cases"]
    return cases


def write(seed: int = 2014) -> None:
    """Write the store afresh."""
    data = {
        "source": "Parameters drawn by tests/oracles/random_brakes.py; numbers by the event-driven "
        "DOP853 solver of tests/oracles/brake.py at rtol 1e-12. SI units.",
        "seed": seed,
        "t_end": T_END,
        "columns": ["t", *STATES],
        "cases": [record(solved) for solved in varied_sets(seed)],
    }
    text = json.dumps(data, indent=1)
    # a row of numbers takes one line
    row = re.compile(r"\[\s+((?:[-+\d.e]+,\s+)*[-+\d.e]+)\s+\]")
    text = row.sub(lambda match: "[" + re.sub(r"\s+", " ", match[1]) + "]", text)
    STORE.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    write()
