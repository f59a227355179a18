"""Draws the pictures of the documentation: ``python docs/make_pictures.py``.

`images/worlds.png` shows one world of each of six scenarios, and the way that every
evaluated agent took in it when `ompl-orca` drove it; `images/groups.png` groups that meet,
driven by `orca`, a colour for each. Needs ``benchnav[plan,view]``.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib import pyplot
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle, PathPatch
from matplotlib.path import Path as Outline

from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import World
from benchnav.arrays import FloatArray
from benchnav.episode.episode import Episode, Status
from benchnav.generation.build import build
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find

IMAGES = Path(__file__).parent / "images"
NAVIGATOR = "ompl-orca"
ROWS = (  # of (scenario, test seed)
    (("leaders/dynamic", 4), ("circle/antipodal", 0), ("maze/grid", 2)),
    (("trap/u", 1), ("bottleneck/door", 0), ("office/rooms", 1)),
)
GROUPS = (
    (("groups/diagonal", 0), ("groups/crossing-four", 0)),
    (("groups/bottleneck-opposed", 0),),
)
WIDTH = 11.0  # [inch] of the picture
HEAD = 0.3  # [inch] above each row
COLOURS = 128  # in the file, which keeps it small
PAPER, INK, WALL, FURNITURE, MOVER = "#ffffff", "#22303c", "#36454f", "#b4bec6", "#e07a3f"
MARGIN = 0.012  # of an arena's width: how thick the wall along its bounds is drawn


def episode_of(name: str, seed: int, navigator: str = NAVIGATOR) -> Episode:
    """What happens in the world of a test seed of a scenario."""
    scenario = find(name)
    who = Assignment(scenario.identity, scenario.hash, "test", "known", navigator, navigator)
    ((episode,),) = rollout(who, [(seed, build(scenario, "test", seed))])
    return episode


def draw(axes: Any, episode: Episode) -> None:
    """One world, and who went where."""
    world = episode.world
    x0, y0, x1, y1 = world.bounds
    rim = MARGIN * max(x1 - x0, y1 - y0)
    frame = (x0 - rim, y0 - rim, x1 + rim, y1 + rim)
    for solid in world.solids:
        colour = WALL if solid.kind == Kind.WALL else FURNITURE
        axes.add_patch(_patch(solid, frame, color=colour, linewidth=0.4))
    _draw_movers(axes, episode, frame)
    which = world.agents.team if len(world.teams) > 1 else np.arange(len(world.agents))
    colours = pyplot.get_cmap("turbo")(np.linspace(0.05, 0.92, int(which.max()) + 1))
    for agent, k in enumerate(which):
        _draw_way(axes, episode, agent, colours[k])
    axes.set(xlim=frame[::2], ylim=frame[1::2], aspect="equal", xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(False)


def _patch(solid: Solid, frame: tuple[float, float, float, float], **style: Any) -> Any:
    if solid.is_disc:
        return Circle(solid.center, solid.radius, **style)
    loops = list(solid.loops)
    if sum(map(_area, loops)) < 0.0:  # what lies outside the arena
        x0, y0, x1, y1 = frame
        loops.append(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]))
    return PathPatch(Outline.make_compound_path(*(_closed(loop) for loop in loops)), **style)


def _closed(loop: FloatArray) -> Outline:
    return Outline(np.vstack([loop, loop[:1]]), closed=True)


def _area(loop: FloatArray) -> float:
    x, y = loop.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _draw_movers(axes: Any, episode: Episode, frame: tuple[float, float, float, float]) -> None:
    for m, body in enumerate(episode.world.bodies):
        way = episode.body_position[:, m]
        for share, alpha in ((0.0, 0.9), (0.5, 0.35), (1.0, 0.15)):
            place = way[int(share * min(len(way) - 1, 25))]
            shape = body.solid.moved(place)
            axes.add_patch(_patch(shape, frame, color=MOVER, alpha=alpha, linewidth=0))
        axes.plot(*way.T, color=MOVER, linewidth=0.8, linestyle=(0, (1, 2)), zorder=1.5)


def _draw_way(axes: Any, episode: Episode, agent: int, colour: Any) -> None:
    """A line that grows stronger on its way, the body at its start, a ring at its goal.

    A cross stands where somebody's way ended who did not arrive.
    """
    agents = episode.world.agents
    on_way = episode.status[:, agent] == Status.ACTIVE
    last = min(int(on_way.sum()), len(on_way) - 1)
    points = episode.position[: last + 1, agent]
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    alpha = np.linspace(0.35, 1.0, max(len(pieces), 1))
    lines = [(*colour[:3], a) for a in alpha]
    axes.add_collection(LineCollection(list(pieces), colors=lines, linewidths=1.3, zorder=3))
    radius = float(agents.radius[agent])
    axes.add_patch(Circle(agents.start[agent], radius, color=colour, linewidth=0, zorder=4))
    ring = {"fill": False, "edgecolor": colour, "linewidth": 1.2, "zorder": 4}
    axes.add_patch(Circle(agents.goal[agent], max(radius, 0.35), **ring))
    if not np.isfinite(episode.arrival[agent]):
        axes.plot(*points[-1], marker="x", color=colour, markersize=8, mew=2, zorder=5)


def caption(name: str, episode: Episode) -> str:
    """Name, and how many arrived when."""
    came = np.isfinite(episode.arrival)
    last = float(np.nanmax(episode.arrival)) if came.any() else float("nan")
    return f"{name}   {int(came.sum())} of {len(came)} arrived in {last:.0f} s"


def draw_row(figure: Any, worlds: Sequence[tuple[str, int]], navigator: str = NAVIGATOR) -> None:
    """Worlds side by side, all as high as the row is."""
    episodes = [episode_of(name, seed, navigator) for name, seed in worlds]
    ratios = [aspect(e.world) for e in episodes]
    row = figure.subplots(1, len(worlds), width_ratios=ratios, squeeze=False)[0]
    high = figure.bbox.height / figure.dpi
    figure.subplots_adjust(0.008, 0.02, 0.992, 1.0 - HEAD / high, 0.025)
    for axes, (name, _), episode in zip(row, worlds, episodes, strict=True):
        draw(axes, episode)
        axes.set_title(caption(name, episode), fontsize=9.5, color=INK, pad=4)


def aspect(world: World) -> float:
    """Width of a world's bounds over their height."""
    x0, y0, x1, y1 = world.bounds
    return (x1 - x0) / (y1 - y0)


def draw_picture(
    name: str, rows: Sequence[Sequence[tuple[str, int]]], navigator: str = NAVIGATOR
) -> None:
    """Writes `images/NAME.png`."""
    from PIL import Image

    heights = [
        HEAD + 0.95 * WIDTH / sum(aspect(build(find(name), "test", seed)) for name, seed in row)
        for row in rows
    ]
    figure = pyplot.figure(figsize=(WIDTH, sum(heights)), dpi=110, facecolor=PAPER)
    parts: Any = figure.subfigures(len(rows), 1, height_ratios=heights)
    for part, worlds in zip(np.atleast_1d(parts), rows, strict=True):
        draw_row(part, worlds, navigator)
    IMAGES.mkdir(exist_ok=True)
    path = IMAGES / f"{name}.png"
    figure.savefig(path, facecolor=PAPER)
    Image.open(path).convert("RGB").quantize(COLOURS).save(path, optimize=True)


def main() -> None:
    """Writes all pictures."""
    matplotlib.use("Agg")
    draw_picture("worlds", ROWS)
    draw_picture("groups", GROUPS, "orca")


if __name__ == "__main__":
    main()
