"""`discover` on a few sealed cases, one a machine."""

import pytest

import bondgraph

from . import files
from .make import made
from .plans import Plan, plans
from .runner import ANSWERS, run
from .score import failures, results

pytestmark = pytest.mark.skipif(
    not hasattr(bondgraph, "discover"), reason="bondgraph.discover is not there"
)
FEW = (
    ("mass_spring", "coulomb_friction"),
    ("two_mass_chain", "viscous_damping"),
    ("dc_motor", "saturation"),
    ("quarter_car", "cubic_stiffness"),
    ("two_tanks", "overflow"),
    ("hydraulic_cylinder", "quadratic_drag"),
    ("thermal_brake", "quadratic_drag"),
    ("rlc", "nonlinear_inertance"),
)


def plan_of(machine: str, effect: str) -> Plan:
    return next(
        plan
        for plan in plans()
        if plan.kind == "effect"
        and plan.noise == 0.02
        and (plan.machine, plan.entries[0].effect) == (machine, effect)
    )


@pytest.mark.slow
def test_most_of_a_few_are_named_where_they_are(tmp_path):
    folders = files.write((made(plan_of(*few)) for few in FEW), tmp_path)
    run(folders, tmp_path / ANSWERS, jobs=2)
    rows = results(tmp_path, tmp_path / ANSWERS)
    wrong = failures(rows).rows
    assert len(rows) == len(FEW) and len(wrong) <= 1, wrong
