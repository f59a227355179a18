"""Draw the frames and the noise of senses: ``python docs/make_senses_picture.py``.

`images/senses.png` shows one moment of one agent: the world, and what the agent perceives in its
odometry frame, first with errors of the own pose only, then with all. All places are read from the
simulator and from `benchnav.sensors.noise`. Needs ``benchnav[view]``.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from key_sketch import GOAL, INK, PAPER, WALL, arrow, label, solid
from matplotlib import pyplot
from matplotlib.patches import Circle

from benchnav.arena.noise import Noise, OdometryNoise
from benchnav.arena.solid import Kind, is_outside
from benchnav.arena.world import World
from benchnav.arrays import FloatArray
from benchnav.generation.build import build, noise_of
from benchnav.navigation.observation import Observation
from benchnav.navigation.observe import deciding, observe
from benchnav.scenario.load import scenario_from_text
from benchnav.scenario.scenario import Scenario
from benchnav.sensors.noise.noisy_senses import NoisySenses
from benchnav.world.simulation import Simulation

IMAGE = Path(__file__).parent / "images" / "senses.png"
OWN, OTHER, SENSED, FAINT = "#1f6fb4", "#7c5aa6", "#e07a3f", "#d5dce1"
DECISIONS = 14
COLOURS = 128  # in the file, which keeps it small
DRIFT = OdometryNoise(distance_noise=0.05, heading_noise=0.13)  # large, to be seen
KEY = 0
SCENARIO = """
name: docs/senses
bounds: [0, 0, 9, 6]
walls:
  - {shape: {type: box, width: 0.6, depth: 2.2}, at: [5.6, 4.9]}
  - {shape: {type: box, width: 1.6, depth: 0.5}, at: [5.2, 1.2]}
teams:
  - {name: own, radius: 0.3, max_speed: 1.0, heading: 0.35,
     start: {type: points, points: [[0.8, 1.6]]}, goal: {type: points, points: [[8.2, 3.0]]}}
  - {name: others, count: 3, radius: 0.3, max_speed: 1.0,
     start: {type: points, points: [[4.7, 2.6], [6.6, 2.3], [4.3, 5.2]]},
     goal: {type: points, points: [[0.6, 2.4], [0.6, 2.0], [0.6, 5.2]]}}
sensing:
  rays: {count: 25, fan: 4.2, range: 6, thick: false}
"""
NEEDS = frozenset({"rays", "neighbours", "edges"})


@dataclass(frozen=True, eq=False)
class Moment:
    """The world and the perception of its first agent after some decisions."""

    world: World
    simulation: Simulation
    seen: Observation


def scenario() -> Scenario:
    """Return the scenario of the picture."""
    return scenario_from_text(SCENARIO, "senses")


def moment(noise: Noise) -> Moment:
    """Return the moment after the first agent has driven ahead, with this noise."""
    world = build(scenario(), "test", 0)
    simulation, own = Simulation([world]), np.zeros((1, 1), np.int64)
    senses = NoisySenses(simulation, own, noise)
    senses.begin(np.arange(1), np.array([[KEY, 0]], np.uint64))
    twist = np.ones((1, simulation.A), np.bool_)
    command = np.zeros((1, simulation.A, 2))
    command[0, 0] = 0.9, 0.03
    for k in range(DECISIONS + 1):
        seen = observe(simulation, own, deciding(simulation, own), NEEDS, (None,), senses)
        if k < DECISIONS:
            simulation.step(command, twist)
    return Moment(world, simulation, seen)


def draw_solids(axes: Any, world: World, faint: bool) -> None:
    """Draw walls, or their numbers on the map."""
    for piece in world.solids:
        color = FAINT if faint else WALL
        if is_outside(piece):
            loop = np.vstack([piece.loops[0], piece.loops[0][:1]])
            axes.plot(*loop.T, color=color, linewidth=2.0, zorder=1)
        else:
            solid(axes, piece, color, zorder=1)


def draw_body(axes: Any, place: FloatArray, heading: float, color: str, *, ghost: bool) -> None:
    """Draw a disc with a nose; a ghost is an outline."""
    style: dict[str, Any] = {"color": color, "linewidth": 1.6, "fill": not ghost, "zorder": 6}
    axes.add_patch(Circle((place[0], place[1]), 0.3, **style))
    nose = place + 0.5 * np.array([math.cos(heading), math.sin(heading)])
    axes.plot(*zip(place, nose, strict=True), color=color, linewidth=1.6, zorder=7)


def draw_goal(axes: Any, goal: FloatArray) -> None:
    """Draw the goal as a cross in its tolerance."""
    axes.plot(*goal, "x", color=GOAL, markersize=8, mew=2.2, zorder=8)
    axes.add_patch(Circle((goal[0], goal[1]), 0.5, fill=False, color=GOAL, linewidth=1.0))


def world_panel(axes: Any, at: Moment) -> None:
    """Draw where everything is, and where the agent believes itself to be."""
    s, seen = at.simulation, at.seen
    draw_solids(axes, at.world, faint=False)
    for k in range(1, s.A):
        draw_body(axes, s.position[0, k], float(s.heading[0, k]), OTHER, ghost=False)
    draw_body(axes, s.position[0, 0], float(s.heading[0, 0]), OWN, ghost=False)
    draw_body(axes, seen.position[0, 0], float(seen.heading[0, 0]), SENSED, ghost=True)
    draw_goal(axes, s.goal[0, 0])
    x, y = s.position[0, 0]
    label(axes, (x, y + 0.85), "true pose", OWN)
    ex, ey = seen.position[0, 0]
    label(axes, (ex + 0.2, ey - 0.75), "estimate", SENSED)


def perception_panel(axes: Any, at: Moment, *, rays: bool) -> None:
    """Draw the numbers that the navigator receives."""
    seen = at.seen
    readings, near, edges = seen.rays, seen.neighbours, seen.edges
    if readings is None or near is None or edges is None:
        raise ValueError("The agent must have all three sensors.")
    own, heading = seen.position[0, 0], float(seen.heading[0, 0])
    draw_solids(axes, at.world, faint=True)
    for k in range(int(edges.count[0, 0])):
        axes.plot(
            *zip(edges.start[0, 0, k], edges.end[0, 0, k], strict=True), color=SENSED,
            linewidth=2.2, zorder=3,
        )  # fmt: skip
    for k in range(int(near.count[0, 0])):
        place = near.position[0, 0, k]
        axes.add_patch(Circle((place[0], place[1]), near.radius[0, 0, k], color=OTHER, zorder=5))
        if rays:
            arrow(axes, tuple(place), tuple(place + near.velocity[0, 0, k]), OTHER)
    if rays:
        for angle, distance, kind in zip(
            readings.angle, readings.distance[0, 0], readings.kind[0, 0], strict=True
        ):
            way = np.array([math.cos(heading + angle), math.sin(heading + angle)])
            end = own + distance * way
            lost = kind == Kind.NOTHING
            axes.plot(
                *zip(own, end, strict=True), color="#9fb4c4", linewidth=0.7,
                linestyle=":" if lost else "-", zorder=2,
            )  # fmt: skip
            if not lost:
                axes.plot(*end, ".", color=INK, markersize=3.5, zorder=4)
    draw_body(axes, own, heading, SENSED, ghost=False)
    draw_goal(axes, seen.goal[0, 0])


def main() -> None:
    """Write the picture."""
    matplotlib.use("Agg")
    from PIL import Image

    drifting = Noise(odometry=DRIFT)
    usual = noise_of(scenario())
    near = replace(usual.neighbours, missed=0.3, false_alarms=1.0)  # often, to be seen
    full = replace(usual, neighbours=near, odometry=DRIFT, delay=0)
    one, other = moment(drifting), moment(full)
    figure, panels = pyplot.subplots(1, 3, figsize=(12.6, 3.25), dpi=100, facecolor=PAPER)
    figure.subplots_adjust(0.004, 0.01, 0.996, 0.9, 0.02)
    world_panel(panels[0], one)
    perception_panel(panels[1], one, rays=False)
    perception_panel(panels[2], other, rays=True)
    titles = (
        "the world", "perceived: error of the own pose only", "perceived: all errors",
    )  # fmt: skip
    for axes, title in zip(panels, titles, strict=True):
        axes.set(xlim=(-0.5, 9.5), ylim=(-0.6, 6.6), aspect="equal", xticks=[], yticks=[])
        axes.set_title(title, fontsize=10, color=INK)
        for spine in axes.spines.values():
            spine.set(color="#c9d2d8", linewidth=0.8)
    figure.savefig(IMAGE, facecolor=PAPER)
    pyplot.close(figure)
    Image.open(IMAGE).convert("RGB").quantize(COLOURS).save(IMAGE, optimize=True)


if __name__ == "__main__":
    main()
