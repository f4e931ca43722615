"""The truth's simulators against closed forms, energy, and bondgraph's own runs."""

import sys
from math import exp, pi, sqrt

import numpy as np
import pytest

from bondgraph import Samples, simulate
from bondgraph.discrepancy.grafting import graft
from bondgraph.units import to_si

from .entries import ENTRIES
from .excite import KINDS, excitation
from .machines import MACHINES
from .make import HELPERS
from .plants import PLANTS
from .truth import Drive, Hidden
from .truth import simulate as true

SHORT = 300


def driven(machine, kind="multisine", size=SHORT, hold="linear"):
    plant = PLANTS[machine]
    u = excitation(plant, kind, size, np.random.default_rng(3))
    return Drive(np.arange(size) * plant.step, u, hold)


def numbers(machine):
    plant = PLANTS[machine]
    return {**plant.table, **plant.numbers}


def model_run(graph, machine, drive):
    samples = Samples(drive.t, drive.values, drive.hold)
    inputs = {PLANTS[machine].drive: samples}
    return simulate(graph, drive.t[-1], inputs=inputs, t_eval=drive.t, rtol=1e-9)


def test_the_truth_imports_nothing_of_bondgraph():
    """In a process of its own, since this one has it."""
    import subprocess
    from pathlib import Path

    code = (
        "import sys; from tests.benchmarks.discovery import truth; "
        "sys.exit('bondgraph' in sys.modules)"
    )
    root = Path(__file__).parents[3]
    assert subprocess.run([sys.executable, "-c", code], cwd=root, check=False).returncode == 0


@pytest.mark.parametrize("machine", MACHINES)
def test_plants_have_the_table_of_the_models(machine):
    graph, plant = MACHINES[machine](), PLANTS[machine]
    table = {s.name: to_si(float(row.value), row.unit) for s, row in graph.parameters.items()}
    assert table == pytest.approx(dict(plant.table))
    assert [symbol.name for symbol in graph.inputs] == [plant.drive]
    assert {n: o.unit for n, o in graph.outputs.items()} == dict(plant.outputs)


@pytest.mark.parametrize("hold", ["linear", "zero"])
@pytest.mark.parametrize("machine", MACHINES)
def test_with_nothing_hidden_both_move_alike(machine, hold):
    drive = driven(machine, "multisine", hold=hold)
    ours = true(PLANTS[machine].truth, numbers(machine), [], drive)
    theirs = model_run(MACHINES[machine](), machine, drive)
    for name, column in ours.items():
        assert np.abs(column - theirs[name]).max() <= 1e-5 * np.ptp(theirs[name])


def coefficients(entry):
    values = {k: v for k, v in entry.values.items() if k not in HELPERS}
    return values | ({"laminar": 1e-3} if entry.effect == "orifice_flow" else {})


# another form of the law: bristles for a friction that sticks, a pure delay for all-pass sections
LOOSE = {"stiff_bristles": 0.25, "transport_delay": 0.25}


@pytest.mark.parametrize(
    "entry", ENTRIES, ids=lambda e: f"{e.machine} {e.effect} {e.site} {e.form}".strip()
)
def test_an_effect_is_what_the_library_grows(entry):
    """Name, site, sign and coefficients mean the same in both; the gap is told of the effect's own."""
    plant, drive = PLANTS[entry.machine], driven(entry.machine)
    hidden = Hidden(entry.effect, entry.site, entry.values, entry.form)
    ours = true(plant.truth, numbers(entry.machine), [hidden], drive)
    without = true(plant.truth, numbers(entry.machine), [], drive)
    grown = graft(
        MACHINES[entry.machine](), entry.effect, entry.site, parameters=coefficients(entry)
    )
    theirs = model_run(grown.graph, entry.machine, drive)
    limit = LOOSE.get(hidden.law, 2e-3)
    for name, column in ours.items():
        change = np.abs(column - without[name]).max()
        scale = np.abs(without[name]).max()
        gap = np.sqrt(np.mean((column - theirs[name]) ** 2))
        assert gap <= limit * change + 1e-5 * scale, name


def free_swing(hidden, x0=0.01, size=4000):
    """A mass of 2 kg on 800 N/m, let go at 1 cm: no damping, 20 rad/s."""
    t = np.arange(size) * 1e-3
    drive = Drive(t, np.zeros(size))
    run = true("mass_spring", {"m": 2.0, "k": 800.0, "b": 0.0}, hidden, drive)
    return t, run["x"], run["v"]


def test_dry_friction_takes_the_same_from_each_half_swing():
    """Amplitude falls by 2 F/k a half period, and the mass rests inside F/k (Den Hartog)."""
    level = 0.6
    _, x, v = free_swing([Hidden("coulomb_friction", "carriage", {"level": level})])
    half = round(pi / 20 / 1e-3)
    peaks = [abs(x[i * half]) for i in range(6)]
    assert peaks == pytest.approx([0.01 - i * 2 * level / 800 for i in range(6)], abs=2e-6)
    assert abs(v[-1]) < 1e-12 and abs(x[-1]) <= level / 800


def test_a_stop_returns_the_share_of_the_speed():
    values = {"upper": 1.0, "lower": 0.0, "restitution": 0.5, "rest": 1e-4}
    t, x, v = free_swing([Hidden("end_stop", "carriage", values)])
    strike = pi / 2 / 20  # at the middle, at full speed
    after = t > strike + 2e-3
    assert v[t < strike].min() == pytest.approx(-0.2, rel=1e-4)
    assert v[after].max() == pytest.approx(0.1, rel=3e-3)  # two samples late
    assert x.min() >= -1e-9


def test_damping_leaves_the_closed_form():
    t, x, _ = free_swing([Hidden("viscous_damping", "carriage", {"damping": 4.0})])
    w = sqrt(400 - 1)
    form = 0.01 * np.exp(-t) * (np.cos(w * t) + np.sin(w * t) / w)
    assert np.abs(x - form).max() < 2e-7


@pytest.mark.parametrize("effect", ["hysteresis", "quadratic_drag", "stribeck_friction"])
def test_what_resists_never_gives_energy(effect):
    values = {
        "hysteresis": {"level": 2.0, "width": 2e-3},
        "quadratic_drag": {"drag": 5.0},
        "stribeck_friction": {"level": 0.3, "excess": 0.3, "speed": 0.05},
    }[effect]
    _, x, v = free_swing([Hidden(effect, "carriage", values)])
    energy = v**2 + 400 * x**2
    stored = 0.5 * 2.0 * 2e-3 * 2  # of the hysteretic spring, to be lent and returned
    slack = stored if effect == "hysteresis" else 1e-9
    assert (np.maximum.accumulate(energy[::-1])[::-1] <= energy + slack).all()
    assert energy[-1] < 0.9 * energy[0]


def test_a_cubic_spring_keeps_energy():
    _, x, v = free_swing([Hidden("cubic_stiffness", "carriage", {"cubic": 4e6})])
    energy = v**2 + 400 * x**2 + 1e6 * x**4
    assert np.ptp(energy) < 1e-5 * energy[0]


def test_an_orifice_empties_a_tank_along_a_parabola():
    """The root of the pressure falls in proportion to time (Torricelli)."""
    t = np.arange(200) * 1.0
    table = {"C1": 2e-5, "C2": 1e-5, "R12": 1e30, "R2": 1e30}
    run = true(
        "two_tanks",
        table,
        [Hidden("orifice_flow", "first", {"orifice": 5e-6})],
        Drive(t, np.zeros(200)),
    )
    assert np.sqrt(run["p1"]) == pytest.approx(sqrt(5000) - 5e-6 / 2e-5 / 2 * t, rel=1e-6)


def test_a_delay_is_a_shift():
    plant = PLANTS["rlc"]
    drive = driven("rlc", "steps")
    late = true(
        "rlc",
        numbers("rlc"),
        [Hidden("transport_delay", "source generator", {"delay": 7 * plant.step})],
        drive,
    )
    prompt = true("rlc", numbers("rlc"), [], drive)
    assert late["u"][7:] == pytest.approx(prompt["u"][:-7], abs=1e-6 * np.ptp(prompt["u"]))


def test_fade_is_the_exponential_of_heat():
    """At a steady speed the pad's torque falls as its heat rises to where cooling holds it."""
    t = np.arange(4000) * 0.2
    values = {"fade": 1e-4, "cooling": 0.05}
    run = true(
        "thermal_brake",
        {"J": 0.5, "br": 0.8, "Cd": 150.0, "Rc": 0.6},
        [Hidden("thermal_fade", "dissipator pad", values)],
        Drive(t, np.full(4000, 4.0)),
    )
    speed = run["speed"][-1]
    assert 0.8 * exp(-1e-4 * 4.0 * speed / 0.05) * speed == pytest.approx(4.0, rel=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_inputs_begin_at_nothing_and_stay_within(kind):
    plant = PLANTS["two_tanks"]
    u = excitation(plant, kind, 800, np.random.default_rng(1))
    assert u[0] == 0 and u.min() >= 0 and u.max() <= plant.offset + plant.amplitude + 1e-12
    assert np.std(u) > 0.2 * plant.amplitude
