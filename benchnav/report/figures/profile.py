"""The profile of a navigator: its value in each family, among those of all others."""

from collections.abc import Mapping, Sequence

from benchnav.leaderboard.record import Record
from benchnav.leaderboard.rendering.cell import cell
from benchnav.report.figure import plain
from benchnav.report.figures.style import BELOW, GREY, Figure, errors, marker, rows_axis
from benchnav.report.line_style import LineStyle


def profile_figure(
    families: Mapping[str, Mapping[str, Record]], navigator: str, style: LineStyle
) -> Figure:
    """Return a row for each family; ``families`` maps family → navigator → record."""
    rows = {name: found for name, found in families.items() if navigator in found}
    names = [plain(name) for name in rows]
    others = [
        (plain(family), record)
        for family, found in rows.items()
        for name, record in found.items()
        if name != navigator and record.value == record.value
    ]
    own = [found[navigator] for found in rows.values()]
    layout = {
        "xaxis": {"title": {"text": "success"}, "range": [-0.03, 1.03]},
        "yaxis": rows_axis(names), "legend": dict(BELOW),
    }  # fmt: skip
    return {"data": [_others(others), _own(names, own, navigator, style)], "layout": layout}


def _others(found: Sequence[tuple[str, Record]]) -> Figure:
    return {
        "type": "scatter", "mode": "markers", "name": "other navigators",
        "x": [record.value for _, record in found], "y": [family for family, _ in found],
        "marker": {"symbol": "line-ns-open", "size": 11, "color": GREY, "opacity": 0.75},
        "text": [f"{plain(r.navigator)}: {_text(r)}" for _, r in found],
        "hovertemplate": "%{y}<br>%{text}<extra></extra>",
    }  # fmt: skip


def _own(names: Sequence[str], own: Sequence[Record], navigator: str, style: LineStyle) -> Figure:
    values = [r.value for r in own]
    bars = errors(values, [r.low for r in own], [r.high for r in own], style.color)
    return {
        "type": "scatter", "mode": "markers", "name": plain(navigator), "x": values, "y": [*names],
        "marker": marker(style, 11), "error_x": bars, "text": [_text(r) for r in own],
        "hovertemplate": "%{y}<br>%{fullData.name}: %{text}<extra></extra>",
    }  # fmt: skip


def _text(record: Record) -> str:
    return cell(record, interval=True, decided=False).text
