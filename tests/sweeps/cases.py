"""Models and quantities of these tests, where worker processes can import them."""

from __future__ import annotations

import os
import signal

import numpy as np
from sympy import symbols

from bondgraph import C, Friction, I, One, R, Se, Sf, Zero, assemble
from bondgraph.laws import exact

m, k, F, F_k = symbols("m k F F_k", positive=True)
push = symbols("push", real=True)


def oscillator():
    """An undamped mass on a spring, with a push as input: everything is a harmonic."""
    mass = I("mass", m)
    spring = C("spring", stiffness=k)
    return assemble(
        "oscillator",
        Se("hand", push) >> One("v") >> (mass, spring),
        parameters={m: (2, "kg"), k: (8, "N/m")},
        inputs={push: "N"},
        outputs={"speed": (mass.f, "m/s"), "root": (spring.q ** exact(0.5), "m^(1/2)")},
    )


def belt():
    """The belt of `tests.oracles.belt`, with its friction forces as parameters."""
    belt, body = Zero("belt"), One("body")
    return assemble(
        "belt",
        Sf("drive", 0.5) >> belt >> body >> (I("mass", 1), C("spring", stiffness=100)),
        belt >> Friction("contact", kinetic=lambda speed: F_k, breakaway=F),
        parameters={F: (12, "N"), F_k: (8, "N")},
    )


def damped():
    """A mass that slows down: quick to derive."""
    return assemble(
        "damped", One("v") >> (I("mass", m, initial=1), R("b", k)), parameters={m: 1, k: 1}
    )


def two_numbers(run):
    """Two numbers and a row of each run."""
    return {"last": run["spring.q"][-1], "row": run["spring.q"][:3]}


def of_two_shapes(run):
    """A row whose length depends on the point."""
    return np.ones(2 if run.parameters["k"] < 3 else 3)


def raises_at_three(run):
    """Fails at one point."""
    if run.parameters["k"] == 3:
        raise ZeroDivisionError("three")
    return run.parameters["k"]


def dies_at_three(run):
    """Kills the process that runs it, at one point."""
    if run.parameters["k"] == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return run.parameters["k"]


def dies_once(run):
    """Kills the first process that comes to k = 3, and no other."""
    path = os.environ["DIES_ONCE"]
    if run.parameters["k"] == 3 and not os.path.exists(path):
        open(path, "w").close()
        os.kill(os.getpid(), signal.SIGKILL)
    return run.parameters["k"]
