"""Failures: outcomes as stacked bars, and the obstacles, walls and agents that were hit."""

from collections.abc import Mapping
from dataclasses import dataclass

from benchnav.report.analysis.failures import OutcomeShares
from benchnav.report.analysis.outcome import Outcome
from benchnav.report.figure import plain
from benchnav.report.figures.style import BELOW, Figure, rows_axis
from benchnav.report.line_style import LineStyle


@dataclass(frozen=True)
class _Fill:
    color: str
    pattern: str  # tells neighbours apart without colours


FILLS = {
    Outcome.SUCCESS: _Fill("#a9bccb", ""),
    Outcome.TIMEOUT: _Fill("#f0d27a", ""),
    Outcome.STUCK: _Fill("#c99a2e", "."),
    Outcome.HIT_AGENT: _Fill("#c4473a", ""),
    Outcome.HIT_DYNAMIC: _Fill("#e98a4b", "/"),
    Outcome.HIT_STATIC: _Fill("#8f6aa8", "x"),
    Outcome.HIT_WALL: _Fill("#54606b", "\\"),
    Outcome.NAVIGATOR_FAILED: _Fill("#1b9aa8", "+"),
    Outcome.OTHER: _Fill("#8c9aa6", "-"),
}


LINES = 6  # of the legend on a phone, at most


def outcomes_figure(rows: Mapping[str, OutcomeShares]) -> Figure:
    """Return stacked bars of shares of agents; ``rows`` maps the name of a row to its outcomes."""
    names = [plain(name) for name in rows]
    data = []
    for outcome, fill in FILLS.items():
        shares = [found[outcome] for found in rows.values()]
        if not any(shares):
            continue
        data.append({
            "type": "bar", "orientation": "h", "name": outcome.text, "y": names,
            "x": [round(share, 5) for share in shares],
            "marker": {
                "color": fill.color,
                "pattern": {
                    "shape": fill.pattern, "size": 6, "solidity": 0.2, "fgcolor": "#fff",
                    "fillmode": "overlay",
                },
            },
            "text": [f"{100 * share:.3g} %" for share in shares], "textposition": "none",
            "hovertemplate": "%{y}<br>%{fullData.name}: %{text} of agents<extra></extra>",
        })  # fmt: skip
    layout = {
        "barmode": "stack", "bargap": 0.3, "legend": dict(BELOW, traceorder="normal"),
        "margin": {"r": 30},
        "xaxis": {
            "title": {"text": "share of agents"}, "range": [0, 1], "fixedrange": True,
            "tickvals": [0, 0.25, 0.5, 0.75, 1], "ticktext": ["0", "25 %", "50 %", "75 %", "100 %"],
        },
        "yaxis": rows_axis(names),
    }  # fmt: skip
    return {"data": data, "layout": layout}


def partners_figure(
    found: Mapping[str, Mapping[str, int]], styles: Mapping[str, LineStyle]
) -> Figure:
    """Return how many agents hit each obstacle, wall or team, by navigator.

    ``found`` comes from `benchnav.report.analysis.failures.partners`.
    """
    names = [plain(name) for name in found]
    data = []
    for navigator, style in styles.items():
        counts = [hits.get(navigator, 0) for hits in found.values()]
        if any(counts):
            data.append({
                "type": "bar", "orientation": "h", "name": plain(navigator), "y": names,
                "x": counts, "marker": {"color": style.color},
                "hovertemplate": "%{y}<br>%{fullData.name}: %{x} collisions<extra></extra>",
            })  # fmt: skip
    layout = {
        "barmode": "stack",
        "bargap": 0.3,
        "legend": dict(BELOW, traceorder="normal"),
        "xaxis": {"title": {"text": "first collisions of agents"}, "fixedrange": True},
        "yaxis": rows_axis(names),
    }
    return {"data": data, "layout": layout}
