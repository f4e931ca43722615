"""The transistor amplifier: eight nodes, five capacitors, a DAE of index 1.

After P. Rentrop, M. Roche, G. Steinebach, The application of Rosenbrock-Wanner type methods with
stepsize control in differential-algebraic equations, Numer. Math. 55 (1989) 545-563.
"""

import numpy as np
import sympy

from bondgraph import TIME, C, One, R, Se, Sf, Zero, assemble
from bondgraph.graph import BondGraph

UB, UF, ALPHA, BETA = 6.0, 0.026, 0.99, 1e-6
R0, RK = 1000.0, 9000.0
T_END = 0.2

REFERENCE = np.array(
    [
        *(-0.5562145012262709e-2, 0.3006522471903042e1, 0.2849958788608128e1),
        *(0.2926422536206241e1, 0.2704617865010554e1, 0.2761837778393145e1),
        *(0.4770927631616772e1, 0.1236995868091548e1),
    ]
)
# Voltages at the start, as the test set gives them.
START = np.array([0, UB / 2, UB / 2, UB, UB / 2, UB / 2, UB, 0])


def graph() -> BondGraph:
    """Draw the circuit; outputs ``y1`` to ``y8`` are the voltages of the nodes."""
    node = {k: Zero(f"n{k}") for k in range(1, 9)}
    u_e = 0.1 * sympy.sin(200 * sympy.pi * TIME)
    parts = []

    def resistor(name: str, k: int, supply: object = None, value: float = RK) -> None:
        """From a node to ground, or to the supply."""
        if supply is None:
            parts.append(node[k] >> R(name, value))
        else:
            way = One(f"w_{name}")
            parts.append([Se(f"u_{name}", supply) >> way >> node[k], way >> R(name, value)])

    def capacitor(name: str, value: float, start: float, k: int, j: int | None = None) -> None:
        """From one node to another, or to ground."""
        element = C(name, value, initial=start * value)
        if j is None:
            parts.append(node[k] >> element)
        else:
            way = One(f"w_{name}")
            parts.append([node[k] >> way >> node[j], way >> element])

    def transistor(name: str, base: int, emitter: int, collector: int) -> None:
        """The base-emitter diode, and the part of its current that the collector gives."""
        junction, gain = One(f"{name}_be"), One(f"{name}_cb")
        diode = R(f"{name}_diode", flow=lambda e: BETA * (sympy.exp(e / UF) - 1))
        parts.append([node[base] >> junction >> node[emitter], junction >> diode])
        parts.append(
            [node[collector] >> gain >> node[base], gain >> Sf(f"{name}_gain", ALPHA * diode.f)]
        )

    resistor("R0", 1, u_e, R0)
    capacitor("C1", 1e-6, START[0] - START[1], 1, 2)
    resistor("R1", 2)
    resistor("R2", 2, UB)
    transistor("T1", 2, 3, 4)
    resistor("R3", 3)
    capacitor("C2", 2e-6, START[2], 3)
    resistor("R4", 4, UB)
    capacitor("C3", 3e-6, START[3] - START[4], 4, 5)
    resistor("R5", 5)
    resistor("R6", 5, UB)
    transistor("T2", 5, 6, 7)
    resistor("R7", 6)
    capacitor("C4", 4e-6, START[5], 6)
    resistor("R8", 7, UB)
    capacitor("C5", 5e-6, START[6] - START[7], 7, 8)
    resistor("R9", 8)
    return assemble(
        "transistor_amplifier", parts, outputs={f"y{k}": node[k].e for k in range(1, 9)}
    )
