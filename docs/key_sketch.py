"""Labelled drawings of worlds and dimensions, for ``make_key_pictures.py``."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.patches import Circle, PathPatch, Polygon, Rectangle
from matplotlib.path import Path as Outline

from benchnav.arena.outline import outline, placed
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import World
from benchnav.generation.build import build
from benchnav.scenario.load import scenario_from_text
from benchnav.world.simulation import Simulation

PAPER, INK, WALL, STATIC, MOVER = "#ffffff", "#22303c", "#36454f", "#b4bec6", "#e07a3f"
AGENT, GOAL, REGION = "#1f6fb4", "#2a9d5c", "#dcecf7"
VIEW = (-5.0, -3.2, 5.0, 3.2)  # [m] that a panel shows
Xy = tuple[float, float]

ARENA = "name: docs/key\nbounds: [-5, -3.2, 5, 3.2]\nwalled: false\n"
NO_TEAM = """
teams:
  - {name: t, radius: 0.02, max_speed: 1, start: {type: points, points: [[-4.9, -3.1]]},
     goal: {type: points, points: [[-4.9, -3.1]]}}
"""


@dataclass(frozen=True)
class Panel:
    """A drawing: title, a world from YAML or none, and marks that are drawn over it."""

    title: str
    marks: Callable[[Any], None]
    yaml: str = ""
    starts: bool = False  # whether agents are drawn at their starts
    goals: bool = False  # whether goals are drawn too


def team(start: str, goal: str = "{type: antipodal}", count: int = 12, radius: float = 0.22) -> str:
    """Return the YAML of one team."""
    return (
        f"teams:\n  - {{name: t, count: {count}, radius: {radius}, max_speed: 1,"
        f" start: {start}, goal: {goal}}}\n"
    )


def dimension(axes: Any, a: Xy, b: Xy, text: str, beside: Xy = (0.0, 0.28)) -> None:
    """Draw a double arrow from ``a`` to ``b``, with its name ``beside`` the middle."""
    style = {"arrowstyle": "<->", "color": INK, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", b, a, arrowprops=style, zorder=8)
    label(axes, (0.5 * (a[0] + b[0]) + beside[0], 0.5 * (a[1] + b[1]) + beside[1]), text)


def arrow(axes: Any, a: Xy, b: Xy, colour: str = INK, bend: float = 0.0) -> None:
    """Draw an arrow from ``a`` to ``b``."""
    style = {"arrowstyle": "-|>", "color": colour, "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", b, a, arrowprops={**style, "connectionstyle": f"arc3,rad={bend}"}, zorder=7)


def label(axes: Any, at: Xy, text: str, colour: str = INK) -> None:
    """Write ``text``, centred."""
    box = {"facecolor": PAPER, "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
    style = {"ha": "center", "va": "center", "fontsize": 8, "color": colour, "bbox": box}
    axes.text(*at, text, zorder=9, **style)


def dot(axes: Any, at: Xy, colour: str = INK) -> None:
    """Mark a point."""
    axes.plot(*at, "o", color=colour, markersize=3.2, zorder=8)


def disc(axes: Any, at: Xy, radius: float, colour: str = AGENT, **style: Any) -> None:
    """Draw a disc, or with ``fill=False`` a dashed circle."""
    if style.get("fill", True):
        axes.add_patch(Circle(at, radius, color=colour, linewidth=0, **{"zorder": 4, **style}))
    else:
        line = {"edgecolor": colour, "linewidth": 1.0, "linestyle": (0, (3, 2)), "zorder": 5}
        axes.add_patch(Circle(at, radius, **{**line, **style}))


def area(axes: Any, box: Sequence[float], colour: str = REGION) -> None:
    """Shade a rectangle [xmin, ymin, xmax, ymax]."""
    x0, y0, x1, y1 = box
    axes.add_patch(Rectangle((x0, y0), x1 - x0, y1 - y0, color=colour, linewidth=0, zorder=0.5))


def line(axes: Any, *points: Xy, colour: str = MOVER) -> None:
    """Draw a dashed line."""
    axes.plot(*np.array(points).T, color=colour, linewidth=1.0, linestyle=(0, (3, 2)), zorder=3)


def solid(axes: Any, piece: Solid, colour: str, **style: Any) -> None:
    """Draw a wall or an obstacle."""
    if piece.is_disc:
        disc(axes, piece.center, piece.radius, colour, **style)
        return
    loops = [Outline(np.vstack([loop, loop[:1]]), closed=True) for loop in piece.loops]
    path = Outline.make_compound_path(*loops)
    axes.add_patch(PathPatch(path, color=colour, linewidth=0.5, **{"zorder": 2, **style}))


def draw_world(axes: Any, world: World, starts: bool, goals: bool) -> None:
    """Draw walls and obstacles of a world at t = 0, and optionally starts and goals."""
    for piece in world.solids:
        solid(axes, piece, WALL if piece.kind == Kind.WALL else STATIC)
    places = Simulation([world]).body_position[0]
    for body, place in zip(world.bodies, places, strict=False):
        solid(axes, body.solid.moved(place), MOVER)
    agents = world.agents
    for a, (start, goal) in enumerate(zip(agents.start, agents.goal, strict=True)):
        shape = outline(agents, a)
        if starts and shape is None:
            disc(axes, tuple(start), float(agents.radius[a]))
        elif starts:
            turned = placed(shape, start, float(agents.heading[a]))
            axes.add_patch(Polygon(turned, color=AGENT, linewidth=0, zorder=4))
        if goals:
            arrow(axes, tuple(start), tuple(goal), "#8fa1ad")
            axes.plot(*goal, "x", color=GOAL, markersize=5, mew=1.4, zorder=6)


def draw_panel(axes: Any, panel: Panel) -> None:
    """Draw a panel with its title."""
    if panel.yaml:
        teams = "" if "teams:" in panel.yaml else NO_TEAM
        scenario = scenario_from_text(ARENA + panel.yaml + teams, panel.title)
        draw_world(axes, build(scenario, "test", 0), panel.starts, panel.goals)
    panel.marks(axes)
    x0, y0, x1, y1 = VIEW
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal", xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set(color="#c9d2d8", linewidth=0.8)
    axes.set_title(panel.title, fontsize=8.5, color=INK, pad=3, family="monospace")
