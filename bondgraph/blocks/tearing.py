"""Tearing: which variables of a loop to solve for, so that the others follow one by one."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping

import networkx
import sympy


def links(
    variables: Iterable[sympy.Symbol], table: Mapping[sympy.Symbol, sympy.Expr]
) -> networkx.DiGraph:
    """Return which variable is needed for which, as edges.

    Examples
    --------
    >>> x, y = sympy.symbols("x y")
    >>> list(links([x, y], {x: y + 1, y: sympy.Integer(2)}).edges)
    [(y, x)]
    """
    members = list(variables)
    inside = set(members)
    network = networkx.DiGraph()
    network.add_nodes_from(members)
    for variable in members:
        needs = [symbol for symbol in table[variable].free_symbols if symbol in inside]
        network.add_edges_from((need, variable) for need in sorted(needs, key=str))
    return network


def tear(
    variables: Iterable[sympy.Symbol], table: Mapping[sympy.Symbol, sympy.Expr]
) -> list[sympy.Symbol]:
    """Choose variables whose removal leaves no loop, the busiest first.

    What has nothing before it or nothing after it is on no loop and peels off.

    Parameters
    ----------
    variables : iterable of Symbol
    table : mapping of Symbol to Expr

    Returns
    -------
    list of Symbol

    Examples
    --------
    >>> x, y, z = sympy.symbols("x y z")
    >>> tear([x, y, z], {x: y + z, y: 2 * x, z: 3 * x})
    [x]
    """
    members = list(variables)
    network = links(members, table)
    place = {variable: index for index, variable in enumerate(members)}
    queue: list[tuple[int, int]] = []

    def enqueue(changed: Iterable[sympy.Symbol]) -> None:
        for variable in changed:
            heapq.heappush(queue, (_rank(network, variable), place[variable]))

    tears = [variable for variable in members if network.has_edge(variable, variable)]
    network.remove_nodes_from(tears)
    enqueue(_peel(network, list(network)))
    while queue:
        rank, index = heapq.heappop(queue)
        variable = members[index]
        if variable in network and rank == _rank(network, variable):
            tears.append(variable)
            beside = [*network.predecessors(variable), *network.successors(variable)]
            network.remove_node(variable)
            enqueue(_peel(network, beside))
    return tears


def _rank(network: networkx.DiGraph, variable: sympy.Symbol) -> int:
    """Return a number that is least for what most paths go through."""
    return -network.in_degree(variable) * network.out_degree(variable)


def _peel(network: networkx.DiGraph, start: list[sympy.Symbol]) -> set[sympy.Symbol]:
    """Remove what can be on no loop; return what was looked at and stayed."""
    stayed = set()
    stack = list(start)
    while stack:
        variable = stack.pop()
        if variable not in network:
            continue
        if network.in_degree(variable) and network.out_degree(variable):
            stayed.add(variable)
            continue
        stack += [*network.predecessors(variable), *network.successors(variable)]
        network.remove_node(variable)
        stayed.discard(variable)
    return stayed


def in_order(
    variables: Iterable[sympy.Symbol], table: Mapping[sympy.Symbol, sympy.Expr]
) -> list[sympy.Symbol]:
    """Sort variables without loops by their dependencies."""
    return list(networkx.topological_sort(links(variables, table)))


def around(
    variables: Iterable[sympy.Symbol], table: Mapping[sympy.Symbol, sympy.Expr]
) -> list[sympy.Symbol]:
    """Walk once round a loop, for the report; the variables beside it follow."""
    network = links(variables, table)
    try:
        cycle = [edge[0] for edge in networkx.find_cycle(network)]
    except networkx.NetworkXNoCycle:
        cycle = []
    inside = set(cycle)
    return cycle + [variable for variable in network if variable not in inside]
