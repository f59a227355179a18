"""Draw the picture of people.md: ``python docs/make_people_picture.py``.

`images/people.png` shows one episode in each scenario of the family `people`. Needs
``benchnav[plan,view]``.
"""

from pathlib import Path

import matplotlib
from matplotlib import pyplot
from PIL import Image

import benchnav
from benchnav.drawing.palette import INK
from benchnav.viewer.scene_figure import draw_episode

IMAGES = Path(__file__).parent / "images"
NAVIGATOR = "visibility+mppi"
WORLDS = (  # scenario, people in each direction who see the robot, and who do not
    ("corridor", 40, 10),
    ("crossing", 20, 5),
    ("station-hall", 20, 5),
)
SEED = 1  # of the test split
PLACES = ((0.01, 0.69, 0.98, 0.28), (0.01, 0.01, 0.40, 0.63), (0.42, 0.01, 0.57, 0.63))
COLOURS = 96  # in a file, which keeps it small


def main() -> None:
    """Run a navigator in one world of each scenario, and draw the ways of all agents."""
    matplotlib.use("Agg")
    figure = pyplot.figure(figsize=(11.0, 7.0), dpi=110)
    for (scenario, reactive, unaware), place in zip(WORLDS, PLACES, strict=True):
        axes = figure.add_axes(place)
        chosen = f"people/{scenario}:reactive={reactive},unaware={unaware}"
        world = benchnav.load_scenario(chosen).world(seed=SEED)
        draw_episode(axes, benchnav.simulate(world, NAVIGATOR, salt="00").record)
        axes.set_title(scenario, fontsize=10, color=INK, pad=4)
    path = IMAGES / "people.png"
    figure.savefig(path, facecolor="white")
    Image.open(path).convert("RGB").quantize(COLOURS).save(path, optimize=True)


if __name__ == "__main__":
    main()
