"""A picture of an area seen from above, drawn in metres without a plotting library."""

import math

import numpy as np
from PIL import Image, ImageDraw

from benchnav.arena.solid import Kind, Solid, is_outside, signed_area
from benchnav.arrays import ByteArray, Extent, FloatArray
from benchnav.drawing.palette import FILL, INK, PAPER, channels


class Canvas:
    """A picture that is drawn finer than its pixels and then averaged, so that edges are smooth.

    Places and radii are in metres, widths of lines in pixels.
    """

    def __init__(self, area: Extent, size: int, finer: int = 2) -> None:
        """Return an empty picture of ``area`` whose longer side has ``size`` pixels.

        Each pixel is the mean of ``finer`` × ``finer`` drawn ones.
        """
        x0, y0, x1, y1 = area
        self._finer = finer
        self._scale = finer * size / max(x1 - x0, y1 - y0)  # [drawn pixels/m]
        self._corner = x0, y1
        wide, high = ((span * self._scale / finer) for span in (x1 - x0, y1 - y0))
        self._begin(Image.new("RGB", (finer * _pixels(wide), finer * _pixels(high)), PAPER))

    def _begin(self, image: Image.Image) -> None:
        self._image, self._draw = image, ImageDraw.Draw(image)

    def copy(self) -> "Canvas":
        """Return an independent copy."""
        copy = object.__new__(Canvas)
        copy._finer, copy._scale, copy._corner = self._finer, self._scale, self._corner
        copy._begin(self._image.copy())
        return copy

    def array(self, larger: int = 1) -> ByteArray:
        """Return the picture (height, width, 3) of bytes, ``larger`` times as large.

        ``larger`` divides the ``finer`` of the canvas.
        """
        return np.asarray(self._image.reduce(self._finer // larger))

    def solid(self, solid: Solid) -> None:
        """Fill a wall or an obstacle; the outside of a walled arena is filled up to the frame."""
        color = FILL.get(Kind(solid.kind), INK)
        if solid.is_disc:
            self.disc(np.array(solid.center), solid.radius, fill=color)
            return
        if is_outside(solid):
            self._draw.rectangle((0, 0, *self._image.size), fill=color)
        for loop in sorted(solid.loops, key=signed_area, reverse=True):
            points, area = self._places(loop), signed_area(loop)
            if area != 0.0 and len(points) > 2:
                self._draw.polygon(points, fill=color if area > 0.0 else PAPER)
            self._draw.line([*points, points[0]], fill=color, width=self._finer)

    def disc(
        self, place: FloatArray, radius: float, *, fill: str | None = None,
        outline: str | None = None, width: float = 1.0, least: float = 0.0,
    ) -> None:  # fmt: skip
        """Draw a disc or a ring at ``place`` (2,), with a radius of at least ``least`` pixels."""
        ((x, y),) = self._places(place[None])
        r = max(radius * self._scale, least * self._finer)
        self._draw.ellipse(
            (x - r, y - r, x + r, y + r), fill=fill, outline=outline, width=self._width(width)
        )

    def polygon(self, points: FloatArray, *, fill: str) -> None:
        """Fill a polygon with corners ``points`` (N, 2)."""
        self._draw.polygon(self._places(points), fill=fill)

    def line(self, points: FloatArray, color: str, width: float = 1.0) -> None:
        """Draw a line through ``points`` (N, 2)."""
        self._draw.line(self._places(points), fill=color, width=self._width(width), joint="curve")

    def heading(self, place: FloatArray, length: float, angle: float) -> None:
        """Draw the heading [rad] of an agent on its body, as a line of a length [m]."""
        ahead = length * np.array([math.cos(angle), math.sin(angle)])
        self.line(np.array([place, place + ahead]), PAPER, 2.0)

    def cross(self, place: FloatArray, color: str, arm: float = 4.0, width: float = 2.0) -> None:
        """Draw a cross with arms of ``arm`` pixels, which has a rim to stand out on a disc."""
        ((x, y),) = self._places(place[None])
        for ink, edge in ((PAPER, 1.0), (color, 0.0)):
            r = (arm + 0.7 * edge) * self._finer
            for way in (-r, r):
                ends = [(x - r, y - way), (x + r, y + way)]
                self._draw.line(ends, fill=ink, width=self._width(width + 2.0 * edge))

    def dots(self, points: FloatArray, color: str, apart: float) -> None:
        """Draw dots along the line through ``points`` (N, 2), at least ``apart`` pixels apart.

        A line that runs back over itself keeps its dots.
        """
        steps = np.linalg.norm(np.diff(points, axis=0), axis=-1)
        along = np.concatenate([[0.0], np.cumsum(steps)])
        gap = apart * self._finer / self._scale  # [m]
        places = np.arange(0.0, along[-1] + 1e-9, gap)
        x, y = (np.interp(places, along, points[:, axis]) for axis in (0, 1))
        kept = np.zeros((0, 2))
        for place in np.column_stack([x, y]):
            if (np.linalg.norm(kept - place, axis=-1) > 0.8 * gap).all():
                kept = np.vstack([kept, place])
                self.disc(place, 0.0, fill=color, least=0.5)

    def _width(self, width: float) -> int:
        return max(1, round(width * self._finer))

    def _places(self, points: FloatArray) -> list[tuple[float, float]]:
        """Return points (N, 2) [m] as drawn pixels; y of a picture runs downwards."""
        x, y = self._corner
        return [((px - x) * self._scale, (y - py) * self._scale) for px, py in points.tolist()]


def shade(color: str, strength: float) -> str:
    """Return a colour mixed with the paper; ``strength`` in [0, 1]."""
    mixed = (
        round(strength * own + (1.0 - strength) * paper)
        for own, paper in zip(channels(color), channels(PAPER), strict=True)
    )
    return "#{:02x}{:02x}{:02x}".format(*mixed)


def _pixels(length: float) -> int:
    return max(1, round(length))
