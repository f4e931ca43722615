"""What a race found, for the terminal and for docs/benchmarks.md."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table

PAGE = Path(__file__).parents[2] / "docs" / "benchmarks.md"


@dataclass(frozen=True)
class Limit:
    """A ratio or figure, and what the framework asks of itself.

    Attributes
    ----------
    what : what is compared with what
    value, limit : measured, and the least or greatest allowed
    least : whether the limit is the least
    """

    what: str
    value: float
    limit: float
    least: bool = False

    @property
    def kept(self) -> bool:
        """Whether the limit is kept."""
        return self.value >= self.limit if self.least else self.value <= self.limit

    def __str__(self) -> str:
        asked = "at least" if self.least else "at most"
        kept = "kept" if self.kept else "NOT KEPT"
        return f"{self.what}: {self.value:.3g} ({asked} {self.limit:g}: {kept})"


@dataclass(frozen=True)
class Report:
    """One race.

    Attributes
    ----------
    name : of the race, and of its place in the page
    headings, rows : the table
    limits : what the framework asks of itself
    notes : who could not start, and why
    """

    name: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    limits: Sequence[Limit] = ()
    notes: Sequence[str] = field(default_factory=tuple)

    @property
    def kept(self) -> bool:
        """Whether all started and all limits are kept."""
        return not self.notes and all(limit.kept for limit in self.limits)

    def show(self, console: Console) -> None:
        """Print the table and what follows from it."""
        table = Table(title=self.name, box=box.SIMPLE)
        for i, heading in enumerate(self.headings):
            table.add_column(heading, justify="left" if i == 0 else "right")
        for row in self.rows:
            table.add_row(*row)
        console.print(table)
        for line in (*map(str, self.limits), *self.notes):
            console.print(line, markup=False)

    def markdown(self) -> str:
        """Return the table and what follows from it for the page."""
        rule = ["---", *["---:"] * (len(self.headings) - 1)]
        lines = [f"| {' | '.join(row)} |" for row in (self.headings, rule, *self.rows)]
        told = [f"- {line}" for line in (*map(str, self.limits), *self.notes)]
        return "\n".join([*lines, "", *told])


def write(report: Report, page: Path = PAGE) -> None:
    """Put a report into its place in the page, between two comments with its name.

    Raises
    ------
    ValueError
        if the page has no such place
    """
    text = page.read_text(encoding="utf-8")
    begin, end = f"<!-- {report.name} -->", f"<!-- end of {report.name} -->"
    if begin not in text or end not in text:
        raise ValueError(f"{page} has no place for {report.name!r}: {begin} ... {end}")
    before, _, rest = text.partition(begin)
    _, _, after = rest.partition(end)
    page.write_text(f"{before}{begin}\n{report.markdown()}\n{end}{after}", encoding="utf-8")
