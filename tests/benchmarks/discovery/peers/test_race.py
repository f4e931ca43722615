"""The peer on a case without noise, and how it is counted."""

import numpy as np
import pytest

from .. import files
from ..judge import judged
from ..machines import MACHINES
from ..make import made
from ..plans import plans
from ..plants import PLANTS
from . import race
from .setups import SETUPS, expected, way


def plan_of(machine, effect, noise):
    return next(
        plan
        for plan in plans()
        if (plan.kind, plan.machine, plan.noise) == ("effect", machine, noise)
        and plan.entries[0].effect == effect
    )


@pytest.mark.parametrize("machine", SETUPS)
def test_right_terms_are_offered(machine):
    setup, plant = SETUPS[machine], PLANTS[machine]
    assert machine in MACHINES
    t = np.linspace(0, 1, 50)
    columns = {name: np.sin(5 * t) for name in (plant.drive, *plant.outputs)}
    states = setup.derive(t, columns)
    for terms in setup.right.values():
        for equation, feature in terms:
            assert feature in {*setup.features(states, equation), "1"}
            assert feature not in setup.equations[equation]


def test_a_way_is_an_integral():
    t = np.linspace(0, 2, 201)
    assert way(t, 3 * t**2) == pytest.approx(t**3, abs=1e-3)


def test_counts():
    truth = {
        "id": "a1",
        "kind": "effect",
        "machine": "mass_spring",
        "noise": 0.02,
        "hidden": [{"effect": "quadratic_drag", "site": "carriage", "values": {}}],
        "right": [[["quadratic_drag", "carriage"]]],
        "asked": [{}],
        "unmeasured": "",
        "identifiable": True,
    }
    assert expected(truth) == (("v", "v|v|"),) and not expected(truth | {"unmeasured": "x"})
    effects = [{"name": "quadratic_drag", "site": "carriage", "parameters": {}}]
    ours = judged(truth, {"id": "a1", "verdict": "named", "effects": effects})
    right = {"a1": {"effects": [{"name": "v|v|", "site": "v"}]}}
    wrong = {"a1": {"effects": [{"name": "sign(v)", "site": "v"}]}}
    found = race.counted([ours], {"one": right, "other": wrong})
    assert found.headings[2:] == ("discover", "one", "other")
    assert found.rows == [["2.0%", "1", "1", "1", "0"], ["all", "1", "1", "1", "0"]]
    assert found.limits[0].value == 0  # ahead of the better one
    assert race.counted([ours], {"one": wrong}).limits[0].value == 1


def test_smoothed_signals_are_nearer_to_the_truth(tmp_path):
    from .smoothed import latent

    case = made(plan_of("mass_spring", "cubic_stiffness", 0.02))
    (folder,) = files.write([case], tmp_path)
    columns = latent(folder, "train")
    assert columns.keys() == {"x", "v"}
    for name, smooth in columns.items():
        measured = next(
            c for n, c in case.records["train"].columns.items() if n.startswith(f"{name} ")
        )
        off = np.std(measured - smooth)
        assert 0.5 * 0.02 < off / np.std(measured) < 1.2 * 0.02  # the noise is what is left


def test_the_peer_names_a_cubic_spring(tmp_path):
    """A fair race: what it can do it does."""
    pytest.importorskip("pysindy")
    from .sindy import solve

    case = made(plan_of("mass_spring", "cubic_stiffness", 0.002))
    (folder,) = files.write([case], tmp_path)
    assert race.hit(case.sealed, solve(folder))
