"""A metric against a parameter, or success against the horizon."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

from benchnav.api.output.exports import Exports
from benchnav.leaderboard.rendering.curve_table import render_curves
from benchnav.leaderboard.statistics.curve import Point


class Curve(Exports):
    """The points of one curve for each navigator, scenario, track and role."""

    def __init__(self, points: Sequence[Point]) -> None:
        self.points = tuple(points)  # the plain records

    @property
    def records(self) -> tuple[Point, ...]:
        return self.points

    @property
    def _record_type(self) -> type:
        return Point

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
