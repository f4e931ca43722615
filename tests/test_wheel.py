"""The wheel holds the tree, each file at the place setuptools' mapping gives it, and nothing else.

An editable install finds packages that pyproject.toml forgot to list; a wheel does not.
"""

import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SETUPTOOLS = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
FOLDERS = {folder: package for package, folder in SETUPTOOLS["package-dir"].items()}
SCRATCH = shutil.ignore_patterns("__pycache__", "*.pyc", ".*")


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """A copy of what is packaged: stale files under build/ would get into a wheel made in place."""
    copy = tmp_path_factory.mktemp("tree")
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy / name)
    for folder in FOLDERS:
        shutil.copytree(ROOT / folder, copy / folder, ignore=SCRATCH)
    return copy


@pytest.fixture(scope="module")
def wheel(tree, tmp_path_factory):
    out = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", out, tree]
    done = subprocess.run(command, check=False, capture_output=True, text=True, cwd=out)
    assert done.returncode == 0, done.stdout + done.stderr
    (path,) = out.glob("halfarrow-*.whl")
    with zipfile.ZipFile(path) as archive:
        return sorted(archive.namelist())


def installed(folder, path):
    """Where a file of a top-level folder stands in the wheel."""
    return "/".join([*FOLDERS[folder].split("."), *path.parts])


def test_wheel_holds_the_tree_and_nothing_else(tree, wheel):
    expected = {
        installed(folder, path.relative_to(tree / folder))
        for folder in FOLDERS
        for path in (tree / folder).rglob("*")
        if path.is_file()
    }
    held = {name for name in wheel if ".dist-info/" not in name}
    assert held == expected


def test_wheel_carries_the_licence(wheel):
    assert any(name.endswith(".dist-info/licenses/LICENSE") for name in wheel)


def test_every_package_is_listed(tree):
    found = {
        installed(folder, file.parent.relative_to(tree / folder)).replace("/", ".")
        for folder in FOLDERS
        for file in (tree / folder).rglob("*.py")
    }
    assert found == set(SETUPTOOLS["packages"])


def test_every_package_has_an_init(tree):
    folders = {file.parent for folder in FOLDERS for file in (tree / folder).rglob("*.py")}
    assert [str(f.relative_to(tree)) for f in folders if not (f / "__init__.py").exists()] == []
