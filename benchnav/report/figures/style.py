"""The sizes, axes, and marks with intervals that all figures of a report share."""

from collections.abc import Mapping, Sequence
from typing import Any

from benchnav.drawing.palette import channels
from benchnav.report.line_style import LineStyle

Figure = dict[str, Any]
"""A plotly figure in its plain form: ``{"data": [...], "layout": {...}}``."""

ROW = 24  # [px] of a row of a figure with one row for each navigator
FRAME = 90  # [px] of title, axis and margins
LEGEND = 20  # [px] of a line of the legend
GREY = "#7a8794"
BELOW: Mapping[str, Any] = {
    "orientation": "h", "yref": "container", "y": 0, "yanchor": "bottom", "x": 0,
}  # fmt: skip
"""The place of a legend: below the figure, at its left."""


def height_of(rows: int, legend: int = 0) -> int:
    """Return the height [px] of a figure with some rows, and lines of a legend."""
    return FRAME + ROW * max(rows, 2) + LEGEND * legend


def translucent(color: str, share: float) -> str:
    """Return ``#rrggbb`` as a colour that covers only a share of what lies behind it."""
    red, green, blue = channels(color)
    return f"rgba({red}, {green}, {blue}, {share:g})"


def rows_axis(names: Sequence[str]) -> dict[str, Any]:
    """Return a y axis with the names from top to bottom."""
    return {
        "type": "category", "categoryorder": "array", "categoryarray": [*reversed(names)],
        "range": [-0.6, len(names) - 0.4], "fixedrange": True, "ticks": "", "dtick": 1,
    }  # fmt: skip


def errors(
    values: Sequence[float], lows: Sequence[float], highs: Sequence[float], color: str | None = None
) -> dict[str, Any]:
    """Return horizontal error bars from intervals; none where the interval is unknown."""
    below = [v - low if low == low else 0.0 for v, low in zip(values, lows, strict=True)]
    above = [high - v if high == high else 0.0 for v, high in zip(values, highs, strict=True)]
    bars: dict[str, Any] = {
        "type": "data", "symmetric": False, "array": above, "arrayminus": below, "thickness": 2,
        "width": 0,
    }  # fmt: skip
    return bars | ({"color": color} if color else {})


def marker(style: LineStyle, size: int = 9) -> dict[str, Any]:
    """Return the mark of a navigator."""
    return {"color": style.color, "symbol": style.symbol, "size": size}
