"""Sentences of each verdict."""

import math

import pytest

from bondgraph.discrepancy.discovery import Gap, NamedEffect, Verdict
from bondgraph.discrepancy.discovery.words import verdict_words

GAPS = {"x": Gap(2.0, 1.0, 0.1, 0.1, "m"), "p": Gap(9.0, 5.0, 4.9, 4.8, "Pa")}


def effect(name, site="carriage"):
    return NamedEffect(name, name, site, None, {}, 100.0)


def said(verdict, *names, failed=(), removed=0.97):
    return verdict_words("slide", verdict, [effect(name) for name in names], failed, GAPS, removed)


def test_what_is_named_is_said_with_its_place_and_the_gap_that_stands_out():
    first, second = said(Verdict.NAMED, "coulomb_friction", "quadratic_drag")
    assert first == "'slide' lacks coulomb friction at carriage and quadratic drag at carriage."
    assert "gap of x goes from 1 to 0.1 m" in second and "97%" in second


def test_members_of_a_class_are_joined_by_or():
    first, _ = said(Verdict.AMBIGUOUS, "dead_zone", "cubic_stiffness")
    assert "dead_zone at carriage or cubic_stiffness at carriage" in first


def test_what_is_not_named_has_the_nearest_and_why():
    first, _ = said(Verdict.UNNAMED, "hysteresis", failed=["this fails", "that fails"])
    assert "nearest is hysteresis at carriage" in first and "this fails and that fails" in first
    first, second = said(Verdict.UNNAMED)
    assert "nearest" not in first and "largest gap" in second


def test_nothing_missing_is_said_with_what_is_left():
    first, second = said(Verdict.NONE)
    assert first == "The data show nothing that 'slide' lacks."
    assert "x: 1 m where the noise is 0.1" in second


@pytest.mark.parametrize("removed", [-math.inf, math.nan, -0.3])
def test_no_share_is_no_number_that_misleads(removed):
    _, second = said(Verdict.NAMED, "hysteresis", removed=removed)
    assert "nan" not in second and "inf" not in second and "-" not in second.split("noise")[-2]


def test_every_verdict_has_a_meaning():
    assert len({verdict.meaning for verdict in Verdict}) == len(Verdict)
