"""Draws the pictures of the documentation: ``python docs/make_pictures.py``.

`images/worlds.png` shows one world of each of six scenarios, and the path of every agent with
`ompl-orca`; `images/groups.png` shows groups that meet, with `orca`, one colour a group;
`images/replay.gif` is the moving picture of the README. Needs ``benchnav[plan,view]``.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib import pyplot

from benchnav.drawing.palette import INK
from benchnav.episode.episode import Episode
from benchnav.generation.build import build
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find
from benchnav.viewer.animation import save_gif
from benchnav.viewer.scene_figure import aspect, draw_episode

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
MOVING = ("orca", "recurrent-ppo-vo")  # the navigators of the moving picture
WIDTH = 11.0  # [inch] of the picture
HEAD = 0.3  # [inch] above each row
COLOURS = 128  # in the file, which keeps it small
PAPER = "#ffffff"


def episode_of(name: str, seed: int, navigator: str = NAVIGATOR) -> Episode:
    """What happens in the world of a test seed of a scenario."""
    scenario = find(name)
    who = Assignment(scenario.identity, scenario.hash, "test", "known", navigator, navigator)
    ((episode,),) = rollout(who, [(seed, build(scenario, "test", seed))])
    return episode


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
        draw_episode(axes, episode)
        axes.set_title(caption(name, episode), fontsize=9.5, color=INK, pad=4)


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
    save_gif([episode_of("leaders/dynamic", 3, name) for name in MOVING], IMAGES / "replay.gif")


if __name__ == "__main__":
    main()
