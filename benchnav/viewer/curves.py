"""Curves as a picture: a panel for each scenario, condition and role, a line per navigator."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle, product, zip_longest
from typing import TYPE_CHECKING

import numpy as np

from benchnav.leaderboard.rendering.curve_table import titled
from benchnav.leaderboard.statistics.curve import HORIZON, Point, panels
from benchnav.scenario.terms import TRACKS
from benchnav.viewer.picture import COLOURS, DASHES, blank, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ABREAST = 3  # panels side by side if there is one track
WIDTH, HEIGHT, LEGEND = 3.6, 2.9, 0.25  # [inch] of a panel, and of a line of the legend


def draw_curves(points: Sequence[Point]) -> Figure:
    """Draw means and their 95 % intervals, with a column per track if there are several.

    Raises MissingExtraError if matplotlib is not installed.
    """
    rows = _rows(list(panels(points)))
    across, down = max(map(len, rows)), len(rows)
    names = sorted({p.navigator for p in points})
    lines = -(-len(names) // across)
    figure = blank(WIDTH * across + 0.4, HEIGHT * down + LEGEND * lines + 0.4)
    grid = figure.subplots(down, across, sharey=True, squeeze=False)
    style = dict(zip(names, cycle((c, d) for d, c in product(DASHES, COLOURS)), strict=False))
    several_roles = len({p.role for p in points}) > 1
    for row, axes_of_row in zip(rows, grid, strict=True):
        for axes, panel in zip_longest(axes_of_row, row):
            if panel:
                _panel(axes, panel, style, several_roles)
            else:
                axes.set_visible(False)
        axes_of_row[0].set_ylabel(_named(points[0].metric, points[0].unit))
    handles = {line.get_label(): line for axes in grid.flat for line in axes.lines}
    figure.legend(
        [handles[name] for name in names], names, loc="outside lower center", ncols=across,
        frameon=False,
    )  # fmt: skip
    return figure


def _rows(every: list[list[Point]]) -> list[list[list[Point] | None]]:
    """Return the grid of panels: a row for each scenario if there are several tracks."""
    tracks = sorted({panel[0].track for panel in every}, key=TRACKS.index)
    if len(tracks) == 1:
        return [list(every[k : k + ABREAST]) for k in range(0, len(every), ABREAST)]
    rows: dict[tuple[object, ...], list[list[Point] | None]] = {}
    for panel in every:
        p = panel[0]
        key = p.split, p.scenario, p.perception, p.role, p.horizon, p.dt, p.rehearsal
        rows.setdefault(key, [None] * len(tracks))[tracks.index(p.track)] = panel
    return list(rows.values())


def _panel(axes: Axes, points: list[Point], style: dict[str, tuple[str, str]], role: bool) -> None:
    plain(axes)
    for name in sorted({p.navigator for p in points}):
        curve = [p for p in points if p.navigator == name]
        x, value, low, high = (
            np.array([getattr(p, key) for p in curve]) for key in ("x", "value", "low", "high")
        )
        colour, dashes = style[name]
        marker = "" if curve[0].axis == HORIZON else "o"
        axes.plot(x, value, dashes, color=colour, marker=marker, ms=4, lw=1.7, label=name)
        axes.fill_between(x, low, high, color=colour, alpha=0.13, lw=0)
    axes.set_title(titled(points, role).replace(", ", "\n", 1), fontsize="small")
    axes.set_xlabel(_named(points[0].axis, points[0].axis_unit))
    if points[0].metric == "success":
        axes.set_ylim(-0.03, 1.03)


def _named(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name
