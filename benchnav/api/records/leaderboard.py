"""The table of one or more runs."""

from collections.abc import Sequence
from functools import cached_property
from os import PathLike

from benchnav.api.output.exports import Exports
from benchnav.api.output.text_table import written
from benchnav.leaderboard.from_runs import StoredValues
from benchnav.leaderboard.record import Leaderboard as Board
from benchnav.leaderboard.record import Record
from benchnav.leaderboard.rendering.formats import html_fragment


class Leaderboard(Exports):
    """Means, 95 % intervals and ranks of navigators; it shows itself in a terminal or notebook.

    The methods ``to_…`` return the text that ``benchnav leaderboard --format …`` prints, and also
    write it where they are given a file.
    """

    def __init__(
        self,
        values: StoredValues,
        metrics: Sequence[str] | None = None,
        columns: Sequence[str] | None = None,
    ) -> None:
        self._values, self._metrics, self._columns = values, metrics, columns
        values.shown("markdown", metrics, columns)  # refuses unknown names at once

    @cached_property
    def record(self) -> Board:
        """The plain record of the metrics that are shown."""
        return self._values.board(self._values.shown("markdown", self._metrics, self._columns))

    @cached_property
    def records(self) -> tuple[Record, ...]:
        """One record for each navigator, scenario, track, role and metric, as in the CSV file."""
        shown = self._values.shown("csv", self._metrics, self._columns)
        return self._values.board(shown).records

    @property
    def navigators(self) -> tuple[str, ...]:
        """The labels of the navigators."""
        return self.record.navigators

    @property
    def metrics(self) -> tuple[str, ...]:
        """The metrics that the runs hold, whether they are shown or not."""
        return tuple(self._values.names)

    def to_latex(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return matrices of navigators and scenarios as LaTeX."""
        return written(self.text("latex"), path)

    def to_html(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return the tables as an HTML page."""
        return written(self.text("html"), path)

    @property
    def _record_type(self) -> type:
        return Record

    def text(self, format: str) -> str:
        """Return the table as text in a format: terminal, markdown, csv, latex, html or json."""
        return self._values.text(format, self._metrics, self._columns)

    def __repr__(self) -> str:
        return self.text("terminal").rstrip("\n")

    def _repr_html_(self) -> str:
        return html_fragment(self.record, self._metrics, self._columns)
