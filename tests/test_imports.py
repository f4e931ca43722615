"""Starting is cheap: what loads slowly is loaded by the command or stage that needs it."""

import json
import subprocess
import sys

import pytest

HEAVY = {
    "casadi",
    "control",
    "matplotlib",
    "networkx",
    "numpy",
    "pandas",
    "pint",
    "scipy",
    "sympy",
    "xarray",
}

HELP = """
from click.testing import CliRunner
from bondgraph.cli import main
result = CliRunner().invoke(main, {arguments})
assert result.exit_code == 0, result.output
assert "Usage" in result.output, result.output
"""


def heavy_after(code):
    """Heavy packages that a fresh interpreter holds after `code`."""
    report = (
        "\nimport sys, json; print(json.dumps(sorted(name.split('.')[0] for name in sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code + report], check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return HEAVY & set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        *([name, "--help"] for name in ("stability", "reports", "simulate", "sweep", "discover")),
    ],
)
def test_help_loads_nothing_heavy(arguments):
    assert heavy_after(HELP.format(arguments=arguments)) == set()


def test_the_package_loads_nothing_heavy_until_asked():
    assert heavy_after("import bondgraph") == set()


@pytest.mark.parametrize(
    "module", ["codegen", "elements", "graph", "causality", "equations", "models"]
)
def test_structure_loads_sympy_and_networkx_alone(module):
    assert heavy_after(f"import bondgraph.{module}") <= {"sympy", "networkx"}


HELP_CPU = """
import os, subprocess, sys
command = "from bondgraph.cli import main; main(['--help'])"
subprocess.run([sys.executable, "-c", command], check=True, capture_output=True)
times = os.times()
print(times.children_user + times.children_system)
"""


def help_cpu_seconds():
    done = subprocess.run(
        [sys.executable, "-c", HELP_CPU], check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return float(done.stdout)


def test_help_takes_under_half_a_second_of_cpu():
    # The least of a few: the first may be writing bytecode.
    assert min(help_cpu_seconds() for _ in range(3)) < 0.5
