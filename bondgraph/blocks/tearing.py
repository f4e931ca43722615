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

    def busy(variable: sympy.Symbol) -> int:
        return -network.in_degree(variable) * network.out_degree(variable)

    tears = [variable for variable in members if network.has_edge(variable, variable)]
    queue = [(busy(variable), place[variable]) for variable in members]
    heapq.heapify(queue)
    _peel(network, tears + members)
    for variable in tears:
        _take(network, variable, queue, busy, place)
    while network:
        worth, index = heapq.heappop(queue)
        variable = members[index]
        if variable in network and worth == busy(variable):
            tears.append(variable)
            _take(network, variable, queue, busy, place)
    return tears
