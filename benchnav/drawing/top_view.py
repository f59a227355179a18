"""A world from above as pixels: fast enough to draw at each step of an environment."""

import numpy as np

from benchnav.arena.body import absent
from benchnav.arena.outline import outline, placed
from benchnav.arena.solid import is_outside
from benchnav.arena.world import World
from benchnav.arrays import BoolArray, Extent, FloatArray
from benchnav.drawing.canvas import Canvas
from benchnav.drawing.palette import INK, agent_color

_RIM = 0.015  # of the longer side: how thick the wall along the bounds is drawn


class TopView:
    """Draws one world. Walls, goals, and obstacles that stand still are drawn once."""

    def __init__(
        self, world: World, size: int = 480, *, span: FloatArray | None = None, finer: int = 2
    ) -> None:
        """Prepare pictures whose longer side has ``size`` pixels.

        Args:
            world: the world.
            size: [pixels].
            span: (2,) [m] width and height of the pictures, with the world in the middle; None:
                those of the world.
            finer: see `Canvas`.
        """
        self.world = world
        self.outlines = [outline(world.agents, a) for a in range(len(world.agents))]
        self.background = Canvas(_area(world, span), size, finer)
        for solid in sorted(world.solids, key=is_outside, reverse=True):
            self.background.solid(solid)
        for a, (place, radius) in enumerate(
            zip(world.agents.goal, world.agents.radius, strict=True)
        ):
            self.background.disc(place, radius, outline=agent_color(world, a))

    def draw(
        self, position: FloatArray, heading: FloatArray, bodies: FloatArray, present: BoolArray,
        canvas: Canvas | None = None,
    ) -> Canvas:  # fmt: skip
        """Return a picture of the moving obstacles and the agents.

        Args:
            position: (A, 2) [m] of the agents.
            heading: (A,) [rad].
            bodies: (M, 2) [m] of the moving obstacles.
            present: (A,) which agents are drawn.
            canvas: is drawn upon; None: a copy of the background.
        """
        picture = self.background.copy() if canvas is None else canvas
        for body, place in zip(self.world.bodies, bodies, strict=False):
            if not absent(place):
                picture.solid(body.solid.moved(place))
        agents = self.world.agents
        for a in np.flatnonzero(present[: len(agents)]):
            shape, color = self.outlines[a], agent_color(self.world, int(a))
            ahead = float(agents.radius[a])
            if shape is None:
                picture.disc(position[a], ahead, fill=color)
            else:
                picture.polygon(placed(shape, position[a], float(heading[a])), fill=color)
                ahead = float(agents.half_length[a])
            picture.heading(position[a], ahead, float(heading[a]))
        return picture

    def ring(self, picture: Canvas, agent: int, place: FloatArray) -> None:
        """Draw a ring around an agent at ``place`` (2,) [m]."""
        picture.disc(place, 1.35 * float(self.world.agents.radius[agent]), outline=INK)


def spans(worlds: tuple[World, ...]) -> FloatArray:
    """Return the width and height (2,) [m] that contain each of the worlds."""
    bounds = np.array([world.bounds for world in worlds])
    largest: FloatArray = (bounds[:, 2:] - bounds[:, :2]).max(axis=0)
    return largest


def _area(world: World, span: FloatArray | None) -> Extent:
    """Return the area of a picture: a span around the middle of the world, and the rim."""
    half = 0.5 * (spans((world,)) if span is None else span)
    half = half + _RIM * 2.0 * half.max()
    x, y = 0.5 * (np.array(world.bounds[:2]) + np.array(world.bounds[2:]))
    return float(x - half[0]), float(y - half[1]), float(x + half[0]), float(y + half[1])
