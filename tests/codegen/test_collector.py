"""The collector is on again after a stage, also where the stage fails, and off where it was off."""

import gc

import pytest

from bondgraph import One, R, Se, assemble
from bondgraph.codegen.collector import held_back
from bondgraph.errors import GraphError


def test_it_is_back_after_a_stage_and_after_an_error():
    assert gc.isenabled()
    assemble("g", Se("E", 1) >> One("v") >> R("r", 1))
    assert gc.isenabled()
    with pytest.raises(GraphError):
        assemble("g", One("dangling"))
    assert gc.isenabled()


def test_it_stays_off_within_and_where_the_caller_wants_none():
    with held_back():
        assemble("g", Se("E", 1) >> One("v") >> R("r", 1))
        assert not gc.isenabled()
    assert gc.isenabled()
