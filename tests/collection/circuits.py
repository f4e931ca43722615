"""Filters, bridges and meshes: from Kirchhoff's laws by hand.

Node voltages without a capacitance to ground have no rate, and a balance of currents ties them.
"""

import sympy
from sympy import Rational as Q

from bondgraph import TF, C, I, One, R, Se, Sf, Zero, assemble

from .case import Case, quantities

E, J, DE = (sympy.Symbol(name, real=True) for name in ("E", "J", "der(E)"))
a, b, c, d, r, s, w, z, L, K, n = sympy.symbols("a b c d r s w z L K n", positive=True)


def pi_filter() -> Case:
    x, (u, i, v, du, di, dv) = quantities("u i v")
    source, first, choke, last = One("source"), Zero("first"), One("choke"), Zero("last")
    graph = assemble(
        "pi",
        Se("supply", E) >> source >> (R("r", r), first),
        first >> (C("a", a), choke),
        choke >> (I("l", L), last),
        last >> (C("b", b), R("load", s)),
        inputs=[E],
    )
    balances = (a * du - (E - u) / r + i, L * di - u + v, b * dv - i + v / s)
    states = {"a.q": a * u, "l.p": L * i, "b.q": b * v}
    return Case(graph, x, balances, states, {r: 2, a: Q(1, 3), L: 5, b: Q(1, 7), s: 11})


def pi_filter_without_resistance() -> Case:
    """The first capacitor follows the source and is no state."""
    x, (i, v, di, dv) = quantities("i v")
    first, choke, last = Zero("first"), One("choke"), Zero("last")
    graph = assemble(
        "pi",
        Se("supply", E) >> first >> (C("a", a), choke),
        choke >> (I("l", L), last),
        last >> (C("b", b), R("load", s)),
        inputs=[E],
    )
    balances = (L * di - E + v, b * dv - i + v / s)
    return Case(graph, x, balances, {"l.p": L * i, "b.q": b * v}, {L: 5, b: Q(1, 7), s: 11, a: 3})


def capacitive_divider() -> Case:
    """Two capacitors in series across a source: its rate drives them."""
    x, (v, dv) = quantities("v")
    loop, out = One("loop"), Zero("out")
    graph = assemble(
        "divider",
        Se("supply", E) >> loop >> (C("a", a), out),
        out >> (C("b", b), R("r", r)),
        inputs=[E],
    )
    balances = (a * (DE - dv) - b * dv - v / r,)
    return Case(graph, x, balances, {"a.q": a * (E - v)}, {a: 2, b: 3, r: 5})


def loop_with_two_states() -> Case:
    """Two capacitors joined by a star of three resistors: one loop, two states in it."""
    x, (u, v, e, du, dv, _) = quantities("u v e")
    one, node, two = One("one"), Zero("node"), One("two")
    graph = assemble(
        "star",
        one >> R("r", r),
        Zero("u") >> (C("a", a), one),
        one >> node >> (R("s", s), two),
        two >> (R("w", w), Zero("v") >> C("b", b)),
    )
    balances = (a * du + (u - e) / r, b * dv - (e - v) / w, (u - e) / r - e / s - (e - v) / w)
    return Case(graph, x, balances, {"a.q": a * u, "b.q": b * v}, {a: 2, b: 3, r: 5, s: 7, w: 11})


def loop_with_a_coil_and_a_capacitor() -> Case:
    """A coil and a capacitor fed through resistors that both decide."""
    x, (i, v, e, di, dv, _) = quantities("i v e")
    source, node, coil, last = One("source"), Zero("node"), One("coil"), One("last")
    graph = assemble(
        "tee",
        Se("supply", E) >> source >> (R("r", r), node),
        node >> (R("s", s), coil, last),
        coil >> (I("l", L), R("z", z)),
        last >> (R("w", w), C("c", c)),
        inputs=[E],
    )
    balances = (
        L * di - e + z * i,
        w * c * dv - e + v,
        (E - e) / r - e / s - i - (e - v) / w,
    )
    values = {r: 2, s: 3, L: 5, z: 7, w: 11, c: Q(1, 13)}
    return Case(graph, x, balances, {"l.p": L * i, "c.q": c * v}, values)


def _branch(tail, head, name, *elements):
    """Elements in series between two nodes."""
    return tail >> One(name) >> (*elements, head)


def bridge() -> Case:
    """Wheatstone's bridge of resistors, a capacitor, a coil, and a resistor across."""
    x, (u, v, i, du, _, di) = quantities("u v i")
    top, left, right = Zero("top"), Zero("left"), Zero("right")
    graph = assemble(
        "bridge",
        Se("supply", E) >> top,
        _branch(top, left, "tl", R("r", r)),
        _branch(top, right, "tr", R("s", s)),
        _branch(left, right, "lr", R("w", w)),
        left >> C("c", c),
        right >> One("coil") >> (I("l", L), R("z", z)),
        inputs=[E],
    )
    balances = (
        c * du - (E - u) / r + (u - v) / w,
        (E - v) / s + (u - v) / w - i,
        L * di + z * i - v,
    )
    values = {r: 2, s: 3, w: 5, c: Q(1, 7), L: 11, z: 13}
    return Case(graph, x, balances, {"c.q": c * u, "l.p": L * i}, values)


def bridge_of_capacitors() -> Case:
    """Capacitors in the lower arms, resistors in the upper ones and a coil across."""
    x, (u, v, i, du, dv, di) = quantities("u v i")
    top, left, right = Zero("top"), Zero("left"), Zero("right")
    graph = assemble(
        "bridge",
        Se("supply", E) >> One("in") >> (R("r", r), top),
        _branch(top, left, "tl", R("z", z)),
        _branch(top, right, "tr", R("w", w)),
        _branch(left, right, "lr", I("l", L)),
        left >> (C("a", a), R("s", s)),
        right >> C("b", b),
        inputs=[E],
    )
    e = (E / r + u / z + v / w) / (1 / r + 1 / z + 1 / w)  # the top's voltage, by Millman
    balances = (
        a * du - (e - u) / z + u / s + i,
        b * dv - (e - v) / w - i,
        L * di - u + v,
    )
    values = {r: 2, z: 3, w: 5, a: Q(1, 7), b: Q(1, 11), s: 13, L: 17}
    return Case(graph, x, balances, {"a.q": a * u, "b.q": b * v, "l.p": L * i}, values)


def parallel_branches() -> Case:
    """Two nodes with two branches between them: a ring 0-1-0-1."""
    x, (u, v, i, du, dv, di) = quantities("u v i")
    left, right = Zero("left"), Zero("right")
    graph = assemble(
        "ring",
        Sf("supply", J) >> left >> C("a", a),
        _branch(left, right, "x", R("r", r)),
        _branch(left, right, "y", I("l", L)),
        right >> (C("b", b), R("load", s)),
        inputs=[J],
    )
    balances = (a * du - J + (u - v) / r + i, b * dv - (u - v) / r - i + v / s, L * di - u + v)
    states = {"a.q": a * u, "b.q": b * v, "l.p": L * i}
    return Case(graph, x, balances, states, {a: 2, b: 3, r: 5, s: 7, L: 11})


def ring_of_three_nodes() -> Case:
    """A triangle of a resistor, a coil and a resistor between three capacitors."""
    x, (u, v, e, i, du, dv, de, di) = quantities("u v e i")
    one, two, three = Zero("one"), Zero("two"), Zero("three")
    graph = assemble(
        "triangle",
        Sf("supply", J) >> one >> C("a", a),
        two >> C("b", b),
        three >> (C("c", c), R("load", w)),
        _branch(one, two, "x", R("r", r)),
        _branch(two, three, "y", I("l", L)),
        _branch(three, one, "z", R("s", s)),
        inputs=[J],
    )
    balances = (
        a * du - J + (u - v) / r - (e - u) / s,
        b * dv - (u - v) / r + i,
        c * de - i + (e - u) / s + e / w,
        L * di - v + e,
    )
    states = {"a.q": a * u, "b.q": b * v, "c.q": c * e, "l.p": L * i}
    return Case(graph, x, balances, states, {a: 2, b: 3, c: 5, r: 7, s: 11, w: 13, L: Q(1, 17)})


def triangle_of_capacitors() -> Case:
    """Three capacitors around a mesh, whose voltages add up to zero: two charges are free."""
    x, (u, v, e, du, dv, de) = quantities("u v e")
    one, two, three = Zero("one"), Zero("two"), Zero("three")
    graph = assemble(
        "delta",
        Sf("supply", J) >> one >> R("r", r),
        two >> R("s", s),
        three >> R("w", w),
        _branch(one, two, "x", C("a", a)),
        _branch(two, three, "y", C("b", b)),
        _branch(three, one, "z", C("c", c)),
        inputs=[J],
    )
    balances = (
        a * (du - dv) - c * (de - du) + u / r - J,
        b * (dv - de) - a * (du - dv) + v / s,
        c * (de - du) - b * (dv - de) + e / w,
    )
    states = {"a.q": a * (u - v), "b.q": b * (v - e)}
    return Case(graph, x, balances, states, {a: 2, b: 3, c: 5, r: 7, s: 11, w: 13})


def star_of_coils() -> Case:
    """Three coils that meet in one node: their currents add up to zero, two are free."""
    x, (i, j, di, dj) = quantities("i j")
    node = Zero("node")
    graph = assemble(
        "star",
        Se("supply", E) >> One("in") >> (I("l", L), R("r", r), node),
        node >> One("x") >> (I("k", K), R("z", z)),
        node >> One("y") >> (I("n", n), R("w", w)),
        inputs=[E],
    )
    branch = K * dj + z * j  # the node's voltage; the third coil carries i - j
    balances = (L * di + r * i - E + branch, branch - n * (di - dj) - w * (i - j))
    states = {"l.p": L * i, "k.p": K * j}
    return Case(graph, x, balances, states, {L: 2, K: 3, n: 5, r: 7, z: 11, w: 13})


def ring_with_a_transformer() -> Case:
    """A transformer ties two nodes, ``u = n v``, and a resistor joins them besides."""
    x, (v, dv) = quantities("v")
    left, right = Zero("left"), Zero("right")
    graph = assemble(
        "ring",
        Sf("supply", J) >> left >> (C("a", a), TF("t", n) >> right),
        _branch(left, right, "x", R("r", r)),
        right >> (C("b", b), R("load", s)),
        inputs=[J],
    )
    balances = ((b + n**2 * a) * dv - n * J + (n - 1) ** 2 * v / r + v / s,)
    return Case(graph, x, balances, {"a.q": a * n * v}, {a: 2, b: 3, n: 5, r: 7, s: 11})


def ring_with_a_transformer_and_a_coil() -> Case:
    """The same ring, with a coil in the other branch and no capacitor on the left."""
    x, (v, i, dv, di) = quantities("v i")
    left, right = Zero("left"), Zero("right")
    graph = assemble(
        "ring",
        Sf("supply", J) >> left >> (R("r", r), TF("t", n) >> right),
        _branch(left, right, "x", I("l", L), R("z", z)),
        right >> (C("b", b), R("load", s)),
        inputs=[J],
    )
    # into the transformer: J - n v/r - i; out of it n times that
    balances = (
        b * dv + v / s - i - n * (J - n * v / r - i),
        L * di + z * i - (n - 1) * v,
    )
    states = {"b.q": b * v, "l.p": L * i}
    return Case(graph, x, balances, states, {b: 3, n: 5, r: 7, s: 11, L: 13, z: 17})


CASES = (
    *(pi_filter, pi_filter_without_resistance, capacitive_divider, loop_with_two_states),
    *(loop_with_a_coil_and_a_capacitor, bridge, bridge_of_capacitors, parallel_branches),
    *(ring_of_three_nodes, triangle_of_capacitors, star_of_coils, ring_with_a_transformer),
    ring_with_a_transformer_and_a_coil,
)
