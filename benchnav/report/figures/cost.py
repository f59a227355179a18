"""The cost of navigators: times on a logarithmic axis, and success against time."""

from collections.abc import Mapping, Sequence
from typing import Any

from benchnav.leaderboard.record import Record
from benchnav.leaderboard.rendering.cell import cell
from benchnav.report.figure import plain
from benchnav.report.figures.style import BELOW, GREY, Figure, errors, marker, rows_axis
from benchnav.report.line_style import LineStyle

TICK = "line-ns-open"  # the mark of a higher percentile
TICKS: Mapping[str, Any] = {
    "tickvals": [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0, 100.0],
    "ticktext": ["1 µs", "10 µs", "0.1 ms", "1 ms", "10 ms", "0.1 s", "1 s", "10 s", "100 s"],
}


def times_figure(
    costs: Mapping[str, Mapping[str, Record]],
    metrics: Sequence[str],
    own: str,
    styles: Mapping[str, LineStyle],
) -> Figure:
    """Return times of all navigators, the fastest at the top; only ``own`` has its colour.

    ``metrics`` are percentiles of one time, from low to high: a line joins them.
    """
    held = [m for m in metrics if m in costs]
    names = [n for n in styles if n in costs[held[0]]]
    names.sort(key=lambda n: costs[held[0]][n].value)
    data = [
        {
            "type": "scatter", "mode": "lines+markers", "y": [plain(name)] * len(found),
            "x": [r.value for r in found],
            "line": {"color": styles[name].color if name == own else GREY, "width": 3},
            "marker": {"size": 8, "symbol": [styles[name].symbol, *[TICK] * (len(found) - 1)]},
            "opacity": 1.0 if name == own else 0.6,
            "text": [f"{r.metric}: {cell(r, interval=False, decided=False).text}" for r in found],
            "hovertemplate": "%{y}<br>%{text}<extra></extra>",
        }
        for name in names
        for found in [[costs[m][name] for m in held if name in costs[m]]]
    ]  # fmt: skip
    layout = {
        "xaxis": {"type": "log", **TICKS}, "yaxis": rows_axis([plain(n) for n in names]),
        "showlegend": False,
    }  # fmt: skip
    return {"data": data, "layout": layout}


def value_figure(
    success: Mapping[str, Record], times: Mapping[str, Record], styles: Mapping[str, LineStyle]
) -> Figure:
    """Return success against the time of a decision: a mark for each navigator."""
    data = []
    for name, style in styles.items():
        if name not in success or name not in times:
            continue
        r, time = success[name], times[name]
        bars = errors([r.value], [r.low], [r.high], style.color)
        texts = (cell(each, interval=True, decided=False).text for each in (r, time))
        data.append({
            "type": "scatter", "mode": "markers", "name": plain(name), "x": [time.value],
            "y": [r.value], "marker": marker(style, 11), "error_y": bars,
            "text": ["<br>".join(texts)],
            "hovertemplate": "%{fullData.name}<br>%{text}<extra></extra>",
        })  # fmt: skip
    layout = {
        "xaxis": {"type": "log", "title": {"text": "time of a decision, median"}, **TICKS},
        "yaxis": {"title": {"text": "success"}, "range": [-0.03, 1.03]},
        "legend": dict(BELOW),
    }
    return {"data": data, "layout": layout}
