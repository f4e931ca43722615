"""docs/effects.md has one row an effect, and the row is true."""

import re
from pathlib import Path

from bondgraph.discrepancy.candidates import EFFECTS
from bondgraph.discrepancy.candidates.places import KINDS

PAGE = (Path(__file__).parents[3] / "docs" / "effects.md").read_text(encoding="utf-8")


def test_the_table_of_the_page_is_the_table_of_the_code():
    rows = re.findall(r"^\| `(\w+)` \| (.*) \| (.*) \| (.*) \| (.*) \|$", PAGE, re.MULTILINE)
    assert [row[0] for row in rows] == list(EFFECTS)
    for name, sites, coefficients, absent, marks in rows:
        effect = EFFECTS[name]
        assert tuple(sites.split(", ")) == effect.sites
        assert coefficients.split(", ") == [item.name for item in effect.coefficients]
        gone = [f"{key} = {'∞' if value else '0'}" for key, value in effect.absent.items()]
        assert absent.split(", ") == gone
        true = {"states": effect.states, "events": effect.events, "active": not effect.passive}
        assert marks == ", ".join(word for word, holds in true.items() if holds)


def test_the_page_names_every_kind_of_site():
    assert all(kind in PAGE for kind in KINDS)
