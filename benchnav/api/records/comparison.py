"""Two navigators against each other."""

from collections.abc import Mapping
from os import PathLike

from benchnav.api.output.exports import Exports
from benchnav.api.output.text_table import table_html
from benchnav.leaderboard.rendering.prose import place, render_duel, sentence
from benchnav.leaderboard.statistics.comparison import Comparison as Record
from benchnav.leaderboard.statistics.head_to_head import Duel
from benchnav.metrics.metric import Metric


class Comparison(Exports):
    """The differences between two navigators, with their sizes and their confidence.

    Worlds are paired, intervals are of 95 %, and all sentences are one family of tests.
    """

    def __init__(self, record: Duel, metrics: Mapping[str, Metric]) -> None:
        self.record = record  # the plain record
        self.metrics = metrics  # definitions by name

    @property
    def records(self) -> tuple[Record, ...]:
        return self.record.comparisons

    @property
    def _record_type(self) -> type:
        return Record

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
