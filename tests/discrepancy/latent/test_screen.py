"""The true effect comes first, or among those that are hardly behind it, in noisy recordings."""

import pytest

from bondgraph.discrepancy.candidates import effects
from bondgraph.discrepancy.grafting import graft
from bondgraph.discrepancy.latent import probed, relaxed, sketched, threshold
from bondgraph.simulation import CompiledModel

from ..machines import MACHINES
from .made import recording

COUNT, NOISE = 400, 0.003
CASES = [
    ("mass_spring", "coulomb_friction", "carriage", {"level": 1.5}),
    ("mass_spring", "cubic_stiffness", "carriage", {"cubic": 3e5}),
    ("two_mass_chain", "quadratic_drag", "second", {"drag": 20.0}),
    ("two_mass_chain", "coulomb_friction", "between first and second", {"level": 1.0}),
    ("thermal_brake", "quadratic_drag", "wheel", {"drag": 0.3}),
    ("quarter_car", "cubic_stiffness", "suspension", {"cubic": 1e7}),
    ("two_tanks", "orifice_flow", "second", {"orifice": 4e-6}),
    ("hydraulic_cylinder", "coulomb_friction", "rod", {"level": 500.0}),
    ("rlc", "sensor_bias", "output u", {"offset": 0.5}),
    ("dc_motor", "saturation", "source supply", {"limit": 9.0}),
]


def _sketch(machine, graph):
    nominal = MACHINES[machine]()
    known = effects()
    probes = probed(nominal, known)
    model = CompiledModel(probes.graph)
    signals = list(nominal.outputs)
    own = [symbol.name for symbol in nominal.parameters]
    found = relaxed(
        model,
        [recording(machine, graph, NOISE, COUNT)],
        signals,
        own,
        [probe.parameter for probe in probes.probes],
        [probe.errs for probe in probes.probes],
        runs=CompiledModel(nominal),
    )
    return sketched(found, probes, known)


@pytest.mark.parametrize(
    ("machine", "name", "site", "values"), CASES, ids=[f"{c[0]}-{c[1]}" for c in CASES]
)
def test_the_true_effect_is_among_the_first(machine, name, site, values):
    sketch = _sketch(machine, graft(MACHINES[machine](), name, site, parameters=values).graph)
    first = [item.candidates[0] for item in sketch.singles[:3]]
    places = {item.site.name for item in first} | {
        f"between {' and '.join(item.pair)}" for item in first if item.pair
    }
    assert name in {item.effect.name for item in first} and site in places
    assert sketch.singles[0].gain > threshold(sketch)


def test_nothing_missing_gains_no_more_than_noise_does():
    gains = []
    for machine in ("mass_spring", "rlc", "two_tanks"):
        sketch = _sketch(machine, MACHINES[machine]())
        gains.append(sketch.singles[0].gain - threshold(sketch))
    assert max(gains) < 0
