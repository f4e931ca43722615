"""Strongly connected components, in an order in which each needs only earlier ones."""

from __future__ import annotations

from collections.abc import Sequence


def components(needs: Sequence[Sequence[int]]) -> list[list[int]]:
    """Group what needs each other, in an order in which the groups can be worked out.

    Parameters
    ----------
    needs : sequence of sequence of int
        What each number needs, by number.

    Returns
    -------
    list of list of int
        Each sorted: first the groups that need nothing, then those that need only these, and
        so on.

    References
    ----------
    Tarjan, Depth-first search and linear graph algorithms, SIAM J. Comput. 1 (1972) 146-160.

    Examples
    --------
    >>> components([[2], [0], [1], [], [2, 3]])
    [[0, 1, 2], [3], [4]]
    """
    users: list[list[int]] = [[] for _ in needs]
    for number, wanted in enumerate(needs):
        for need in wanted:
            users[need].append(number)
    groups = _connected(users)
    return [groups[place] for place in _layers(groups, users)]


def _connected(users: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the strongly connected components; none is used by a later one."""
    groups: list[list[int]] = []
    closed = len(users) + 1
    met = [0] * len(users)  # counted from one
    low = [0] * len(users)  # the first met that is known to be in the same group
    following = [iter(wanted) for wanted in users]
    waiting: list[int] = []
    count = 0
    for start in range(len(users)):
        path = [] if met[start] else [start]
        while path:
            number = path[-1]
            if not met[number]:
                count += 1
                met[number] = low[number] = count
                waiting.append(number)
            for user in following[number]:
                if not met[user]:
                    path.append(user)
                    break
            else:
                path.pop()
                low[number] = min([low[number], *(low[user] for user in users[number])])
                if low[number] == met[number]:
                    group = [waiting.pop()]
                    while group[-1] != number:
                        group.append(waiting.pop())
                    for member in group:
                        low[member] = closed
                    groups.append(sorted(group))
    return groups


def _layers(groups: Sequence[Sequence[int]], users: Sequence[Sequence[int]]) -> list[int]:
    """Return the places of the groups, layer by layer: each needs only earlier layers."""
    place = {member: index for index, group in enumerate(groups) for member in group}
    after = [
        dict.fromkeys(place[user] for member in group for user in users[member]) for group in groups
    ]
    missing = [0] * len(groups)
    for index, following in enumerate(after):
        following.pop(index, None)
        for user in following:
            missing[user] += 1
    order = [index for index, count in enumerate(missing) if count == 0]
    for index in order:  # grows on the way
        for user in after[index]:
            missing[user] -= 1
            if missing[user] == 0:
                order.append(user)
    return order
