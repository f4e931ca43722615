"""`discover` on a few sealed cases, one a machine."""

import pytest

from . import files
from .make import made
from .plans import Plan, plans
from .runner import ANSWERS, run
from .score import failures, results

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


QUICK = (FEW[0], FEW[6], FEW[7])


def asked(cases, folder):
    """Ask about cases; return how many there are, and those that were answered wrong."""
    folders = files.write((made(plan_of(*case)) for case in cases), folder)
    run(folders, folder / ANSWERS, jobs=2)
    rows = results(folder, folder / ANSWERS)
    return len(rows), failures(rows).rows


def test_some_are_named_where_they_are(tmp_path):
    count, wrong = asked(QUICK, tmp_path)
    assert count == len(QUICK) and not wrong, wrong


@pytest.mark.slow
def test_most_of_a_few_are_named_where_they_are(tmp_path):
    count, wrong = asked(FEW, tmp_path)
    assert count == len(FEW) and len(wrong) <= 1, wrong
