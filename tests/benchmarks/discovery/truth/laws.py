"""Laws of hidden effects at a junction: effort by displacement and flow, or flow by effort.

Each is ``law(c, q, f, z, t) -> (taken, dz/dt)``: c the coefficients, q the integral of f, z what it
remembers. At a 0-junction f is the effort and what is taken a flow. Positive is what opposes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import copysign, cos, exp, sin, sqrt

Values = Mapping[str, float]
Law = Callable[[Values, float, float, float, float], tuple[float, float]]


def viscous(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    return c["damping"] * f, 0.0


def drag(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    return c["drag"] * f * abs(f), 0.0


def linear(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    return c["stiffness"] * q, 0.0


def cubic(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    return c["cubic"] * q**3, 0.0


def dead_zone(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    beyond = abs(q) - c["width"]
    return (copysign(c["stiffness"] * beyond, q) if beyond > 0 else 0.0), 0.0


def run_out(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    return c["sine"] * sin(c["order"] * q) + c["cosine"] * cos(c["order"] * q), 0.0


def effort_bias(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    return -c["effort"], 0.0


def flow_bias(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    return -c["flow"], 0.0


def bouc_wen(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    """Let z be the restoring force over its largest: it yields on loading only."""
    loading = z * z if f * z > 0 else 0.0
    return c["level"] * z, f / c["width"] * (1 - loading)


def lugre(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    most = c["level"] + c["excess"] * exp(-((f / c["speed"]) ** 2))
    bending = f - c["stiffness"] * abs(f) / most * z
    return c["stiffness"] * z + c["damping"] * bending + c["viscous"] * f, bending


def stiff_bristles(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    """Dry friction of one level, as bristles that hardly bend."""
    bending = f * (1 - copysign(z, f * z) / c["bend"]) if z else f
    return c["level"] * z / c["bend"], bending


def leakage(c: Values, q: float, e: float, z: float, t: float) -> tuple[float, float]:
    return c["conductance"] * e, 0.0


def overflow(c: Values, q: float, e: float, z: float, t: float) -> tuple[float, float]:
    return c["conductance"] * max(e - c["threshold"], 0.0), 0.0


def orifice(c: Values, q: float, e: float, z: float, t: float) -> tuple[float, float]:
    return copysign(c["orifice"] * sqrt(abs(e)), e), 0.0


def side_vessel(c: Values, q: float, e: float, z: float, t: float) -> tuple[float, float]:
    """A compliance behind a resistance, on a 0-junction; z is what it holds."""
    flow = (e - c["stiffness"] * z) / c["damping"]
    return flow, flow


def one_way(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    """Resist one direction only: half of it is even in the flow."""
    return c["size"] * max(f, 0.0), 0.0


def clocked(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    """A sawtooth in time, whatever the machine does."""
    return c["size"] * (2 * ((t / c["period"]) % 1.0) - 1), 0.0


def van_der_pol(c: Values, q: float, f: float, z: float, t: float) -> tuple[float, float]:
    """Feed in within a displacement, take out beyond."""
    return c["size"] * ((q / c["width"]) ** 2 - 1) * f, 0.0


SMOOTH: Mapping[str, Law] = {
    "viscous_damping": viscous,
    "quadratic_drag": drag,
    "linear_stiffness": linear,
    "cubic_stiffness": cubic,
    "dead_zone": dead_zone,
    "run_out": run_out,
    "effort_bias": effort_bias,
    "flow_bias": flow_bias,
    "hysteresis": bouc_wen,
    "lugre_friction": lugre,
    "stiff_bristles": stiff_bristles,
    "leakage": leakage,
    "overflow": overflow,
    "orifice_flow": orifice,
    "compliant_coupling": side_vessel,
    "one_way": one_way,
    "clocked": clocked,
    "van_der_pol": van_der_pol,
}
OUTSIDE = ("one_way", "clocked", "van_der_pol")
