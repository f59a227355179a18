"""Two navigators against each other."""

from collections.abc import Mapping
from dataclasses import fields
from os import PathLike
from typing import TYPE_CHECKING

from benchnav.api.text_table import table_html, written
from benchnav.leaderboard.rendering.prose import place, render_duel, sentence
from benchnav.leaderboard.statistics.comparison import Comparison as Record
from benchnav.leaderboard.statistics.head_to_head import Duel
from benchnav.metrics.metric import Metric

if TYPE_CHECKING:
    import pandas as pd


class Comparison:
    """The differences between two navigators, with their sizes and their confidence.

    Worlds are paired, intervals are of 95 %, and all sentences are one family of tests.
    """

    def __init__(self, record: Duel, metrics: Mapping[str, Metric]) -> None:
        self.record = record  # the plain record
        self.metrics = metrics  # definitions by name

    @property
    def records(self) -> tuple[Record, ...]:
        """One record for each metric, scenario, track and role."""
        return self.record.comparisons

    def to_markdown(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return sentences as Markdown, and write them to ``path`` where it is given."""
        return written(self.text("markdown"), path)

    def to_csv(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return every record as CSV, and write it to ``path`` where it is given."""
        return written(self.text("csv"), path)

    def to_json(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return every record as JSON, and write it to ``path`` where it is given."""
        return written(self.text("json"), path)

    def to_pandas(self) -> "pd.DataFrame":
        """Return a data frame with the columns and rows of the CSV file."""
        import pandas as pd

        columns = [field.name for field in fields(Record)]
        rows = [[getattr(record, name) for name in columns] for record in self.records]
        return pd.DataFrame(rows, columns=columns)

    def plot(self, path: "str | PathLike[str]") -> None:
        """Draw the differences with their intervals into a .png, .svg or .pdf file."""
        from pathlib import Path

        from benchnav.viewer.forest import draw_duel
        from benchnav.viewer.picture import save

        save(draw_duel(self.record, self.metrics), Path(path))

    def text(self, format: str) -> str:
        """Return the comparison as text in a format: markdown, csv or json."""
        return render_duel(self.record, self.metrics, format)

    def __repr__(self) -> str:
        return self.text("markdown").rstrip("\n")

    def _repr_html_(self) -> str:
        roles, splits = {c.role for c in self.records}, {c.split for c in self.records}
        rows = [
            (
                c.metric, place(c, role=len(roles) > 1, split=splits != {"test"}), c.verdict,
                sentence(c, self.metrics[c.metric]),
            )
            for c in self.records
        ]  # fmt: skip
        title = f"{self.record.first} against {self.record.second}"
        return table_html(title, ("metric", "where", "verdict", "difference"), rows)
