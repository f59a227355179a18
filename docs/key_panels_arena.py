"""Panels of walls, shapes, obstacles and motion laws, for ``make_key_pictures.py``."""

import math
from typing import Any

from key_sketch import (
    AGENT,
    INK,
    MOVER,
    PAPER,
    STATIC,
    VIEW,
    WALL,
    Panel,
    area,
    arrow,
    dimension,
    disc,
    dot,
    label,
    line,
)
from matplotlib.patches import Rectangle, Wedge


def wall_panels() -> list[Panel]:
    """Return the panels of walls and layouts."""

    def border(axes: Any) -> None:
        x0, y0, x1, y1 = VIEW
        axes.add_patch(Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, color=WALL, linewidth=5))

    def wall(axes: Any) -> None:
        for x in (-2.5, 2.0):
            dot(axes, (x, 0.0), MOVER)
            axes.plot([x, x + 2.0], [0.0, 0.0], color=INK, linewidth=0.7, linestyle=":", zorder=3)
        axes.add_patch(Wedge((2.0, 0.0), 1.4, 0, 40, width=0.03, color=INK, zorder=6))
        label(axes, (4.05, 0.55), "heading")
        label(axes, (0.0, -2.4), "at: a wall at each of these points", MOVER)

    return [
        Panel(
            "maze: columns 6, rows 4, loops 0.2",
            border,
            "layout: {type: maze, columns: 6, rows: 4, thickness: 0.2, loops: 0.2}\n",
        ),
        Panel(
            "rooms: columns 3, rows 2, door 1",
            border,
            "layout: {type: rooms, columns: 3, rows: 2, door: 1, thickness: 0.2}\n",
        ),
        Panel(
            "walls",
            wall,
            "walls:\n  - {shape: {type: box, width: 3, depth: 0.4}, heading: 0.7,"
            " at: [[-2.5, 0], [2, 0]]}\n",
        ),
    ]


def shape_panels() -> list[Panel]:
    """Return the panels of shapes."""

    def walls(shape: str) -> str:
        return f"walls:\n  - {{shape: {shape}}}\n"

    def box(axes: Any) -> None:
        dimension(axes, (-2.5, 1.3), (2.5, 1.3), "width")
        dimension(axes, (3.0, -1.0), (3.0, 1.0), "depth", (0.95, 0.0))
        dot(axes, (0.0, 0.0), MOVER)
        label(axes, (0.0, -0.5), "origin", MOVER)

    def round_(axes: Any) -> None:
        dimension(axes, (0.0, 0.0), (2.0, 0.0), "radius")
        dot(axes, (0.0, 0.0), MOVER)

    def corners(axes: Any) -> None:
        for k, p in enumerate(((-3, -2), (3, -2), (3, 0), (0, 0), (0, 2), (-3, 2)), 1):
            dot(axes, p, MOVER)
            label(axes, (p[0] + 0.4, p[1] + 0.35), str(k), MOVER)
        label(axes, (2.2, 1.2), "points")

    def along(axes: Any) -> None:
        for k, p in enumerate(((-3.5, -1.5), (-1, 1.2), (1.5, 1.2), (3.5, -1.5)), 1):
            dot(axes, p, MOVER)
            label(axes, (p[0], p[1] - 0.75), str(k), MOVER)
        dimension(axes, (0.3, 1.0), (0.3, 1.4), "thickness", (0.0, 0.6))

    def mesh(axes: Any) -> None:
        area(axes, (-5.0, -1.6, 5.0, 1.2))
        axes.add_patch(Rectangle((-2.5, 0.2), 5.0, 0.4, color=WALL, zorder=2))
        for x in (-2.4, 2.1):
            axes.add_patch(Rectangle((x, -2.0), 0.3, 2.2, color=WALL, zorder=2))
        axes.add_patch(Rectangle((-0.9, 1.9), 1.8, 0.5, color=STATIC, zorder=2))
        label(axes, (2.7, 2.2), "above: ignored")
        dimension(axes, (-4.2, -1.6), (-4.2, 1.2), "band", (0.8, 0.6))
        line(axes, (-5.0, -2.0), (5.0, -2.0), colour=INK)
        label(axes, (0.0, -2.6), "side view, floor at height 0")

    def cells(axes: Any) -> None:
        blocked = {(1, 1), (1, 2), (2, 2), (5, 1), (5, 2), (5, 3), (4, 3)}
        for i in range(8):
            for j in range(5):
                colour = WALL if (i, j) in blocked else STATIC if i == 7 else PAPER
                corner = (-4.0 + i, -2.6 + j)
                style: Any = {"facecolor": colour, "edgecolor": "#c9d2d8", "linewidth": 0.8}
                axes.add_patch(Rectangle(corner, 1, 1, **style))
        dimension(axes, (-1.0, 2.6), (0.0, 2.6), "cell", (1.0, 0.1))
        label(axes, (3.5, 2.75), "unknown")
        label(axes, (-1.5, -2.1), "blocked: dark")

    return [
        Panel("{type: box}", box, walls("{type: box, width: 5, depth: 2}")),
        Panel("{type: disc}", round_, "static:\n  - {shape: {type: disc, radius: 2}, at: [0, 0]}"),
        Panel(
            "{type: polygon}",
            corners,
            walls("{type: polygon, points: [[-3, -2], [3, -2], [3, 0], [0, 0], [0, 2], [-3, 2]]}"),
        ),
        Panel(
            "{type: polyline}",
            along,
            walls(
                "{type: polyline, thickness: 0.4,"
                " points: [[-3.5, -1.5], [-1, 1.2], [1.5, 1.2], [3.5, -1.5]]}"
            ),
        ),
        Panel("{type: mesh}", mesh),
        Panel("{type: occupancy}", cells),
    ]


def obstacle_panels() -> list[Panel]:
    """Return the panels of static and dynamic obstacles."""

    def gap(axes: Any) -> None:
        line(axes, (-4.5, -1.6), (-4.5, 1.6), (4.5, 1.6), (4.5, -1.6), (-4.5, -1.6), colour=AGENT)
        label(axes, (0.0, 2.1), "region of the centres", AGENT)
        disc(axes, (-2.2, 0.0), 0.7, STATIC)
        disc(axes, (0.8, 0.3), 0.8, STATIC)
        dimension(axes, (-1.5, 0.0), (0.0, 0.1), "gap")
        axes.add_patch(Rectangle((3.2, -3.2), 0.4, 3.6, color=WALL))
        dimension(axes, (1.6, 0.3), (3.2, 0.3), "gap", (0.0, -0.4))

    def moved(axes: Any) -> None:
        for old, new in (((-3.4, -1.2), (-1.6, 1.2)), ((0.6, 1.0), (3.4, -0.1))):
            disc(axes, old, 0.65, STATIC, fill=False)
            disc(axes, new, 0.65, STATIC)
            dimension(axes, old, new, "moved", (0.3, 0.45))
        label(axes, (0.0, -2.5), "dashed: in the stale map; grey: in the episode")

    def swept(axes: Any) -> None:
        axes.add_patch(Rectangle((-3.2, -0.6), 6.4, 1.2, color="#f9dfcf"))
        disc(axes, (-1.8, 0.0), 0.6, MOVER)
        line(axes, (-2.6, 0.0), (2.6, 0.0))
        axes.add_patch(Rectangle((-4.0, -2.5), 8.0, 0.5, color=WALL))
        dimension(axes, (1.0, -2.0), (1.0, -0.6), "gap", (0.7, 0.0))
        label(axes, (0.0, 1.2), "swept path of a dynamic obstacle", MOVER)

    return [Panel("static: gap", gap), Panel("static: moved", moved), Panel("dynamic: gap", swept)]


def law_panels() -> list[Panel]:
    """Return the panels of motion laws; every obstacle is drawn where it is at t = 0."""

    def law(text: str) -> str:
        at = "" if "recorded" in text else ", at: [0, 0]"
        return f"dynamic:\n  - {{shape: {{type: disc, radius: 0.4}}, law: {{{text}}}{at}}}\n"

    def back(axes: Any) -> None:
        c, s = math.cos(0.4), math.sin(0.4)
        line(axes, (-3 * c, -3 * s), (3 * c, 3 * s))
        dimension(
            axes, (-3 * c + 0.4, -3 * s - 0.9), (3 * c + 0.4, 3 * s - 0.9), "length", (0.7, -0.4)
        )
        dot(axes, (0.0, 0.0))
        label(axes, (-0.2, 0.5), "origin")
        axes.plot([0.0, 4.5], [0.0, 0.0], color=INK, linewidth=0.7, linestyle=":")
        axes.add_patch(Wedge((0.0, 0.0), 2.0, 0, math.degrees(0.4), width=0.03, color=INK))
        label(axes, (3.6, 0.6), "direction")

    def loop(axes: Any) -> None:
        points = [(-3.0, -1.8), (3.0, -1.8), (1.0, 1.8), (-3.0, -1.8)]
        line(axes, *points)
        for p in points[:3]:
            dot(axes, p)
        label(axes, (1.0, 2.4), "points, relative to the origin")
        dot(axes, (0.0, 0.0))
        label(axes, (0.0, -0.5), "origin")
        arrow(axes, (-0.5, -1.8), (0.6, -1.8), MOVER)

    def circle(axes: Any) -> None:
        disc(axes, (0.0, 0.0), 2.2, MOVER, fill=False)
        dot(axes, (0.0, 0.0))
        label(axes, (0.0, -0.5), "origin")
        dimension(axes, (0.0, 0.0), (-2.2, 0.0), "radius", (0.0, 0.4))
        arrow(axes, (2.08, 0.7), (1.65, 1.45), MOVER)

    def recorded(axes: Any) -> None:
        points = [(-3.5, -1.2), (-1.5, 0.6), (0.8, 0.3), (3.2, 1.6)]
        line(axes, *points)
        for time, p in zip((0, 2, 4, 7), points, strict=True):
            dot(axes, p)
            label(axes, (p[0], p[1] - 0.65), f"t = {time} s")
        label(axes, (0.0, 2.6), "points: [t, x, y]")

    return [
        Panel(
            "{type: back-and-forth}",
            back,
            law("type: back-and-forth, length: 6, speed: 1, direction: 0.4, phase: 0.05"),
        ),
        Panel(
            "{type: waypoint-loop}",
            loop,
            law(
                "type: waypoint-loop, speed: 1, phase: 0.12,"
                " points: [[-3, -1.8], [3, -1.8], [1, 1.8]]"
            ),
        ),
        Panel("{type: circle}", circle, law("type: circle, radius: 2.2, speed: 1, phase: 0.0")),
        Panel(
            "{type: recorded-track}",
            recorded,
            law(
                "type: recorded-track,"
                " points: [[0, -3.5, -1.2], [2, -1.5, 0.6], [4, 0.8, 0.3], [7, 3.2, 1.6]]"
            ),
        ),
    ]
