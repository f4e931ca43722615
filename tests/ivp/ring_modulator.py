"""The ring modulator: four diodes, three transformers, 15 states, stiff and oscillating.

After E.-H. Horneber, Analyse nichtlinearer RLCUe-Netzwerke mit Hilfe der gemischten
Potentialfunktion, Kaiserslautern 1976.
"""

import numpy as np
import sympy

from bondgraph import TF, TIME, C, I, One, R, Se, Zero, assemble
from bondgraph.graph import BondGraph

C0, CS, CP = 1.6e-8, 2e-12, 1e-8
LH, LS1, LS2, LS3 = 4.45, 2e-3, 5e-4, 5e-4
R0, RP, RG1, RG2, RG3, RI, RC = 25e3, 50.0, 36.3, 17.3, 17.3, 50.0, 600.0
GAMMA, DELTA = 40.67286402e-9, 17.7493332
T_END = 1e-3

REFERENCE = np.array(
    [
        *(-0.2339057358486745e-1, -0.7367485485540825e-2, 0.2582956709291169),
        *(-0.4064465721283450, -0.4039455665149794, 0.2607966765422943),
        *(0.1106761861269975, 0.2939904342435596e-6, -0.2840029933642329e-7),
        *(0.7267198267264553e-3, 0.7929487196960840e-3, -0.7255283495698965e-3),
        *(-0.7941401968526521e-3, 0.7088495416976114e-4, 0.2390059075236570e-4),
    ]
)


def graph() -> BondGraph:
    """Draw the circuit; output ``y1`` to ``y15`` are the test set's unknowns."""
    node = {k: Zero(f"n{k}") for k in range(1, 8)}
    branch = {k: One(f"b{k}") for k in range(10, 16)}
    way = {k: One(f"d{k}") for k in range(1, 5)}
    ring, drop = Zero("ring"), One("drop")
    coil = {8: I("L8", LH), 9: I("L9", LH)}
    u_in1 = 0.5 * sympy.sin(2000 * sympy.pi * TIME)
    u_in2 = 2 * sympy.sin(20000 * sympy.pi * TIME)

    def diode(k: int) -> R:
        return R(f"diode{k}", flow=lambda e: GAMMA * (sympy.exp(DELTA * e) - 1))

    def leg(k: int, inductance: float, resistance: float) -> list:
        return [branch[k] >> (I(f"L{k}", inductance), R(f"R{k}", resistance))]

    return assemble(
        "ring_modulator",
        [node[k] >> (C(f"C{k}", C0), R(f"R{k}", R0)) for k in (1, 2)],
        [node[k] >> C(f"C{k}", CS) for k in (3, 4, 5, 6)],
        node[7] >> (C("C7", CP), R("R7", RP)),
        node[1] >> coil[8],
        node[2] >> coil[9],
        leg(10, LS2, RG2),
        leg(11, LS3, RG3),
        leg(12, LS2, RG2),
        leg(13, LS3, RG3),
        leg(14, LS1, RI + RG1),
        leg(15, LS1, RC + RG1),
        node[1] >> TF("t10", 2) >> branch[10] >> node[3],
        node[4] >> branch[11] >> TF("t11", 0.5) >> node[1],
        node[2] >> TF("t12", 2) >> branch[12] >> node[5],
        node[6] >> branch[13] >> TF("t13", 0.5) >> node[2],
        Se("in1", u_in1) >> branch[14] >> node[1],
        branch[15] >> node[2],
        [way[k] >> diode(k) for k in way],
        node[3] >> way[1] >> (node[5], ring),
        node[6] >> way[2] >> (node[4], ring),
        (node[4], node[5], ring) >> way[3],
        ring >> way[4] >> (node[3], node[6]),
        ring >> drop >> node[7],
        drop >> Se("in2", u_in2),
        outputs={
            **{f"y{k}": node[k].e for k in range(1, 8)},
            "y8": -coil[8].f,
            "y9": -coil[9].f,
            **{f"y{k}": branch[k].f for k in range(10, 16)},
        },
    )


def published(t: float, y: np.ndarray) -> np.ndarray:
    """The equations as the test set prints them; y of shape (15,)."""
    y1, y2, y3, y4, y5, y6, y7, y8, y9, y10, y11, y12, y13, y14, y15 = y
    u1, u2 = 0.5 * np.sin(2000 * np.pi * t), 2 * np.sin(20000 * np.pi * t)
    q1, q2, q3, q4 = (
        GAMMA * np.expm1(DELTA * u)
        for u in (y3 - y5 - y7 - u2, -y4 + y6 - y7 - u2, y4 + y5 + y7 + u2, -y3 - y6 + y7 + u2)
    )
    return np.array(
        [
            (y8 - 0.5 * y10 + 0.5 * y11 + y14 - y1 / R0) / C0,
            (y9 - 0.5 * y12 + 0.5 * y13 + y15 - y2 / R0) / C0,
            (y10 - q1 + q4) / CS,
            (-y11 + q2 - q3) / CS,
            (y12 + q1 - q3) / CS,
            (-y13 - q2 + q4) / CS,
            (-y7 / RP + q1 + q2 - q3 - q4) / CP,
            -y1 / LH,
            -y2 / LH,
            (0.5 * y1 - y3 - RG2 * y10) / LS2,
            (-0.5 * y1 + y4 - RG3 * y11) / LS3,
            (0.5 * y2 - y5 - RG2 * y12) / LS2,
            (-0.5 * y2 + y6 - RG3 * y13) / LS3,
            (-y1 + u1 - (RI + RG1) * y14) / LS1,
            (-y2 - (RC + RG1) * y15) / LS1,
        ]
    )
