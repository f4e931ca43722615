"""Numbers that stand in laws: they may be off as well, and then no effect is missing."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import sympy

from ...elements import GY, TF, C, Element, I, R
from ...errors import BondGraphError
from ...graph import BondGraph
from ...parameters import Parameter
from ...simulation import CompiledModel
from ..candidates.builders import stands_for
from .bench import Bench, Trial
from .compare import delta_bic
from .trial import tried

MOST = 12  # elements that are looked at
SLACK = 6.0  # by which the criterion may prefer an effect before a number is no explanation


@dataclass(frozen=True, eq=False)
class Constant:
    """An element whose number explains the data as well as an effect would.

    Attributes
    ----------
    element : str
    factor, std : float
        By which its number is off.
    trial : Trial
        The model by itself with that number fitted too.
    """

    element: str
    factor: float
    std: float
    trial: Trial


def loosened(graph: BondGraph) -> Iterator[tuple[str, str, BondGraph]]:
    """Yield the graph with one number let loose: elements whose law holds no parameter.

    Yields
    ------
    element, parameter : str
        The parameter is a factor of the element's law, one at first.
    graph : BondGraph

    Examples
    --------
    >>> from bondgraph import C, One, R, assemble
    >>> graph = assemble("rc", One("loop") >> (R("load", 50), C("store", sympy.Symbol("c"))))
    >>> [(element, name) for element, name, _ in loosened(graph)]
    [('load', 'load_factor')]
    """
    taken = {symbol.name for symbol in (*graph.parameters, *graph.inputs)}
    for label, element in graph.elements.items():
        name = f"{label.replace('.', '_').replace(' ', '_')}_factor"
        factor = sympy.Symbol(name, positive=True)
        twin = None if name in taken else _scaled(element, factor)
        if twin is None:
            continue
        exchanged = stands_for(twin, element)
        table = {**graph.parameters, factor: Parameter(1.0, meaning=f"{label}, over its number")}
        yield (
            label,
            name,
            replace(graph, elements={**graph.elements, label: exchanged}, parameters=table),
        )


def _scaled(element: Element, factor: sympy.Symbol) -> Element | None:
    own = set(element.symbols.values())
    if getattr(element, "partners", None) or not isinstance(element, R | C | I | TF | GY):
        return None
    if any(law.free_symbols - own for law in element.laws.values()):
        return None
    if isinstance(element, R) and element.effort is not None:
        effort = element.effort
        return R(element.name, effort=lambda f: factor * effort.xreplace({element.f: f}))
    if isinstance(element, R):
        flow = element.flow
        assert flow is not None
        return R(element.name, flow=lambda e: flow.xreplace({element.e: e}) / factor)
    if isinstance(element, C):
        return C(
            element.name,
            effort=lambda q: factor * element.law.xreplace({element.q: q}),
            initial=element.initial,
        )
    if isinstance(element, I):
        return I(
            element.name,
            flow=lambda p: element.law.xreplace({element.p: p}) / factor,
            initial=element.initial,
        )
    return type(element)(element.name, factor * element.ratio)


def constant_off(
    bench: Bench, base: Trial, best: Trial, tell: Callable[[str], object]
) -> Constant | None:
    """Return the number that explains the data as well as the best effects do, if there is one.

    Parameters
    ----------
    bench : Bench
    base, best : Trial
        The model by itself, and with effects.
    tell : callable

    Returns
    -------
    Constant or None
    """
    found: Constant | None = None
    gain = delta_bic(base, best) - SLACK
    for number, (element, name, graph) in enumerate(loosened(bench.graph)):
        if number >= MOST or bench.late:
            break
        tell(f"fitting the number of {element}")
        try:
            model = CompiledModel(graph)
        except BondGraphError:
            continue
        loose = replace(
            bench,
            graph=graph,
            model=model,
            free=(*bench.free, name),
            given={**bench.given, name: 1.0},
        )
        trial = tried(loose, (), [{**base.values, name: 1.0}])
        if not isinstance(trial, Trial):
            continue
        own = delta_bic(base, trial) - math.log(max(sum(trial.effective.values()), 2.0))
        if own >= gain:
            gain = own
            found = Constant(element, trial.values[name], trial.fit.std[name], trial)
    return found
