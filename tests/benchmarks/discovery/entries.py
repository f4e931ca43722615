"""What is hidden where, with numbers that fit the machine.

Strength is set later: `scaled` coefficients are multiplied by one factor until the effect changes the
outputs by a drawn share. No entry is the same as a change of the nominal model's own parameters.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

Named = tuple[str, str]


@dataclass(frozen=True)
class Entry:
    """An effect at a site of a machine.

    Attributes
    ----------
    machine : of `machines.MACHINES`
    effect, site : as the library names them
    values : coefficients, SI, before they are scaled
    scaled : coefficients that carry the strength
    also : (effect, site) that no signal can tell from it
    unscored : coefficients that the data do not tell, or that the truth has none of
    form : the law of the truth where it is another than the effect's
    """

    machine: str
    effect: str
    site: str
    values: Mapping[str, float]
    scaled: tuple[str, ...] = ()
    also: tuple[Named, ...] = ()
    unscored: tuple[str, ...] = ()
    form: str = ""

    @property
    def right(self) -> tuple[Named, ...]:
        """All answers that are right."""
        twin = TWINS.get((self.machine, self.site))
        places = (self.site, twin) if twin and self.effect not in ONE_JUNCTION else (self.site,)
        names = [self.effect]
        if self.form == "stiff_bristles":  # LuGre's without an excess; and they bend as they yield
            names += ["lugre_friction", "hysteresis"]
        return (*((name, place) for name in names for place in places), *self.also)


# a pair, and the 1-junction whose flow is the pair's difference
TWINS = {
    (machine, a): b
    for machine, pair, junction in (
        ("two_mass_chain", "between first and second", "way"),
        ("undamped_chain", "between first and second", "way"),
        ("unheld_chain", "between first and second", "way"),
        ("dc_motor", "between motor and wheel", "twist"),
        ("free_motor", "between motor and wheel", "twist"),
        ("quarter_car", "between wheel and body", "suspension"),
    )
    for a, b in ((pair, junction), (junction, pair))
}
ONE_JUNCTION = ("added_inertia", "run_out", "end_stop")

_BODY = (
    Entry("mass_spring", "coulomb_friction", "carriage", {"level": 1.5}, ("level",)),
    Entry(
        "mass_spring",
        "coulomb_friction",
        "carriage",
        {"level": 1.2, "bend": 2e-4, "pace": 500.0},
        ("level",),
        form="stiff_bristles",
    ),
    Entry(
        "mass_spring",
        "stribeck_friction",
        "carriage",
        {"level": 0.8, "excess": 1.2, "speed": 0.06},
        ("level", "excess"),
    ),
    Entry(
        "mass_spring",
        "lugre_friction",
        "carriage",
        {
            "level": 1.0,
            "excess": 0.8,
            "speed": 0.03,
            "stiffness": 700.0,
            "damping": 3.0,
            "viscous": 0.0,
            "pace": 600.0,
        },
        ("level", "excess", "stiffness", "damping"),
        unscored=("viscous",),
    ),
    Entry("mass_spring", "quadratic_drag", "carriage", {"drag": 5.0}, ("drag",)),
    Entry("mass_spring", "cubic_stiffness", "carriage", {"cubic": 4e5}, ("cubic",)),
    Entry(
        "mass_spring",
        "dead_zone",
        "carriage",
        {"stiffness": 1500.0, "width": 0.01},
        ("stiffness",),
    ),
    Entry(
        "mass_spring",
        "end_stop",
        "carriage",
        {"upper": 0.016, "lower": 0.017, "restitution": 0.5, "rest": 5e-3},
        ("upper", "lower"),
        unscored=("rest",),
    ),
    Entry("mass_spring", "hysteresis", "carriage", {"level": 2.0, "width": 4e-3}, ("level",)),
    Entry(
        "mass_spring",
        "compliant_coupling",
        "bond carriage>damper",
        {"stiffness": 60.0, "damping": 0.4},
        ("stiffness", "damping"),
    ),
    Entry(
        "mass_spring",
        "thermal_fade",
        "dissipator damper",
        {"fade": 0.6, "cooling": 0.1},
        ("fade",),
    ),
    Entry("mass_spring", "saturation", "source actuator", {"limit": 4.0}, ("limit",)),
    Entry("mass_spring", "transport_delay", "source actuator", {"delay": 0.015}, ("delay",)),
    Entry("mass_spring", "sensor_bias", "output v", {"offset": 0.1}, ("offset",)),
    Entry(
        "mass_spring",
        "effort_bias",
        "carriage",
        {"effort": 3.0},
        ("effort",),
        also=(("sensor_bias", "output x"),),
    ),
)
_CHAIN = (
    Entry("two_mass_chain", "coulomb_friction", "second", {"level": 0.8}, ("level",)),
    Entry("two_mass_chain", "coulomb_friction", "first", {"level": 1.5}, ("level",)),
    Entry("two_mass_chain", "viscous_damping", "second", {"damping": 1.0}, ("damping",)),
    Entry("undamped_chain", "viscous_damping", "first", {"damping": 2.0}, ("damping",)),
    Entry("two_mass_chain", "quadratic_drag", "second", {"drag": 3.0}, ("drag",)),
    Entry("two_mass_chain", "quadratic_drag", "between first and second", {"drag": 6.0}, ("drag",)),
    Entry("two_mass_chain", "cubic_stiffness", "way", {"cubic": 5e5}, ("cubic",)),
    Entry(
        "two_mass_chain",
        "dead_zone",
        "between first and second",
        {"stiffness": 600.0, "width": 6e-3},
        ("stiffness",),
    ),
    Entry(
        "two_mass_chain",
        "hysteresis",
        "between first and second",
        {"level": 1.0, "width": 3e-3},
        ("level",),
    ),
    Entry(
        "two_mass_chain",
        "compliant_coupling",
        "bond second>mass2",
        {"stiffness": 500.0, "damping": 1.5},
        ("stiffness", "damping"),
    ),
    Entry("unheld_chain", "linear_stiffness", "first", {"stiffness": 2.0}, ("stiffness",)),
    Entry("two_mass_chain", "transport_delay", "output v2", {"delay": 0.012}, ("delay",)),
    Entry("two_mass_chain", "saturation", "output v1", {"limit": 0.18}, ("limit",)),
)
_MOTOR = (
    Entry("dc_motor", "coulomb_friction", "wheel", {"level": 0.05}, ("level",)),
    Entry(
        "dc_motor",
        "stribeck_friction",
        "wheel",
        {"level": 0.03, "excess": 0.05, "speed": 6.0},
        ("level", "excess"),
    ),
    Entry("dc_motor", "quadratic_drag", "wheel", {"drag": 3e-5}, ("drag",)),
    Entry("free_motor", "viscous_damping", "wheel", {"damping": 1e-3}, ("damping",)),
    Entry(
        "dc_motor",
        "run_out",
        "wheel",
        {"sine": 0.06, "cosine": 0.04, "order": 2.0},
        ("sine", "cosine"),
        also=(("run_out", "motor"),),
    ),
    Entry("dc_motor", "cubic_stiffness", "twist", {"cubic": 3e4}, ("cubic",)),
    Entry("dc_motor", "saturation", "source supply", {"limit": 6.0}, ("limit",)),
    Entry("dc_motor", "transport_delay", "source supply", {"delay": 4e-3}, ("delay",)),
    Entry("dc_motor", "nonlinear_inertance", "inertia coil", {"cubic": 2e5}, ("cubic",)),
    Entry("dc_motor", "sensor_bias", "output current", {"offset": 0.5}, ("offset",)),
    Entry(
        "dc_motor",
        "effort_bias",
        "wheel",
        {"effort": 0.05},
        ("effort",),
        also=(("effort_bias", "motor"),),
    ),
)
_CAR = (
    Entry(
        "quarter_car",
        "coulomb_friction",
        "suspension",
        {"level": 90.0, "bend": 3e-4, "pace": 150.0},
        ("level",),
        form="stiff_bristles",
    ),
    Entry("quarter_car", "quadratic_drag", "suspension", {"drag": 2500.0}, ("drag",)),
    Entry("quarter_car", "cubic_stiffness", "suspension", {"cubic": 1e7}, ("cubic",)),
    Entry(
        "quarter_car",
        "dead_zone",
        "suspension",
        {"stiffness": 3e4, "width": 0.01},
        ("stiffness",),
    ),
    Entry(
        "quarter_car",
        "hysteresis",
        "between wheel and body",
        {"level": 120.0, "width": 4e-3},
        ("level",),
    ),
    Entry(
        "quarter_car",
        "compliant_coupling",
        "bond suspension>damper",
        {"stiffness": 2e4, "damping": 100.0},
        ("stiffness", "damping"),
    ),
    Entry(
        "quarter_car",
        "thermal_fade",
        "dissipator damper",
        {"fade": 8e-3, "cooling": 0.1},
        ("fade",),
    ),
    Entry("quarter_car", "added_inertia", "suspension", {"inertance": 30.0}, ("inertance",)),
    Entry("quarter_car", "saturation", "output travel", {"limit": 0.011}, ("limit",)),
)
_TANKS = (
    Entry("two_tanks", "leakage", "first", {"conductance": 6e-8}, ("conductance",)),
    Entry(
        "two_tanks",
        "orifice_flow",
        "between first and second",
        {"orifice": 4e-6},
        ("orifice",),
        unscored=("laminar",),
    ),
    Entry(
        "two_tanks",
        "orifice_flow",
        "first",
        {"orifice": 2e-6},
        ("orifice",),
        unscored=("laminar",),
    ),
    Entry(
        "two_tanks",
        "overflow",
        "second",
        {"conductance": 3e-7, "threshold": 1500.0},
        ("conductance",),
    ),
    Entry(
        "two_tanks",
        "overflow",
        "first",
        {"conductance": 3e-7, "threshold": 2600.0},
        ("conductance",),
    ),
    Entry("two_tanks", "flow_bias", "first", {"flow": 5e-5}, ("flow",)),
    Entry("two_tanks", "flow_bias", "second", {"flow": 6e-5}, ("flow",)),
    Entry("two_tanks", "quadratic_drag", "pipe", {"drag": 2e10}, ("drag",)),
    Entry("two_tanks", "saturation", "source pump", {"limit": 3.2e-4}, ("limit",)),
    Entry("two_tanks", "transport_delay", "source pump", {"delay": 12.0}, ("delay",)),
    Entry(
        "two_tanks",
        "sensor_bias",
        "output p1",
        {"offset": 300.0},
        ("offset",),
        also=(("effort_bias", "pipe"),),
    ),
    Entry(
        "two_tanks",
        "compliant_coupling",
        "first",
        {"stiffness": 1e5, "damping": 6e6},
        ("stiffness", "damping"),
    ),
)
_CYLINDER = (
    Entry("hydraulic_cylinder", "coulomb_friction", "rod", {"level": 400.0}, ("level",)),
    Entry(
        "hydraulic_cylinder",
        "stribeck_friction",
        "rod",
        {"level": 200.0, "excess": 400.0, "speed": 0.05},
        ("level", "excess"),
    ),
    Entry(
        "hydraulic_cylinder",
        "lugre_friction",
        "rod",
        {
            "level": 300.0,
            "excess": 250.0,
            "speed": 0.03,
            "stiffness": 3e5,
            "damping": 500.0,
            "viscous": 0.0,
            "pace": 500.0,
        },
        ("level", "excess", "stiffness", "damping"),
        unscored=("viscous",),
    ),
    Entry("hydraulic_cylinder", "quadratic_drag", "rod", {"drag": 3000.0}, ("drag",)),
    Entry("hydraulic_cylinder", "quadratic_drag", "line", {"drag": 3e12}, ("drag",)),
    Entry("hydraulic_cylinder", "leakage", "chamber", {"conductance": 1.5e-10}, ("conductance",)),
    Entry(
        "hydraulic_cylinder",
        "orifice_flow",
        "chamber",
        {"orifice": 2e-7},
        ("orifice",),
        unscored=("laminar",),
    ),
    Entry("hydraulic_cylinder", "added_inertia", "line", {"inertance": 1e7}, ("inertance",)),
    Entry(
        "hydraulic_cylinder",
        "end_stop",
        "rod",
        {"upper": 8e-3, "lower": 9e-3, "restitution": 0.4, "rest": 5e-3},
        ("upper", "lower"),
        unscored=("rest",),
    ),
    Entry("hydraulic_cylinder", "transport_delay", "source pump", {"delay": 4e-3}, ("delay",)),
    Entry("hydraulic_cylinder", "cubic_stiffness", "rod", {"cubic": 1e9}, ("cubic",)),
)
_BRAKE = (
    Entry("thermal_brake", "coulomb_friction", "wheel", {"level": 1.5}, ("level",)),
    Entry("thermal_brake", "quadratic_drag", "wheel", {"drag": 0.08}, ("drag",)),
    Entry(
        "thermal_brake",
        "run_out",
        "wheel",
        {"sine": 2.0, "cosine": 1.0, "order": 1.0},
        ("sine", "cosine"),
    ),
    Entry("thermal_brake", "linear_stiffness", "wheel", {"stiffness": 0.05}, ("stiffness",)),
    Entry(
        "thermal_brake",
        "thermal_fade",
        "dissipator pad",
        {"fade": 6e-4, "cooling": 0.02},
        ("fade",),
    ),
    Entry(
        "thermal_brake",
        "flow_bias",
        "disc",
        {"flow": 6.0},
        ("flow",),
        also=(("sensor_bias", "output temperature"),),
    ),
    Entry("thermal_brake", "saturation", "source drive", {"limit": 5.0}, ("limit",)),
)
_CIRCUIT = (
    Entry("rlc", "nonlinear_inertance", "inertia coil", {"cubic": 3e5}, ("cubic",)),
    Entry(
        "rlc",
        "overflow",
        "node",
        {"conductance": 0.1, "threshold": 4.0},
        ("conductance",),
    ),
    Entry("rlc", "flow_bias", "node", {"flow": 0.3}, ("flow",)),
    Entry("rlc", "effort_bias", "loop", {"effort": 2.0}, ("effort",)),
    Entry("rlc", "saturation", "source generator", {"limit": 5.0}, ("limit",)),
    Entry("rlc", "transport_delay", "source generator", {"delay": 2e-4}, ("delay",)),
    Entry("rlc", "sensor_bias", "output current", {"offset": 0.3}, ("offset",)),
    Entry("rlc", "linear_stiffness", "loop", {"stiffness": 4e3}, ("stiffness",)),
    Entry("rc", "added_inertia", "loop", {"inertance": 6e-4}, ("inertance",)),
)
ENTRIES: tuple[Entry, ...] = (
    *_BODY,
    *_CHAIN,
    *_MOTOR,
    *_CAR,
    *_TANKS,
    *_CYLINDER,
    *_BRAKE,
    *_CIRCUIT,
)
