"""Solids: the one geometry for sensing, contact and maps.

A solid is either a disc or a set of closed loops whose interior lies to the
*left* of every edge: outer boundaries run counter-clockwise, holes and the
inside of a walled arena clockwise. A thin wall is a loop that runs forth and
back. Kernels use capsules only: a segment with a radius. A disc is
a capsule of length zero, and an edge is a capsule of radius zero.
"""

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import numpy as np

from benchnav.arrays import FloatArray

_THIN = 1e-12  # of its extent, squared: a smaller area comes from rounding


class Kind(IntEnum):
    """The kind of object that a ray hits or a body touches."""

    NOTHING = 0
    AGENT = 1
    WALL = 2
    STATIC = 3
    GOAL = 4
    DYNAMIC = 5


@dataclass(frozen=True, eq=False)
class Solid:
    """A wall, a static obstacle, or the shape of a body (then centred at its origin)."""

    kind: Kind
    loops: tuple[
        FloatArray, ...
    ] = ()  # each (V, 2) [m], solid to the left; the first vertex is not repeated at the end
    center: tuple[float, float] = (0.0, 0.0)  # of a disc [m]
    radius: float = 0.0  # of a disc [m]; 0 if loops define the shape

    @property
    def is_disc(self) -> bool:
        """Whether the shape is a disc."""
        return not self.loops

    @cached_property
    def capsules(self) -> FloatArray:
        """(P, 5) x0, y0, x1, y1, radius; edges in loop order."""
        if self.is_disc:
            return np.array([[*self.center, *self.center, self.radius]])
        edges = np.zeros((sum(map(len, self.loops)), 5))
        first = 0
        for loop in self.loops:
            end = first + len(loop)
            edges[first:end, 0:2] = loop
            edges[first : end - 1, 2:4] = loop[1:]
            edges[end - 1, 2:4] = loop[0]
            first = end
        return edges

    @cached_property
    def bounding_radius(self) -> float:
        """Radius [m] of the smallest circle around the origin that contains the shape."""
        c = self.capsules  # each corner begins one of them
        return float((np.hypot(c[:, 0], c[:, 1]) + c[:, 4]).max())

    def moved(self, offset: FloatArray) -> "Solid":
        """Return the same shape, translated by ``offset`` (2,) [m]."""
        x, y = float(offset[0]), float(offset[1])
        shift = np.array([x, y])
        loops = tuple([loop + shift for loop in self.loops])
        return Solid(self.kind, loops, (self.center[0] + x, self.center[1] + y), self.radius)


def is_outside(solid: Solid) -> bool:
    """Whether a solid is the outside of a walled arena, which has no end."""
    return not solid.is_disc and _area(solid.capsules[:, 0:2], solid.capsules[:, 2:4]) < 0.0


def signed_area(loop: FloatArray) -> float:
    """Return the area [m²] of a loop (V, 2), negative if it runs clockwise.

    It is 0 for a loop that runs forth and back, whatever the rounding.
    """
    return _area(loop, np.roll(loop, -1, axis=0))


def _area(begin: FloatArray, end: FloatArray) -> float:
    """Return the area [m²] to the left of closed edges, from ``begin`` to ``end`` (E, 2)."""
    origin = begin[0]
    (x0, y0), (x1, y1) = (begin - origin).T, (end - origin).T
    area = 0.5 * float(np.dot(x0, y1) - np.dot(x1, y0))
    extent = float(max(np.ptp(x0), np.ptp(y0)))
    return area if abs(area) > _THIN * extent * extent else 0.0
