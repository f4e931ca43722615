"""What a regression of rates is given: states that are measured or derivable, terms, right answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy
from scipy.signal import savgol_filter

Array = numpy.ndarray
Columns = dict[str, Array]
Term = tuple[str, str]


@dataclass(frozen=True)
class Setup:
    """A machine as equations of rates.

    Attributes
    ----------
    derive : from times and measured columns to states
    equations : state whose rate is sought, to the terms that the nominal model has in it
    flows, ways, roots : states of which |f|f and sign(f), cubes, signed roots are offered
    more : other states offered as they are
    right : (effect, site) to the terms, each an equation and a feature, that are right
    """

    derive: Callable[[Array, Columns], Columns]
    equations: Mapping[str, tuple[str, ...]]
    right: Mapping[tuple[str, str], tuple[Term, ...]]
    flows: tuple[str, ...] = ()
    ways: tuple[str, ...] = ()
    roots: tuple[str, ...] = ()
    more: tuple[str, ...] = ()

    def features(self, states: Columns, equation: str) -> Columns:
        """Return all terms that an equation may have, but the constant one.

        Linear ones are the nominal model's and `more`: which states meet in an equation is known.
        """
        found = {name: states[name] for name in (*self.equations[equation], *self.more)}
        for name in self.flows:
            found[f"{name}|{name}|"] = states[name] * abs(states[name])
            found[f"sign({name})"] = numpy.sign(states[name])
        for name in self.ways:
            found[f"{name}^3"] = states[name] ** 3
        for name in self.roots:
            found[f"root({name})"] = numpy.sign(states[name]) * numpy.sqrt(abs(states[name]))
        return found


def way(t: Array, flow: Array) -> Array:
    """Return the integral of a flow, from zero."""
    steps = numpy.diff(t) * (flow[1:] + flow[:-1]) / 2
    return numpy.concatenate([[0.0], numpy.cumsum(steps)])


def _friction(site: str, *equations: str, flow: str = "v") -> dict[tuple[str, str], tuple]:
    dry = tuple((equation, f"sign({flow})") for equation in equations)
    drag = tuple((equation, f"{flow}|{flow}|") for equation in equations)
    return {
        ("coulomb_friction", site): dry,
        ("stribeck_friction", site): dry,
        ("quadratic_drag", site): drag,
    }


def _chain(t: Array, c: Columns) -> Columns:
    x, d = way(t, c["v1"]), way(t, c["v1"] - c["v2"])
    return {**c, "x": x, "d": d, "r": c["v1"] - c["v2"]}


def _car(t: Array, c: Columns) -> Columns:
    r = savgol_filter(c["travel"], 9, 3, deriv=1, delta=t[1] - t[0])
    wheel = c["body_speed"] + r
    dent = way(t, c["road"] - wheel)
    return {"z": c["travel"], "r": r, "vb": c["body_speed"], "vw": wheel, "y": dent, **c}


_BETWEEN = {
    ("quadratic_drag", "between first and second"): (("v1", "r|r|"), ("v2", "r|r|")),
    ("cubic_stiffness", "way"): (("v1", "d^3"), ("v2", "d^3")),
}
_CHAIN = Setup(
    _chain,
    {"v1": ("push", "x", "d", "v1", "v2"), "v2": ("d", "v1", "v2")},
    _friction("first", "v1", flow="v1") | _friction("second", "v2", flow="v2") | _BETWEEN,
    flows=("v1", "v2", "r"),
    ways=("x", "d"),
)
_MOTOR = Setup(
    lambda t, c: c,
    {"current": ("voltage", "current", "speed"), "speed": ("current", "speed")},
    _friction("wheel", "speed", flow="speed")
    | {
        ("effort_bias", "wheel"): (("speed", "1"),),
        ("sensor_bias", "output current"): (("current", "1"), ("speed", "1")),
    },
    flows=("speed", "current"),
)
SETUPS: Mapping[str, Setup] = {
    "mass_spring": Setup(
        lambda t, c: c,
        {"v": ("push", "x", "v")},
        _friction("carriage", "v")
        | {
            ("cubic_stiffness", "carriage"): (("v", "x^3"),),
            ("effort_bias", "carriage"): (("v", "1"),),
        },
        flows=("v",),
        ways=("x",),
    ),
    "two_mass_chain": _CHAIN,
    "unheld_chain": Setup(
        _chain,
        {"v1": ("push", "d", "v1", "v2"), "v2": ("d", "v1", "v2")},
        {("linear_stiffness", "first"): (("v1", "x"),)},
        flows=("v1", "v2", "r"),
        ways=("d",),
        more=("x",),
    ),
    "dc_motor": _MOTOR,
    "quarter_car": Setup(
        _car,
        {"vb": ("z", "r"), "vw": ("z", "r", "y", "road", "vw")},
        _friction("suspension", "vb", "vw", flow="r")
        | {("cubic_stiffness", "suspension"): (("vb", "z^3"), ("vw", "z^3"))},
        flows=("r", "vw"),
        ways=("z", "y"),
    ),
    "two_tanks": Setup(
        lambda t, c: {**c, "d": c["p1"] - c["p2"]},
        {"p1": ("inflow", "p1", "p2"), "p2": ("p1", "p2")},
        {
            ("orifice_flow", "between first and second"): (("p1", "root(d)"), ("p2", "root(d)")),
            ("orifice_flow", "first"): (("p1", "root(p1)"),),
            ("flow_bias", "first"): (("p1", "1"),),
            ("flow_bias", "second"): (("p2", "1"),),
        },
        roots=("p1", "p2", "d"),
    ),
    "hydraulic_cylinder": Setup(
        lambda t, c: {"p": c["pressure"], "v": c["speed"], "x": way(t, c["speed"]), **c},
        {"p": ("supply", "p", "v"), "v": ("p", "v", "x")},
        _friction("rod", "v")
        | {
            ("cubic_stiffness", "rod"): (("v", "x^3"),),
            ("orifice_flow", "chamber"): (("p", "root(p)"),),
        },
        flows=("v",),
        ways=("x",),
        roots=("p",),
    ),
    "thermal_brake": Setup(
        lambda t, c: {
            "w": c["speed"],
            "T": c["temperature"],
            "w^2": c["speed"] ** 2,
            "a": way(t, c["speed"]),
            **c,
        },
        {"w": ("torque", "w"), "T": ("T", "w^2")},
        _friction("wheel", "w", flow="w")
        | {
            ("linear_stiffness", "wheel"): (("w", "a"),),
            ("flow_bias", "disc"): (("T", "1"),),
        },
        flows=("w",),
        more=("a",),
    ),
    "rlc": Setup(
        lambda t, c: {"i": c["current"], **c, "q": way(t, c["current"])},
        {"i": ("voltage", "i", "u"), "u": ("i", "u")},
        {
            ("linear_stiffness", "loop"): (("i", "q"),),
            ("flow_bias", "node"): (("u", "1"),),
            ("effort_bias", "loop"): (("i", "1"),),
        },
        flows=("i",),
        ways=("q",),
        more=("q",),
    ),
}


def expected(truth: Mapping) -> tuple[Term, ...]:
    """Return the terms that are right for a sealed case; none where the method does not apply."""
    if truth["kind"] != "effect" or not truth["identifiable"] or truth["unmeasured"]:
        return ()
    setup = SETUPS.get(truth["machine"])
    hidden = truth["hidden"][0]
    return setup.right.get((hidden["effect"], hidden["site"]), ()) if setup else ()
