"""Every model of the library in every mode, with numbers to try it at."""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass

import numpy

from bondgraph import derive, in_mode, models, steady_state
from bondgraph.codegen import Program
from bondgraph.equations import Equations
from bondgraph.modes import contacts, mode_equations
from bondgraph.values import parameter_values


@dataclass(frozen=True)
class Case:
    """One model's equations: open contacts as slipping or held, or the graph of a mode."""

    name: str
    equations: Equations
    modes: dict[str, str] | None

    @property
    def arguments(self):
        eq = self.equations
        return (
            ("t", (eq.time,)),
            ("x", eq.states),
            ("u", eq.inputs),
            ("p", eq.parameters),
            ("d", eq.directions),
        )

    def program(self, **results) -> Program:
        return Program.pruned("case", self.arguments, self.equations.assignments, results)

    def points(self, count: int, seed: int = 1):
        """Random arguments about the steady state of sliding, in SI."""
        eq, rng = self.equations, numpy.random.default_rng(seed)
        values = parameter_values(eq)
        about = _steady(self.name.partition("[")[0])
        centre = numpy.array([about.get(state.name, 0.0) for state in eq.states])
        for _ in range(count):
            spread = rng.normal(size=len(centre))
            x = centre * (1 + 0.3 * spread) + (numpy.abs(centre) < 1e-20) * 0.1 * spread
            u = rng.normal(size=len(eq.inputs))
            p = [values[symbol.name] for symbol in eq.parameters]
            yield [0.7], x, u, p, rng.choice([-1.0, 1.0], size=len(eq.directions))


@functools.cache
def _steady(name):
    return steady_state(getattr(models, name).graph()).states


@functools.cache
def graph(name):
    return getattr(models, name).graph()


def held(name, stuck):
    """Equations with contacts held at a slip that is imposed on them."""
    base = derive(graph(name))
    return mode_equations(base, stuck).equations if stuck else base


def _combinations(name, labels):
    names = contacts(graph(name))
    for chosen in itertools.product(labels, repeat=len(names)):
        yield dict(zip(names, chosen, strict=True))


def modes(name):
    """Every combination of modes of a model's contacts."""
    return list(_combinations(name, ("slip+", "slip-", "stick")))


@functools.cache
def cases() -> tuple[Case, ...]:
    """All equations there are of the library's models."""
    found = []
    for name in models.LIBRARY:
        for chosen in _combinations(name, ("open", "held")):
            stuck = [contact for contact, what in chosen.items() if what == "held"]
            found.append(Case(f"{name}[{','.join(chosen.values())}]", held(name, stuck), None))
        for chosen in modes(name) if contacts(graph(name)) else ():
            equations = derive(in_mode(graph(name), chosen))
            found.append(Case(f"{name}[{','.join(chosen.values())}]", equations, chosen))
    return tuple(found)
