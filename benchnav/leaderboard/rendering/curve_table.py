"""Curves as text: tables for people, tidy records for machines."""

from collections.abc import Sequence

from benchnav.errors import UsageError
from benchnav.leaderboard.rendering import escape
from benchnav.leaderboard.rendering.digits import figures, number, prefixed
from benchnav.leaderboard.rendering.long_format import as_csv, as_json
from benchnav.leaderboard.statistics.curve import HORIZON, Point, panels
from benchnav.scenario.condition import described
from benchnav.text.plural import counted

FORMATS = ("markdown", "csv", "json")
COLUMNS = 10  # values of the axis in a table for people

LEGENDS = {
    True: "Share of all agents that would have succeeded had the episodes ended by then; failures"
    " stay in the denominator.",
    False: "value [low, high]: mean over worlds and its 95 % interval.",
}


def render_curves(points: Sequence[Point], format: str) -> str:
    """Return curves as text that ends with a line break: Markdown tables, or tidy CSV or JSON.

    Raises UsageError for another format.
    """
    if format not in FORMATS:
        raise UsageError(f"A curve comes as {', '.join(FORMATS)}. Got {format!r} instead.")
    if format == "json":
        return as_json(points)
    if format == "csv":
        return as_csv(Point, points)
    tables = [_table(panel) for panel in panels(points)]
    return "\n".join([*tables, LEGENDS[points[0].axis == HORIZON], ""])


def titled(points: Sequence[Point], role: bool = True) -> str:
    """Return the heading of a panel."""
    p = points[0]
    worlds = {q.worlds for q in points}
    parts = [p.scenario, described(p.track, p.perception), *([f"{p.role}s"] if role else [])]
    parts += [counted(min(worlds), "world")] if len(worlds) == 1 else []
    parts += [f"split {p.split}"] if p.split != "test" else []
    parts += [f"rehearsal: {p.rehearsal}"] if p.rehearsal else []
    return ", ".join(parts)


def _table(points: list[Point]) -> str:
    """Return the curves of one scenario, condition and role, a row for each navigator."""
    every = sorted({p.x for p in points})
    step = max(1, len(every) // COLUMNS)
    shown = every[step - 1 :: step]
    at = {(p.navigator, p.x): p for p in points}
    unit = f" {points[0].axis_unit}" if points[0].axis_unit else ""
    head = [f"{points[0].metric} by {points[0].axis}", *(f"{x:g}{unit}" for x in shown)]
    body = [
        [escape.markdown(name), *(_text(at.get((name, x))) for x in shown)]
        for name in sorted({p.navigator for p in points})
    ]
    width = [max(3, *map(len, column)) for column in zip(head, *body, strict=True)]
    lines = [
        f"| {' | '.join(text.ljust(w) for text, w in zip(row, width, strict=True))} |"
        for row in (head, ["-" * w for w in width], *body)
    ]
    return "\n".join([f"### {escape.markdown(titled(points))}", "", *lines, ""])


def _text(p: Point | None) -> str:
    if p is None or p.value != p.value:
        return "–"
    bounds = [] if p.axis == HORIZON or p.low != p.low else [p.low, p.high]
    size, unit = prefixed(p.unit, max(map(abs, (p.value, *bounds))))
    whole = None if p.unit else 1.0
    if bounds:
        value, low, high = figures(p.value / size, p.low / size, p.high / size, whole)
        value = f"{value} [{low}, {high}]"
    else:
        value = number(p.value / size, whole)
    return f"{value}{f' {unit}' if unit else ''}"
