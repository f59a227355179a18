"""A price of one navigator, scenario by scenario."""

from collections.abc import Sequence

from benchnav.leaderboard.record import ALL, IGNORANCE, Record
from benchnav.leaderboard.rendering.cell import cell
from benchnav.report.figure import plain
from benchnav.report.figures.style import Figure, errors, rows_axis
from benchnav.report.line_style import LineStyle

WHOLE = "all scenarios"


def price_figure(prices: Sequence[Record], style: LineStyle) -> Figure:
    """Return the differences of one metric, such as known − unknown, a row for each scenario.

    ``prices`` come from `benchnav.report.analysis.price.prices_of`, of one split, role and
    condition. Filled marks: the interval excludes 0.
    """
    shown = [r for r in prices if r.value == r.value and r.episodes]
    names = [WHOLE if r.scenario == ALL else plain(r.scenario) for r in shown]
    values, lows, highs = ([getattr(r, k) for r in shown] for k in ("value", "low", "high"))
    decided = [r.low > 0.0 or r.high < 0.0 for r in shown]
    ends = [abs(x) for x in (*values, *lows, *highs) if x == x]
    reach = 1.08 * max(ends, default=0.0) or 1.0
    data = [{
        "type": "scatter", "mode": "markers", "x": values, "y": names,
        "error_x": errors(values, lows, highs, style.color),
        "marker": {
            "color": style.color, "size": 9, "line": {"color": style.color, "width": 2},
            "symbol": [style.symbol if full else f"{style.symbol}-open" for full in decided],
        },
        "text": [cell(r, interval=True, decided=False).text for r in shown],
        "hovertemplate": "%{y}<br>%{text}<extra></extra>",
    }]  # fmt: skip
    price = (shown[0].price or IGNORANCE) if shown else IGNORANCE
    title = f"{plain(shown[0].metric)}, {price.first} − {price.second}" if shown else ""
    layout = {
        "xaxis": {"title": {"text": title}, "range": [-reach, reach], "zeroline": True},
        "yaxis": rows_axis(names), "showlegend": False,
    }  # fmt: skip
    return {"data": data, "layout": layout}
