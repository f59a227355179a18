"""Draw the pictures of robots: ``python docs/make_robot_pictures.py``.

`images/robots.png` shows the four scenarios of the family `robots`, each with another robot.
`images/bodies.png` shows the bodies of all robots that ship, at one scale. Needs
``benchnav[plan,view]``.
"""

from pathlib import Path
from typing import Any

import matplotlib
from matplotlib import pyplot
from matplotlib.patches import FancyArrow, Polygon
from shapely import MultiPoint

import benchnav
from benchnav.drawing.palette import INK
from benchnav.scenario.robots.registry import find_robot, names
from benchnav.viewer.scene_figure import aspect, draw_episode

IMAGES = Path(__file__).parent / "images"
NAVIGATOR = "visibility+dwa"
WORLDS = (  # scenario, robot, test seed
    ("doorway", "spot", 1),
    ("yard", "jackal", 2),
    ("turnaround", "hunter", 1),
    ("plaza", "turtlebot4", 1),
)
WIDTH = 11.0  # [inch] of a picture
HEAD = 0.3  # [inch] above a row
GAP = 0.25  # [m] between bodies
BODY, EDGE = "#cfe3f5", "#1f5f99"
COLOURS = 96  # in a file, which keeps it small


def save(figure: Any, name: str) -> None:
    """Write `images/NAME.png` with few colours."""
    from PIL import Image

    path = IMAGES / f"{name}.png"
    figure.savefig(path, facecolor="white")
    Image.open(path).convert("RGB").quantize(COLOURS).save(path, optimize=True)


def draw_family() -> None:
    """Draw one world of each scenario, and the path of every agent."""
    episodes = []
    for scenario, robot, seed in WORLDS:
        world = benchnav.load_scenario(f"robots/{scenario}", robot=robot).world(seed=seed)
        episodes.append(benchnav.simulate(world, NAVIGATOR).record)
    ratios = [aspect(e.world) for e in episodes]
    high = HEAD + 0.95 * WIDTH / sum(ratios)
    figure = pyplot.figure(figsize=(WIDTH, high), dpi=110)
    row = figure.subplots(1, len(ratios), width_ratios=ratios)
    figure.subplots_adjust(0.008, 0.02, 0.992, 1.0 - HEAD / high, 0.025)
    for axes, (scenario, robot, _), episode in zip(row, WORLDS, episodes, strict=True):
        draw_episode(axes, episode)
        axes.set_title(f"{scenario}, {robot}", fontsize=9.5, color=INK, pad=4)
    save(figure, "robots")


def extent(keys: Any) -> tuple[float, float]:
    """Return length and width [m] of a robot."""
    shape = keys.get("footprint")
    if shape is None:
        return 2.0 * keys["radius"], 2.0 * keys["radius"]
    return shape["length"], shape["width"]


def draw_body(axes: Any, keys: Any, x: float) -> None:
    """Draw a body whose rear is at ``x``, with its heading to the right."""
    length, width = extent(keys)
    corner = (
        keys["radius"] if "radius" in keys else keys["footprint"].get("corner_radius", width / 2)
    )
    x_inner, y_inner = (x + corner, x + length - corner), (corner - width / 2, width / 2 - corner)
    inner = MultiPoint([(px, py) for px in x_inner for py in y_inner]).convex_hull
    outline = inner.buffer(corner, 32).exterior.coords
    axes.add_patch(Polygon(outline, facecolor=BODY, edgecolor=EDGE, linewidth=1.2))
    arrow = {"width": 0.008, "head_width": 0.05, "length_includes_head": True, "color": EDGE}
    axes.add_patch(FancyArrow(x + length / 2, 0.0, 0.45 * length, 0.0, **arrow))


def draw_bodies() -> None:
    """Draw all bodies side by side, from the shortest to the longest."""
    robots = sorted(((find_robot(n).keys, n) for n in names()), key=lambda each: extent(each[0]))
    half = len(robots) - 4
    figure, rows = pyplot.subplots(2, 1, figsize=(WIDTH, 3.9), dpi=110)
    for axes, part in zip(rows, (robots[:half], robots[half:]), strict=True):
        x = 0.0
        for keys, name in part:
            length = max(extent(keys)[0], 0.45)
            left = x + (length - extent(keys)[0]) / 2
            draw_body(axes, keys, left)
            axes.text(x + length / 2, -0.52, name, ha="center", fontsize=8.5, color=INK)
            x += length + GAP
        axes.set_xlim(-0.1, 5.6)
        axes.set_ylim(-0.6, 0.42)
        axes.set_aspect("equal")
        axes.axis("off")
    rows[0].plot([4.9, 5.4], [0.3, 0.3], color=INK, linewidth=2)
    rows[0].text(5.15, 0.34, "0.5 m", ha="center", fontsize=8.5, color=INK)
    figure.subplots_adjust(0.01, 0.01, 0.99, 0.99, hspace=0.02)
    save(figure, "bodies")


def main() -> None:
    """Write both pictures."""
    matplotlib.use("Agg")
    draw_bodies()
    draw_family()


if __name__ == "__main__":
    main()
