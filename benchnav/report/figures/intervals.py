"""A metric of all navigators in one view: a mark with its interval in each row."""

from collections.abc import Mapping, Sequence
from typing import Any

from benchnav.leaderboard.record import Record
from benchnav.leaderboard.rendering.cell import cell
from benchnav.report.figure import plain
from benchnav.report.figures.style import Figure, errors, marker, rows_axis
from benchnav.report.line_style import LineStyle


def intervals_figure(records: Sequence[Record], styles: Mapping[str, LineStyle]) -> Figure:
    """Return the values of one metric, a row for each navigator, the best at the top.

    ``records`` share scenario, track, role and metric; those without a value are left out.
    """
    shown = by_value([r for r in records if r.value == r.value])
    data = [_mark(r, styles[r.navigator]) for r in shown]
    first = records[0]
    unit = f" [{first.unit}]" if first.unit else ""
    axis: dict[str, Any] = {
        "title": {"text": f"{plain(first.metric)}{unit}"},
        "rangemode": "tozero",
    }
    if first.metric == "success":
        axis["range"] = [-0.03, 1.03]
    layout = {
        "xaxis": axis, "yaxis": rows_axis([plain(r.navigator) for r in shown]), "showlegend": False,
    }  # fmt: skip
    return {"data": data, "layout": layout}


def by_value(records: Sequence[Record]) -> list[Record]:
    """Return the records, the best first."""
    sign = 1.0 if records and records[0].better == "lower" else -1.0
    return sorted(records, key=lambda r: (sign * r.value, r.navigator))


def _mark(r: Record, style: LineStyle) -> Figure:
    worlds = f"{r.defined} worlds"
    return {
        "type": "scatter", "mode": "markers", "x": [r.value], "y": [plain(r.navigator)],
        "marker": marker(style), "error_x": errors([r.value], [r.low], [r.high], style.color),
        "text": [f"{cell(r, interval=True, decided=False).text}, {worlds}"],
        "hovertemplate": "%{y}<br>%{text}<extra></extra>",
    }  # fmt: skip
