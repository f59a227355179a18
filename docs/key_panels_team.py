"""Panels of footprints, starts, goals, regions, sensors and rules, for ``make_key_pictures.py``."""

import math
from typing import Any

from key_sketch import (
    AGENT,
    GOAL,
    INK,
    MOVER,
    PAPER,
    REGION,
    STATIC,
    WALL,
    Panel,
    area,
    arrow,
    dimension,
    disc,
    dot,
    label,
    line,
    team,
)
from matplotlib.patches import Polygon, Rectangle, Wedge


def footprint_panels() -> list[Panel]:
    """Return the panels of footprints."""

    def body(footprint: str) -> str:
        return (
            f"teams:\n  - {{name: t, footprint: {footprint}, max_speed: 1, heading: 0,"
            " start: {type: points, points: [[0, 0]]}, goal: {type: points, points: [[4, 0]]}}\n"
        )

    def around(axes: Any, radius: float) -> None:
        disc(axes, (0.0, 0.0), radius, INK, fill=False)
        arrow(axes, (0.0, 0.0), (radius + 1.2, 0.0), PAPER if radius < 1.0 else MOVER)

    def round_(axes: Any) -> None:
        dimension(axes, (0.0, 0.0), (1.06, 1.06), "radius", (-0.7, 0.3))
        arrow(axes, (0.0, 0.0), (3.0, 0.0), MOVER)
        label(axes, (3.7, 0.0), "heading", MOVER)

    def capsule(axes: Any) -> None:
        around(axes, 2.0)
        dimension(axes, (-2.0, -1.3), (2.0, -1.3), "length", (0.0, -0.3))
        dimension(axes, (-1.2, -0.8), (-1.2, 0.8), "width", (0.75, 0.35))
        label(axes, (0.0, 2.6), "around it: the circle of `radius`")

    def box(axes: Any) -> None:
        around(axes, 2.087)
        dimension(axes, (-1.8, -1.6), (1.8, -1.6), "length", (0.0, -0.3))
        dimension(axes, (-1.3, -1.2), (-1.3, 1.2), "width", (0.75, 0.35))
        disc(axes, (1.4, 0.8), 0.4, PAPER, fill=False)
        label(axes, (3.2, 1.4), "corner_radius")

    return [
        Panel("{type: disc}", round_, body("{type: disc, radius: 1.5}"), starts=True),
        Panel(
            "{type: capsule}", capsule, body("{type: capsule, length: 4, width: 1.6}"), starts=True
        ),
        Panel(
            "{type: rounded-box}",
            box,
            body("{type: rounded-box, length: 3.6, width: 2.4, corner_radius: 0.4}"),
            starts=True,
        ),
    ]


def start_panels() -> list[Panel]:
    """Return the panels of starts."""

    def region(axes: Any) -> None:
        area(axes, (-4, -2, 4, 2))
        label(axes, (0.0, 2.6), "region; gaps ≥ separation")

    def circle(axes: Any) -> None:
        disc(axes, (0.0, 0.0), 2.4, INK, fill=False)
        dimension(axes, (0.0, 0.0), (1.7, 1.7), "radius", (-0.7, 0.2))
        label(axes, (0.0, -0.6), "center")
        dot(axes, (0.0, 0.0))
        label(axes, (3.75, 0.0), "angle 0")

    def grid(axes: Any) -> None:
        label(axes, (-3.0, -2.6), "origin")
        dimension(axes, (-1.5, -1.6), (0.0, -1.6), "spacing", (0.0, -0.6))
        label(axes, (0.4, 2.6), "columns: 5")

    def packed(axes: Any) -> None:
        area(axes, (-3.5, -2.6, 2.0, 2.6))
        dot(axes, (2.0, 0.0), MOVER)
        label(axes, (3.2, 0.0), "front", MOVER)
        label(axes, (-2.5, 2.2), "region")
        dimension(axes, (2.0, 0.0), (1.5, -0.86), "spacing", (1.2, -0.3))

    def points(axes: Any) -> None:
        for k, p in enumerate(((-3, 1.5), (-1, -1), (1.5, 1), (3, -1.5)), 1):
            label(axes, (p[0] + 0.55, p[1] + 0.35), str(k))

    def jitter(axes: Any) -> None:
        for x in (-3.0, -1.0, 1.0, 3.0):
            for y in (-1.0, 1.0):
                area(axes, (x - 0.5, y - 0.5, x + 0.5, y + 0.5))
        dimension(axes, (2.5, 1.75), (3.5, 1.75), "jitter")
        label(axes, (0.0, -2.4), "squares: possible centres")

    return [
        Panel(
            "{type: region}",
            region,
            team(
                "{type: region, region: {type: rectangle, bounds: [-4, -2, 4, 2]}, separation: 0.4}"
            ),
            starts=True,
        ),
        Panel("{type: circle}", circle, team("{type: circle, radius: 2.4}", count=9), starts=True),
        Panel(
            "{type: grid}",
            grid,
            team("{type: grid, origin: [-3, -1.6], columns: 5, spacing: 1.5}", count=13),
            starts=True,
        ),
        Panel(
            "{type: packed}",
            packed,
            team(
                "{type: packed, front: [2, 0], spacing: 1,"
                " region: {type: rectangle, bounds: [-3.5, -2.6, 2, 2.6]}}",
                count=14,
            ),
            starts=True,
        ),
        Panel(
            "{type: points}",
            points,
            team("{type: points, points: [[-3, 1.5], [-1, -1], [1.5, 1], [3, -1.5]]}", count=4),
            starts=True,
        ),
        Panel(
            "jitter (here of a grid)",
            jitter,
            team("{type: grid, origin: [-3, -1], columns: 4, spacing: 2, jitter: 1}", count=8),
            starts=True,
        ),
    ]


def goal_panels() -> list[Panel]:
    """Return the panels of goals: discs are starts, crosses goals."""
    left = "{type: points, points: [[-4, -2], [-4, -0.7], [-4, 0.7], [-4, 2]]}"

    def region(axes: Any) -> None:
        area(axes, (0.5, -2.5, 4.5, 2.5))
        label(axes, (3.6, 2.9), "region")

    def points(axes: Any) -> None:
        for k, y in enumerate((2.4, 0.8, -0.8, -2.4), 1):
            label(axes, (4.0, y), str(k), GOAL)
        for k, y in enumerate((-2.0, -0.7, 0.7, 2.0), 1):
            label(axes, (-4.6, y), str(k), AGENT)

    def antipodal(axes: Any) -> None:
        dot(axes, (0.0, 0.0), MOVER)
        label(axes, (0.0, -0.5), "center", MOVER)

    def shifted(axes: Any) -> None:
        label(axes, (0.0, 2.6), "by: [6, 1]")

    square = "{type: grid, origin: [-4, -2], columns: 2, spacing: 1}"
    slanted = "{type: points, points: [[-4, -2], [-3.4, 1.2], [0.8, 2.4]]}"
    return [
        Panel(
            "{type: region}",
            region,
            team(
                left, "{type: region, region: {type: rectangle, bounds: [0.5, -2.5, 4.5, 2.5]}}", 4
            ),
            starts=True,
            goals=True,
        ),
        Panel(
            "{type: points}",
            points,
            team(
                left,
                "{type: points, points: [[3.5, 2.4], [3.5, 0.8], [3.5, -0.8], [3.5, -2.4]]}",
                4,
            ),
            starts=True,
            goals=True,
        ),
        Panel("{type: antipodal}", antipodal, team(slanted, count=3), starts=True, goals=True),
        Panel(
            "{type: shifted}",
            shifted,
            team(square, "{type: shifted, by: [6, 1]}", 6),
            starts=True,
            goals=True,
        ),
    ]


def region_panels() -> list[Panel]:
    """Return the panels of regions; the dots are drawn from them."""

    def rectangle(axes: Any) -> None:
        axes.add_patch(Rectangle((-4, -2), 7, 4, color=REGION, zorder=0.5))
        label(axes, (-3.6, -2.6), "[xmin, ymin]")
        label(axes, (2.6, 2.6), "[xmax, ymax]")

    def round_(axes: Any) -> None:
        disc(axes, (0, 0), 2.5, REGION, zorder=0.5)
        dimension(axes, (0, 0), (2.5, 0), "radius")

    def ring(axes: Any) -> None:
        axes.add_patch(Wedge((0, 0), 2.8, 0, 360, width=1.5, color=REGION, zorder=0.5))
        dimension(axes, (0, 0), (1.3, 0), "inner")
        dimension(axes, (0, 0), (-2.4, -1.44), "outer", (0.3, -0.4))

    def points(axes: Any) -> None:
        for x, y in ((-3, 1), (0, -1.5), (2.5, 1.5)):
            disc(axes, (x, y), 0.35, REGION, zorder=0.5)
            dot(axes, (x, y), AGENT)

    def anywhere(axes: Any) -> None:
        area(axes, (-4.2, -2.4, 4.2, 2.4))
        dimension(axes, (-5, 0), (-4.2, 0), "margin", (0.9, 0.45))

    def drawn(region: str) -> str:
        return team(f"{{type: region, region: {region}}}", count=45, radius=0.07)

    return [
        Panel(
            "{type: rectangle}",
            rectangle,
            drawn("{type: rectangle, bounds: [-4, -2, 3, 2]}"),
            starts=True,
        ),
        Panel(
            "{type: disc}", round_, drawn("{type: disc, center: [0, 0], radius: 2.5}"), starts=True
        ),
        Panel(
            "{type: ring}",
            ring,
            drawn("{type: ring, center: [0, 0], inner: 1.3, outer: 2.8}"),
            starts=True,
        ),
        Panel("{type: points}", points),
        Panel("{type: anywhere}", anywhere, drawn("{type: anywhere, margin: 0.8}"), starts=True),
    ]


def episode_panels() -> list[Panel]:
    """Return the panels of sensors and rules."""

    def rays(axes: Any) -> None:
        for k in range(7):
            a = math.radians(-60 + 20 * k)
            line(axes, (-3.5, 0), (-3.5 + 3.4 * math.cos(a), 3.4 * math.sin(a)), colour=INK)
        disc(axes, (-3.5, 0), 0.4)
        axes.add_patch(Wedge((-3.5, 0), 2.4, -60, 60, width=0.06, color=MOVER, zorder=6))
        label(axes, (-1.7, 2.6), "fan", MOVER)
        label(axes, (2.6, -2.2), "thick: true: a ray is\nas wide as the agent")
        dimension(axes, (-3.5, 0), (-0.1, 0), "range", (2.4, 0))
        label(axes, (3.0, 2.7), "count: 7")

    def nearest(axes: Any) -> None:
        disc(axes, (0, 0), 2.9, INK, fill=False)
        disc(axes, (0, 0), 0.35)
        dimension(axes, (0, 0), (0, -2.9), "range", (0.8, -0.4))
        for k, p in enumerate(((1.1, 0.6), (-1.5, 0.9), (-1.0, -1.7)), 1):
            disc(axes, p, 0.3, MOVER)
            label(axes, (p[0], p[1] + 0.55), str(k))
        for p in ((2.0, 1.5), (4.1, -1.0)):
            disc(axes, p, 0.3, STATIC)
        label(axes, (-3.4, 2.7), "count: 3")

    def hidden(axes: Any) -> None:
        axes.add_patch(Polygon([(-0.2, -0.8), (5, -2.2), (5, 2.2), (-0.2, 0.8)], color="#e9eef1"))
        axes.add_patch(Rectangle((-0.5, -0.8), 0.3, 1.6, color=WALL))
        disc(axes, (-3.5, 0), 0.35)
        disc(axes, (2.0, 0), 0.35, STATIC)
        label(axes, (2.2, -0.8), "not sensed")
        label(axes, (-2.5, 2.5), "occlusion: true")

    def arrival(axes: Any) -> None:
        disc(axes, (1.5, 0), 1.6, GOAL, fill=False)
        axes.plot(1.5, 0, "x", color=GOAL, markersize=7, mew=1.6, zorder=6)
        disc(axes, (0.3, 0.6), 0.9)
        dimension(axes, (1.5, 0), (1.5, -1.6), "goal_tolerance", (1.9, 0.1))
        arrow(axes, (-4.2, 0.6), (0.3, 0.6), INK)
        dot(axes, (0.3, 0.6), PAPER)
        label(axes, (-2.0, -2.3), "arrived: the centre is inside")

    def contact(axes: Any) -> None:
        axes.add_patch(Rectangle((-5, -2.2), 10, 0.4, color=WALL))
        arrow(axes, (-4.2, 1.6), (-1.4, -1.2), INK)
        disc(axes, (-1.4, -1.3), 0.5)
        arrow(axes, (-0.9, -1.3), (2.6, -1.3), AGENT)
        label(axes, (1.9, -0.8), "slide", AGENT)
        label(axes, (1.2, 0.6), "stop: stands until its next decision")
        label(axes, (1.2, 1.7), "end: its attempt ends here")

    return [
        Panel("sensing: rays", rays),
        Panel("sensing: neighbours", nearest),
        Panel("sensing: occlusion", hidden),
        Panel("rules: goal_tolerance", arrival),
        Panel("rules: contact", contact),
    ]
