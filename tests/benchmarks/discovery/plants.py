"""Numbers of the machines for the truth: parameters, inputs, bands, sampling; all SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace


@dataclass(frozen=True)
class Plant:
    """A machine as it is driven and measured.

    Attributes
    ----------
    truth : the simulator's name of it
    table : parameters that the nominal model has in its table
    numbers : those that stand in the law, or are absent there
    drive, unit : the input
    outputs : units by name
    amplitude, offset : of the input
    band : lowest and highest frequency, Hz
    step : sampling interval, s
    """

    truth: str
    table: Mapping[str, float]
    drive: str
    unit: str
    outputs: Mapping[str, str]
    amplitude: float
    band: tuple[float, float]
    step: float
    offset: float = 0.0
    numbers: Mapping[str, float] = field(default_factory=dict)

    def fixed(self, **numbers: float) -> Plant:
        """Return the plant with parameters that the table does not have."""
        table = {name: value for name, value in self.table.items() if name not in numbers}
        return replace(self, table=table, numbers={**self.numbers, **numbers})


_CHAIN = Plant(
    "two_mass_chain",
    {"m1": 1.0, "m2": 0.5, "k1": 400.0, "k2": 300.0, "b1": 2.0, "b2": 1.0},
    "push",
    "N",
    {"v1": "m/s", "v2": "m/s"},
    amplitude=8.0,
    band=(0.3, 8.0),
    step=8e-3,
)
_MOTOR = Plant(
    "dc_motor",
    {
        "Ra": 1.2,
        "La": 5e-3,
        "kt": 0.08,
        "Jm": 4e-4,
        "Jl": 1.5e-3,
        "ks": 6.0,
        "bs": 2e-3,
        "bl": 8e-4,
    },
    "voltage",
    "V",
    {"current": "A", "speed": "rad/s"},
    amplitude=12.0,
    band=(0.3, 30.0),
    step=2e-3,
)
_CAR = Plant(
    "quarter_car",
    {"ms": 300.0, "mu": 40.0, "ks": 18e3, "cs": 1200.0, "kt": 180e3, "ct": 100.0},
    "road",
    "m/s",
    {"travel": "m", "body_speed": "m/s"},
    amplitude=0.3,
    band=(0.3, 15.0),
    step=6e-3,
)
_CYLINDER = Plant(
    "hydraulic_cylinder",
    {"A": 2e-3, "Coil": 2e-12, "M": 50.0, "Rv": 2e9, "B": 400.0, "K": 2e5},
    "supply",
    "Pa",
    {"pressure": "Pa", "speed": "m/s"},
    amplitude=2e6,
    band=(0.5, 25.0),
    step=1.5e-3,
)
_RLC = Plant(
    "rlc",
    {"Re": 2.0, "Le": 0.01, "Ce": 1e-4},
    "voltage",
    "V",
    {"current": "A", "u": "V"},
    amplitude=10.0,
    band=(10.0, 400.0),
    step=1e-4,
    numbers={"Rload": 50.0},
)
_MASS = Plant(
    "mass_spring",
    {"m": 2.0, "k": 800.0, "b": 4.0},
    "push",
    "N",
    {"x": "m", "v": "m/s"},
    amplitude=8.0,
    band=(0.3, 8.0),
    step=8e-3,
)
PLANTS: dict[str, Plant] = {
    "mass_spring": _MASS,
    "weighed_mass": _MASS.fixed(m=2.0),
    "two_mass_chain": _CHAIN,
    "weighed_chain": _CHAIN.fixed(m2=0.5),
    "undamped_chain": _CHAIN.fixed(b1=0.0),
    "unheld_chain": _CHAIN.fixed(k1=0.0),
    "dc_motor": _MOTOR,
    "free_motor": _MOTOR.fixed(bl=0.0),
    "quarter_car": _CAR.fixed(ms=300.0),
    "two_tanks": Plant(
        "two_tanks",
        {"C1": 2e-5, "C2": 1e-5, "R12": 4e6, "R2": 6e6},
        "inflow",
        "m^3/s",
        {"p1": "Pa", "p2": "Pa"},
        amplitude=2e-4,
        band=(1e-3, 0.02),
        step=1.5,
        offset=2.5e-4,
    ),
    "hydraulic_cylinder": _CYLINDER.fixed(A=2e-3),
    "thermal_brake": Plant(
        "thermal_brake",
        {"J": 0.5, "br": 0.8, "Cd": 150.0, "Rc": 0.6},
        "torque",
        "N*m",
        {"speed": "rad/s", "temperature": "K"},
        amplitude=10.0,
        band=(5e-3, 0.5),
        step=0.2,
    ),
    "rlc": _RLC,
    "rc": _RLC.fixed(Le=0.0),
}
