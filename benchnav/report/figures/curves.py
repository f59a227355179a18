"""Success against horizon or a parameter: a line for each navigator, with its intervals."""

from collections.abc import Mapping, Sequence

from benchnav.leaderboard.statistics.curve import Point
from benchnav.report.figure import plain
from benchnav.report.figures.style import BELOW, Figure, errors, marker, translucent
from benchnav.report.line_style import LineStyle

MOST_BANDS = 4  # with more navigators, intervals are only in the hover text
DIGITS = 4


def curves_figure(points: Sequence[Point], styles: Mapping[str, LineStyle]) -> Figure:
    """Return the curves of one panel (`benchnav.leaderboard.statistics.curve.panels`)."""
    curves: dict[str, list[Point]] = {}
    for point in points:
        curves.setdefault(point.navigator, []).append(point)
    ordered = [name for name in styles if name in curves]
    data = []
    for name in ordered:
        if len(ordered) <= MOST_BANDS:
            data.append(_band(curves[name], styles[name]))
        data.append(_line(name, curves[name], styles[name]))
    layout = {
        "xaxis": {"title": {"text": "time since the start [s]"}, "rangemode": "tozero"},
        "yaxis": {"title": {"text": "success"}, "range": [-0.03, 1.03]},
        "legend": dict(BELOW),
        "hovermode": "closest",
    }
    return {"data": data, "layout": layout}


def parameter_figure(points: Sequence[Point], styles: Mapping[str, LineStyle]) -> Figure:
    """Return a metric against a parameter: a mark with its interval for each value."""
    data = []
    for name, style in styles.items():
        curve = sorted((p for p in points if p.navigator == name), key=lambda p: p.x)
        if not curve:
            continue
        values, lows, highs = ([getattr(p, k) for p in curve] for k in ("value", "low", "high"))
        data.append({
            "type": "scatter", "mode": "lines+markers", "name": plain(name),
            "x": [p.x for p in curve], "y": values, "marker": marker(style),
            "line": {"color": style.color, "dash": style.dash, "width": 2},
            "error_y": errors(values, lows, highs, translucent(style.color, 0.6)),
            "text": [f"{p.value:.3f} [{p.low:.3f}, {p.high:.3f}]" for p in curve],
            "hovertemplate": "%{fullData.name}<br>%{text} at %{x}<extra></extra>",
        })  # fmt: skip
    first = points[0]
    unit = f" [{first.axis_unit}]" if first.axis_unit else ""
    layout = {
        "xaxis": {"title": {"text": plain(f"{first.axis}{unit}")}},
        "yaxis": {"title": {"text": plain(first.metric)}, "range": [-0.03, 1.03]},
        "legend": dict(BELOW),
    }
    return {"data": data, "layout": layout}


def _line(name: str, curve: Sequence[Point], style: LineStyle) -> Figure:
    value = [_rounded(p.value) for p in curve]
    return {
        "type": "scatter", "mode": "lines", "name": plain(name), "legendgroup": plain(name),
        "x": [0.0, *(_rounded(p.x) for p in curve)], "y": [0.0, *value],
        "line": {"color": style.color, "dash": style.dash, "width": 2, "shape": "hv"},
        "text": ["", *(f"{p.value:.3f} [{p.low:.3f}, {p.high:.3f}]" for p in curve)],
        "hovertemplate": "%{fullData.name}<br>%{text} at %{x} s<extra></extra>",
    }  # fmt: skip


def _band(curve: Sequence[Point], style: LineStyle) -> Figure:
    x = [_rounded(p.x) for p in curve]
    low, high = ([_rounded(getattr(p, end)) for p in curve] for end in ("low", "high"))
    name = plain(curve[0].navigator)
    return {
        "type": "scatter", "mode": "lines", "x": [*x, *reversed(x)], "y": [*high, *reversed(low)],
        "fill": "toself", "fillcolor": translucent(style.color, 0.14), "line": {"width": 0},
        "hoverinfo": "skip", "showlegend": False, "legendgroup": name,
    }  # fmt: skip


def _rounded(number: float) -> float:
    return round(number, DIGITS)
