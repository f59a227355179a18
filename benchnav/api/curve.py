"""A metric against a parameter, or success against the horizon."""

from collections.abc import Sequence
from dataclasses import fields
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from benchnav.api.text_table import written
from benchnav.leaderboard.rendering.curve_table import render_curves
from benchnav.leaderboard.statistics.curve import Point

if TYPE_CHECKING:
    import pandas as pd


class Curve:
    """The points of one curve for each navigator, scenario, track and role."""

    def __init__(self, points: Sequence[Point]) -> None:
        self.points = tuple(points)  # the plain records

    def to_markdown(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return tables as Markdown, and write them to ``path`` where it is given."""
        return written(self.text("markdown"), path)

    def to_csv(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return every point as CSV, and write it to ``path`` where it is given."""
        return written(self.text("csv"), path)

    def to_json(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return every point as JSON, and write it to ``path`` where it is given."""
        return written(self.text("json"), path)

    def to_pandas(self) -> "pd.DataFrame":
        """Return a data frame with the columns and rows of the CSV file."""
        import pandas as pd

        columns = [field.name for field in fields(Point)]
        rows = [[getattr(point, name) for name in columns] for point in self.points]
        return pd.DataFrame(rows, columns=columns)

    def plot(self, path: "str | PathLike[str]") -> None:
        """Draw the curves into a .png, .svg or .pdf file."""
        from benchnav.viewer.curves import draw_curves
        from benchnav.viewer.picture import save

        save(draw_curves(self.points), Path(path))

    def text(self, format: str) -> str:
        """Return the curves as text in a format: markdown, csv or json."""
        return render_curves(self.points, format)

    def __repr__(self) -> str:
        return self.text("markdown").rstrip("\n")
