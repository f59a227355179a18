"""A world from above as pixels: fast enough to draw at each step of an environment."""

import math

import numpy as np
from PIL import Image, ImageDraw

from benchnav.arena.solid import Kind, Solid, signed_area
from benchnav.arena.world import World
from benchnav.arrays import BoolArray, ByteArray, FloatArray
from benchnav.drawing.palette import FILL, INK, PAPER, color_of

_FINER = 2  # lines are drawn so many times finer, and averaged
_RIM = 0.015  # of the longer side: how thick the wall along the bounds is drawn


class TopView:
    """Draws one world. Walls and obstacles that stand still are drawn once."""

    def __init__(self, world: World, size: int = 480) -> None:
        """Prepare pictures whose longer side has ``size`` pixels."""
        self.world = world
        x0, y0, x1, y1 = world.bounds
        rim = _RIM * max(x1 - x0, y1 - y0)
        self._scale = _FINER * size / (max(x1 - x0, y1 - y0) + 2.0 * rim)  # [pixels/m]
        self._corner = x0 - rim, y1 + rim
        wide = max(1, round((x1 - x0 + 2.0 * rim) * self._scale / _FINER))
        high = max(1, round((y1 - y0 + 2.0 * rim) * self._scale / _FINER))
        self._size = _FINER * wide, _FINER * high
        self._background = Image.new("RGB", self._size, PAPER)
        draw = ImageDraw.Draw(self._background)
        for solid in sorted(world.solids, key=_is_inside):
            self._solid(draw, solid)
        for place, radius, team in zip(
            world.agents.goal, world.agents.radius, world.agents.team, strict=True
        ):
            self._disc(draw, place, radius, outline=color_of(int(team)))

    def draw(
        self, position: FloatArray, heading: FloatArray, bodies: FloatArray, present: BoolArray,
        marked: int | None = None,
    ) -> ByteArray:  # fmt: skip
        """Return the picture (height, width, 3) of bytes.

        Args:
            position: (A, 2) [m] of the agents.
            heading: (A,) [rad].
            bodies: (M, 2) [m] of the moving obstacles.
            present: (A,) which agents are drawn.
            marked: the agent with a ring around it.
        """
        picture = self._background.copy()
        draw = ImageDraw.Draw(picture)
        for body, place in zip(self.world.bodies, bodies, strict=False):
            self._solid(draw, body.solid.moved(place))
        agents = self.world.agents
        for a in np.flatnonzero(present[: len(agents)]):
            radius, team = float(agents.radius[a]), int(agents.team[a])
            self._disc(draw, position[a], radius, fill=color_of(team))
            ahead = radius * np.array([math.cos(heading[a]), math.sin(heading[a])])
            tip = self._pixels(np.array([position[a], position[a] + ahead]))
            draw.line(tip, fill=PAPER, width=_FINER * 2)
            if a == marked:
                self._disc(draw, position[a], 1.35 * radius, outline=INK)
        return np.asarray(picture.reduce(_FINER))

    def _solid(self, draw: ImageDraw.ImageDraw, solid: Solid) -> None:
        color = FILL.get(Kind(solid.kind), INK)
        if solid.is_disc:
            self._disc(draw, np.array(solid.center), solid.radius, fill=color)
            return
        if _is_inside(solid) < 0.0:  # the outside of a walled arena
            draw.rectangle((0, 0, *self._size), fill=color)
        for loop in sorted(solid.loops, key=signed_area, reverse=True):
            points = self._pixels(loop)
            area = signed_area(loop)
            if area != 0.0 and len(points) > 2:
                draw.polygon(points, fill=color if area > 0.0 else PAPER)
            draw.line([*points, points[0]], fill=color, width=_FINER)

    def _disc(
        self, draw: ImageDraw.ImageDraw, place: FloatArray, radius: float, **style: str
    ) -> None:
        (x, y), r = self._pixels(place[None])[0], radius * self._scale
        draw.ellipse((x - r, y - r, x + r, y + r), width=_FINER, **style)

    def _pixels(self, points: FloatArray) -> list[tuple[float, float]]:
        """Return points (N, 2) [m] as pixels; y of a picture runs downwards."""
        x, y = self._corner
        return [((px - x) * self._scale, (y - py) * self._scale) for px, py in points]


def _is_inside(solid: Solid) -> float:
    """Return -1.0 for the outside of a walled arena, which is drawn first; else 1.0."""
    return -1.0 if sum(map(signed_area, solid.loops)) < 0.0 else 1.0
