"""Stiff problems as bond graphs, with what others found for them."""

from __future__ import annotations

import numpy as np

from bondgraph import C, One, R, Se, Sf, Zero, assemble

# H. H. Robertson's kinetics at t = 40 s, from the example in SUNDIALS' documentation of CVODE.
ROBERTSON_40 = (7.1583e-01, 9.1850e-06, 2.8416e-01)
# F. Mazzia, C. Magherini, Test Set for Initial Value Problem Solvers, release 2.4: van der Pol.
VAN_DER_POL_2000 = (1.706167732170469, -0.8928097010248125e-3)


def rates(name, laws, initial):
    """Graph of ``x' = law(x)``: each state the charge of a unit capacitor behind a flow source."""
    parts = [C(f"c{i}", 1, initial=value) for i, value in enumerate(initial)]
    flows = laws(*(part.q for part in parts))
    return assemble(
        name,
        *(
            Sf(f"f{i}", flow) >> Zero(f"z{i}") >> part
            for i, (flow, part) in enumerate(zip(flows, parts, strict=True))
        ),
    )


def robertson():
    """Slow, very fast and fast reactions of three substances."""

    def laws(x, y, z):
        slow, fast, very = x / 25, 10**4 * y * z, 3 * 10**7 * y**2
        return fast - slow, slow - fast - very, very

    return rates("robertson", laws, (1, 0, 0))


def van_der_pol(mu=1000):
    """Relaxation oscillations of period 1.6 mu."""
    return rates("van_der_pol", lambda x, v: (v, mu * (1 - x**2) * v - x), (2, 0))


def ladder(capacitances):
    """One volt on a chain of resistors of 1 ohm, a capacitor at each node."""
    node, parts = One("in"), []
    parts.append(Se("E", 1) >> node)
    for i, capacitance in enumerate(capacitances):
        at = Zero(f"n{i}")
        parts += [node >> R(f"r{i}", 1), node >> at, at >> C(f"c{i}", capacitance)]
        if i + 1 < len(capacitances):
            node = One(f"o{i}")
            parts.append(at >> node)
    return assemble("ladder", *parts)


def ladder_matrix(capacitances):
    """Of the node voltages, and the drive: v' = A v + b."""
    size = len(capacitances)
    conductance = 2 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1)
    conductance[-1, -1] = 1
    inverse = np.diag(1 / np.array(capacitances))
    return -inverse @ conductance, inverse[:, 0]
