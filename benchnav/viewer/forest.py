"""A forest plot of two navigators: differences and their intervals, with a panel per metric."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from benchnav.leaderboard.record import ALL
from benchnav.leaderboard.rendering.prose import ARRIVALS, scaled
from benchnav.leaderboard.statistics.comparison import Comparison
from benchnav.leaderboard.statistics.head_to_head import Duel
from benchnav.metrics.metric import Metric
from benchnav.scenario.condition import condition
from benchnav.viewer.picture import BLUE, GREY, RED, blank, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROW, HEAD, PANEL, LABELS = 0.3, 1.9, 2.7, 2.4  # [inch]
NOTHING: dict[str, Any] = {
    "xycoords": ("axes fraction", "data"), "ha": "center", "va": "center", "fontsize": "x-small",
    "color": GREY, "backgroundcolor": "white",
}  # fmt: skip
DECIDED = ("better", "worse", "higher", "lower")


def draw_duel(duel: Duel, metrics: Mapping[str, Metric]) -> Figure:
    """Draw scenarios as rows and metrics as columns; filled marks are significant after Holm.

    Raises MissingExtraError if matplotlib is not installed.
    """
    rows = list(dict.fromkeys(_row(c) for c in duel.comparisons))
    names = list(dict.fromkeys(c.metric for c in duel.comparisons))
    label = max(len(_label(row, rows)) for row in rows)
    figure = blank(0.075 * label + PANEL * len(names), HEAD + ROW * len(rows))
    panels = figure.subplots(1, len(names), sharey=True, squeeze=False)[0]
    for axes, name in zip(panels, names, strict=True):
        chosen = {_row(c): c for c in duel.comparisons if c.metric == name}
        _panel(axes, [chosen.get(row) for row in rows], metrics[name])
    panels[0].set_yticks(range(len(rows)), [_label(row, rows) for row in rows])
    panels[0].set_ylim(len(rows) - 0.4, -0.6)
    figure.suptitle(f"A: {duel.first}   B: {duel.second}   (A − B)", fontweight="bold")
    figure.supxlabel(_legend(duel), fontsize="small", color=GREY)
    return figure


Row = tuple[str, str, str, str]


def _row(c: Comparison) -> Row:
    return c.split, condition(c.track, c.perception), c.role, c.scenario


def _label(row: Row, rows: Sequence[Row]) -> str:
    """Return the text that distinguishes a row from the others."""
    split, where, role, scenario = row
    parts = ["all scenarios" if scenario == ALL else scenario, where]
    parts += [f"{role}s"] if len({r[2] for r in rows}) > 1 else []
    parts += [split] if split != "test" else []
    return ", ".join(parts)


def _panel(axes: Axes, found: Sequence[Comparison | None], metric: Metric) -> None:
    ends = [abs(x) for c in found if c for x in (c.difference, c.low, c.high) if not math.isnan(x)]
    size, unit = scaled(metric, max(ends, default=1.0))
    plain(axes)
    axes.axvline(0.0, color="0.3", linewidth=0.9)
    for y, c in enumerate(found):
        if c is None or not c.worlds:
            axes.annotate("no common world", (0.5, y), **NOTHING)
            continue
        colour, whole = _colour(c, metric), c.scenario == ALL
        if not math.isnan(c.low):
            axes.plot([c.low / size, c.high / size], [y, y], color=colour, lw=2.4 if whole else 1.6)
        filled = c.verdict in DECIDED
        axes.plot(
            c.difference / size, y, "D" if whole else "o", color=colour, ms=6,
            markerfacecolor=colour if filled else "white",
        )  # fmt: skip
    reach = 1.08 * max(ends, default=1.0) / size
    axes.set_xlim(-reach, reach)
    axes.set_title(metric.name, fontsize="medium")
    axes.set_xlabel(f"{unit or 'difference'}{_sides(metric)}", fontsize="small")
    axes.tick_params(labelsize="small", left=False)


def _sides(metric: Metric) -> str:
    """Return the label of the better navigator on each side of 0."""
    if metric.better is None:
        return ""
    among = f"\n{ARRIVALS}" if metric.conditional else ""
    left, right = ("B", "A") if metric.better == "higher" else ("A", "B")
    return f"\n← {left} better   {right} better →{among}"


def _colour(c: Comparison, metric: Metric) -> str:
    """Return blue if the first navigator is better, red if it is worse, grey for a tie."""
    if c.verdict not in DECIDED:
        return GREY
    if metric.better is None:
        return "0.2"
    return BLUE if c.verdict == "better" else RED


def _legend(duel: Duel) -> str:
    family = max(c.family for c in duel.comparisons)
    unequal = " Granted different rehearsals: not as equals." if _unequal(duel) else ""
    return (
        f"Mean paired difference and its 95 % interval. Filled: a difference after Holm over"
        f" {family}; hollow: a tie, or too few worlds.{unequal}"
    )


def _unequal(duel: Duel) -> bool:
    return any(c.verdict == "not as equals" for c in duel.comparisons)
