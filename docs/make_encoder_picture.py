"""Draws what the encoders see: ``python docs/make_encoder_picture.py``.

`images/encoders.png` shows one moment of a world of `leaders/dynamic` twice, as one
leader perceives it: the seven thick rays of `paper` and `ego`, and the scan and the
others of `surround`. Everything that is drawn is read from the sensors and encoders.
"""

import math
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib import pyplot
from matplotlib.patches import Circle, PathPatch, Polygon
from matplotlib.path import Path as Outline

from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import FloatArray
from benchnav.envs.agent_batch import AgentBatch
from benchnav.envs.encoders.encoder import Float32Array
from benchnav.envs.encoders.surround import DIRECTIONS, FADE, OTHERS, SurroundEncoder
from benchnav.envs.factory import make_batch
from benchnav.navigation.navigator import Need
from benchnav.sensors.sense import sense

IMAGE = Path(__file__).parent / "images" / "encoders.png"
SCENARIO, WORLD, LEADER, DECISIONS = "leaders/dynamic", 13, 2, 2
MARGIN = 0.3  # [m] shown around the arena
COLOURS = 128  # in the file, which keeps it small
PAPER, INK, WALL, FURNITURE, MOVER = "#ffffff", "#22303c", "#36454f", "#b4bec6", "#e07a3f"
OWN, CREW, GOAL = "#1f6fb4", "#7c5aa6", "#2a9d5c"
MEETS = {
    Kind.NOTHING: ("nothing", "#8fa1ad"),
    Kind.AGENT: ("agent", CREW),
    Kind.WALL: ("wall", WALL),
    Kind.STATIC: ("static obstacle", "#6d7f8b"),
    Kind.DYNAMIC: ("mover", MOVER),
    Kind.GOAL: ("goal", GOAL),
}


def moment() -> tuple[AgentBatch, Float32Array]:
    """The world after all agents went ahead for some decisions, and the leader's numbers."""
    batch = make_batch(SCENARIO, "surround", "train", WORLD + 1, None)
    batch.reset(np.array([WORLD]))
    for _ in range(DECISIONS):
        step = batch.step(np.tile([0.2, 0.0], (1, batch.width, 1)))
    return batch, step.observation[0, LEADER]


def draw_world(axes: Any, batch: AgentBatch) -> None:
    """Who and what stands where; the leader in blue."""
    s = batch.simulation
    world = s.worlds[0]
    x0, y0, x1, y1 = world.bounds
    for solid in world.solids:
        axes.add_patch(_patch(solid, WALL if solid.kind == Kind.WALL else FURNITURE))
    for body, place in zip(world.bodies, s.body_position[0], strict=False):
        axes.add_patch(_patch(body.solid.moved(place), MOVER))
    for a in np.flatnonzero(s.present[0]):
        colour, radius = OWN if a == LEADER else CREW, float(s.agents["radius"][0, a])
        here, heading = s.position[0, a], float(s.heading[0, a])
        axes.add_patch(Circle(here, radius, color=colour, linewidth=0, zorder=5))
        nose = here + radius * np.array([math.cos(heading), math.sin(heading)])
        axes.plot(*zip(here, nose, strict=True), color=PAPER, linewidth=1.6, zorder=6)
    ring = {"fill": False, "edgecolor": GOAL, "linewidth": 2.0, "zorder": 4}
    axes.add_patch(Circle(s.goal[0, LEADER], world.rules.goal_tolerance, **ring))
    axes.set(xlim=(x0 - MARGIN, x1 + MARGIN), ylim=(y0 - MARGIN, y1 + MARGIN), aspect="equal")
    axes.set(xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_color("#d5dbe0")


def draw_rays(axes: Any, batch: AgentBatch) -> None:
    """Each ray is as wide as the body; its label says what it meets and how far away."""
    s = batch.simulation
    chosen = np.where(np.arange(s.A) == LEADER, LEADER, -1)[None]
    rays, _, _ = sense(s, chosen, frozenset({str(Need.RAYS)}))
    assert rays is not None  # noqa: S101 - the scenario has rays
    here, radius = s.position[0, LEADER], float(s.agents["radius"][0, LEADER])
    labels = Labels()
    for a in np.flatnonzero(s.present[0]):
        labels.avoid(s.position[0, a], float(s.agents["radius"][0, a]))
    for k, relative in enumerate(rays.angle):
        kind, length = Kind(int(rays.kind[0, LEADER, k])), float(rays.distance[0, LEADER, k])
        if np.isfinite(rays.goal[0, LEADER, k]):
            kind, length = Kind.GOAL, float(rays.goal[0, LEADER, k])
        word, colour = MEETS[kind]
        angle = float(s.heading[0, LEADER]) + float(relative)
        way = np.array([math.cos(angle), math.sin(angle)])
        axes.add_patch(_swath(here, way, length, radius, colour))
        far = "" if kind == Kind.NOTHING else f"\n{length:.1f} m"
        place = here + way * max(length - 0.4, 2.3)
        labels.add(place, f"{k} {word}{far}", colour)
    labels.draw(axes)


def draw_scan(axes: Any, batch: AgentBatch, values: Float32Array) -> None:
    """A spoke for the way that is free in each direction, an arrow for each other's motion."""
    s = batch.simulation
    here, heading = s.position[0, LEADER], float(s.heading[0, LEADER])
    names = {number.name: k for k, number in enumerate(SurroundEncoder().numbers)}
    for k in range(DIRECTIONS):
        near = float(values[names[f"scan{k}.near"]])
        length = -FADE * math.log(near) if near > 0 else 8.0
        angle = heading + 2 * math.pi * k / DIRECTIONS
        tip = here + length * np.array([math.cos(angle), math.sin(angle)])
        colour = OWN if near > 0 else "#b9c6d0"
        axes.plot(*zip(here, tip, strict=True), color=colour, linewidth=1.1, alpha=0.75, zorder=2)
        if near > 0:
            axes.plot(*tip, marker="o", markersize=4.5, color=colour, zorder=3)
    labels = Labels()
    labels.avoid(here, float(s.agents["radius"][0, LEADER]))
    for k in range(OTHERS):
        own = [values[names[f"other{k}.{part}"]] for part in ("cos", "sin", "close", "p", "mover")]
        if own[2] > 0:
            _draw_other(axes, batch, k, float(own[3]), bool(own[4]), labels)
    labels.draw(axes)


def _draw_other(
    axes: Any, batch: AgentBatch, k: int, p: float, mover: bool, labels: "Labels"
) -> None:
    s = batch.simulation
    chosen = np.where(np.arange(s.A) == LEADER, LEADER, -1)[None]
    _, seen, _ = sense(s, chosen, frozenset({str(Need.NEIGHBOURS)}))
    assert seen is not None  # noqa: S101 - the scenario has neighbours
    place, radius = seen.position[0, LEADER, k], float(seen.radius[0, LEADER, k])
    drift = seen.velocity[0, LEADER, k] - s.velocity[0, LEADER]
    colour = MOVER if mover else CREW
    style = {"fill": False, "edgecolor": colour, "linewidth": 1.2, "linestyle": (0, (3, 2))}
    axes.add_patch(Circle(place, radius, zorder=6, **style))
    arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", place + drift, place, arrowprops=arrow, zorder=7)
    labels.avoid(place, radius)
    labels.avoid(place + drift, 0.2)
    labels.add(place, f"{k}  p = {p:.2f}", colour, radius + 0.1)


def _swath(here: FloatArray, way: FloatArray, length: float, radius: float, colour: str) -> Any:
    """What a disc sweeps that starts at ``here`` (2,) and goes ``length`` [m] along ``way``."""
    turn = math.atan2(way[1], way[0])
    half = np.linspace(-math.pi / 2, math.pi / 2, 24)
    cap = np.stack([np.cos(turn + half), np.sin(turn + half)], axis=-1) * radius
    ring = np.concatenate([here + length * way + cap, here - cap])
    return Polygon(ring, facecolor=colour, edgecolor=colour, alpha=0.22, linewidth=0.8, zorder=2)


class Labels:
    """Labels beside their places, moved so that they cover neither discs nor each other."""

    def __init__(self) -> None:
        self._wanted: list[tuple[FloatArray, str, str, float]] = []
        self._taken: list[FloatArray] = []  # boxes (4,): x, y of the middle, half sizes [m]

    def avoid(self, place: FloatArray, radius: float) -> None:
        """Keep a disc free of labels."""
        self._taken.append(np.array([*place, radius, radius]))

    def add(self, place: FloatArray, text: str, colour: str, gap: float = 0.0) -> None:
        """Add a label at a place, or beside a disc of ``gap`` [m] around it."""
        self._wanted.append((place, text, colour, gap))

    def draw(self, axes: Any) -> None:
        """Draw all labels; a line leads from a label that is moved to its place."""
        style = {"boxstyle": "round,pad=0.22", "facecolor": PAPER, "linewidth": 0.8}
        for place, text, colour, gap in self._wanted:
            middle = self._free_place(place, _half_size(text), gap)
            if np.hypot(*(middle - place)) > gap + 0.7:
                axes.plot(*zip(place, middle, strict=True), color=colour, linewidth=0.7, zorder=8)
            axes.text(
                *middle, text, fontsize=7.5, color=INK, ha="center", va="center", zorder=9,
                bbox={**style, "edgecolor": colour},
            )  # fmt: skip

    def _free_place(self, place: FloatArray, half: FloatArray, gap: float) -> FloatArray:
        """Return the nearest place for a label around ``place``, and take it."""
        angles = np.pi * (np.arange(16) / 8 - 0.5)  # below is tried first
        ways = np.column_stack([np.cos(angles), np.sin(angles)])
        first = place + ways * (half + gap) if gap else place[None]
        rings = [place + ways * (half + gap + reach) for reach in np.arange(0.1, 4.0, 0.2)]
        for middle in np.concatenate([first, *rings]):
            boxes = np.array(self._taken)
            apart = np.abs(middle - boxes[:, :2]) >= half + boxes[:, 2:]
            if apart.any(axis=1).all():
                self._taken.append(np.array([*middle, *half]))
                return np.asarray(middle)
        raise RuntimeError("There is no room for a label.")


def _half_size(text: str) -> FloatArray:
    """Return half of the width and height [m] of a label."""
    lines = text.splitlines()
    return np.array([0.12 * max(map(len, lines)) + 0.2, 0.22 * len(lines) + 0.17])


def _patch(solid: Solid, colour: str) -> Any:
    if solid.is_disc:
        return Circle(solid.center, solid.radius, color=colour, linewidth=0)
    loops = list(solid.loops)
    if sum(map(_area, loops)) < 0.0:  # what lies outside the arena
        far = 100.0
        loops.append(np.array([[-far, -far], [far, -far], [far, far], [-far, far]]))
    outline = [Outline(np.vstack([loop, loop[:1]]), closed=True) for loop in loops]
    return PathPatch(Outline.make_compound_path(*outline), color=colour, linewidth=0.4)


def _area(loop: FloatArray) -> float:
    x, y = loop.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def main() -> None:
    """Writes `images/encoders.png`."""
    from PIL import Image

    matplotlib.use("Agg")
    batch, values = moment()
    figure, row = pyplot.subplots(1, 2, figsize=(11.0, 5.75), dpi=110, facecolor=PAPER)
    figure.subplots_adjust(0.006, 0.01, 0.994, 0.945, 0.015)
    titles = (
        "paper, ego: seven rays as wide as the body",
        "surround: a scan, and the nearest others",
    )
    draw_rays(row[0], batch)
    draw_scan(row[1], batch, values)
    for axes, title in zip(row, titles, strict=True):
        draw_world(axes, batch)
        axes.set_title(title, fontsize=10.5, color=INK, pad=6)
    figure.savefig(IMAGE, facecolor=PAPER)
    Image.open(IMAGE).convert("RGB").quantize(COLOURS).save(IMAGE, optimize=True)


if __name__ == "__main__":
    main()
