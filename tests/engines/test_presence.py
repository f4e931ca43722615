"""A missing engine is named, and where all are required nothing is skipped."""

import os
import shutil

import pytest

from . import presence


def test_nothing_is_skipped_where_all_engines_are_required():
    missing = [name for name, engine in presence.ENGINES.items() if not engine.found()]
    assert not missing or os.environ.get(presence.REQUIRE) != "1", missing


@pytest.fixture
def no_ngspice(monkeypatch):
    monkeypatch.setenv("PATH", "")
    assert shutil.which("ngspice") is None


def test_a_missing_engine_is_skipped_by_name(no_ngspice, monkeypatch):
    monkeypatch.delenv(presence.REQUIRE, raising=False)
    with pytest.raises(pytest.skip.Exception, match=r"^ngspice is not installed: apt-get install"):
        presence.need("ngspice")


def test_a_missing_engine_fails_where_it_is_required(no_ngspice, monkeypatch):
    monkeypatch.setenv(presence.REQUIRE, "1")
    with pytest.raises(pytest.fail.Exception, match=r"^ngspice is not installed: apt-get install"):
        presence.need("ngspice")
