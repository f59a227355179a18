"""Draw the pictures of scenario_keys.md: ``python docs/make_key_pictures.py``.

Each file `images/keys/GROUP.png` has a panel for each type of the group. The worlds in the
panels are built from the YAML text beside them, so they show what the keys do; dimensions are
drawn by hand. Needs ``benchnav[view]``.
"""

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib
from key_panels_arena import law_panels, obstacle_panels, shape_panels, wall_panels
from key_panels_team import (
    episode_panels,
    footprint_panels,
    goal_panels,
    region_panels,
    start_panels,
)
from key_sketch import PAPER, VIEW, Panel, draw_panel
from matplotlib import pyplot

IMAGES = Path(__file__).parent / "images" / "keys"
WIDTH = 8.4  # [inch] of a picture
COLOURS = 224  # in the file, which keeps it small


def draw_picture(name: str, panels: Sequence[Panel], columns: int) -> None:
    """Write `images/keys/NAME.png`."""
    from PIL import Image

    rows = math.ceil(len(panels) / columns)
    height = rows * (WIDTH / columns * (VIEW[3] - VIEW[1]) / (VIEW[2] - VIEW[0]) + 0.22)
    figure, grid = pyplot.subplots(
        rows, columns, figsize=(WIDTH, height), dpi=100, facecolor=PAPER, squeeze=False
    )
    figure.subplots_adjust(0.004, 0.012, 0.996, 1.0 - 0.22 / height, 0.025, 0.14)
    for axes in grid.flat[len(panels) :]:
        axes.set_visible(False)
    for axes, panel in zip(grid.flat, panels, strict=False):
        draw_panel(axes, panel)
    IMAGES.mkdir(parents=True, exist_ok=True)
    path = IMAGES / f"{name}.png"
    figure.savefig(path, facecolor=PAPER)
    pyplot.close(figure)
    Image.open(path).convert("RGB").quantize(COLOURS).save(path, optimize=True)


PICTURES: dict[str, tuple[Callable[[], list[Panel]], int]] = {
    "walls": (wall_panels, 3),
    "shapes": (shape_panels, 3),
    "obstacles": (obstacle_panels, 3),
    "laws": (law_panels, 2),
    "footprints": (footprint_panels, 3),
    "starts": (start_panels, 3),
    "goals": (goal_panels, 2),
    "regions": (region_panels, 3),
    "episode": (episode_panels, 3),
}


def main() -> None:
    """Write all pictures."""
    matplotlib.use("Agg")
    for name, (panels, columns) in PICTURES.items():
        draw_picture(name, panels(), columns)


if __name__ == "__main__":
    main()
