"""Draws how bodies follow one planar velocity: ``python docs/make_dynamics_picture.py``."""

import math
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib import pyplot

from benchnav.arrays import FloatArray
from benchnav.drawing.palette import INK, NAVIGATORS, PAPER
from benchnav.generation.build import build
from benchnav.scenario.load import scenario_from_text
from benchnav.world.simulation import Simulation

IMAGE = Path(__file__).parent / "images" / "dynamics.png"
DECISIONS, DT = 25, 0.2
SLOW = "max_acceleration: 1, max_turn_acceleration: 4"
BODIES = {
    "holonomic": SLOW + ", dynamics: holonomic",
    "unicycle": SLOW + ", dynamics: unicycle",
    "differential-drive, reverse": SLOW + ", dynamics: {type: differential-drive,"
    " track_width: 0.6, max_wheel_speed: 1, reverse: true}",
    "ackermann": "max_acceleration: 1, dynamics: {type: ackermann, wheelbase: 0.4,"
    " max_steering_angle: 0.6, max_steering_rate: 1.5}",
}
AIMS = (0.25, 0.5, 0.75)  # of a half turn
SCENARIO = """
name: docs/dynamics
bounds: [-50, -50, 50, 50]
rules: {goal_tolerance: 0.01}
teams:
  - {name: one, radius: 0.2, max_speed: 1, heading: 0, KEYS,
     start: {type: points, points: [[0, 0]]}, goal: {type: points, points: [[40, -40]]}}
"""


def path(keys: str, aim: float) -> FloatArray:
    """Return the positions (T+1, 2) [m] of a body that receives one direction [rad]."""
    scenario = scenario_from_text(SCENARIO.replace("KEYS", keys), "dynamics")
    simulation = Simulation([build(scenario, "test", 0)])
    places = [simulation.position[0, 0].copy()]
    command = np.array([[[math.cos(aim), math.sin(aim)]]])
    for _ in range(DECISIONS):
        simulation.step(command, np.zeros((1, 1), np.bool_))
        places.append(simulation.position[0, 0].copy())
    return np.array(places)


def draw(axes: Any, aim: float) -> None:
    """Draw the paths of all bodies, and the velocity that they receive."""
    for (name, keys), colour in zip(BODIES.items(), NAVIGATORS, strict=False):
        places = path(keys, aim)
        axes.plot(*places.T, color=colour, lw=1.6, label=name)
        axes.plot(*places[::2].T, "o", color=colour, ms=3)
    tip = 1.2 * np.array([math.cos(aim), math.sin(aim)])
    style = {"arrowstyle": "-|>", "color": INK, "lw": 1.4, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", tip, (0.0, 0.0), arrowprops=style, zorder=5)
    axes.set_title(f"{180 * aim / math.pi:.0f}° to the left", color=INK, fontsize=10)
    axes.set_aspect("equal", adjustable="datalim")
    axes.tick_params(labelsize=8)
    axes.set_xlabel("x [m]", fontsize=8)


def main() -> None:
    """Write the picture."""
    matplotlib.use("Agg")
    figure, grid = pyplot.subplots(1, len(AIMS), figsize=(8.4, 3.6), dpi=110, facecolor=PAPER)
    for axes, share in zip(grid, AIMS, strict=True):
        draw(axes, share * math.pi)
    grid[0].set_ylabel("y [m]", fontsize=8)
    handles, labels = grid[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=4, frameon=False, fontsize=9)
    figure.subplots_adjust(0.07, 0.24, 0.99, 0.92, 0.16)
    figure.savefig(IMAGE, facecolor=PAPER)
    from PIL import Image

    Image.open(IMAGE).convert("RGB").quantize(64).save(IMAGE, optimize=True)


if __name__ == "__main__":
    main()
