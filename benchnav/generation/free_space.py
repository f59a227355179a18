"""Free space: possible positions of a disc's centre, and their connected parts.

The space is conservative: discs are grown by polygons that contain the true
outline, so positions that it reports as connected are connected. The error is at most 0.5 % of
the radius.
"""

import math
from typing import Any

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, Extent, FloatArray, IntArray
from benchnav.generation.clearance import POINT, Barrier, clear, first_clear

_QUADRANT = 8  # segments in a quarter of a grown outline
_GROWTH = 1.0 / math.cos(math.pi / (4 * _QUADRANT))  # the polygon then contains the circle
_TOUCH = 1e-6  # [m] extra distance that every place keeps


class Space:
    """Free space of one arrangement of solids for one radius."""

    def labels(self, points: FloatArray) -> IntArray:
        """Return the connected part (N,) that contains each point (N, 2); -1: not free."""
        raise NotImplementedError

    def label(self, point: FloatArray) -> int:
        """Return the connected part that contains a point (1, 2); -1: not free."""
        return int(self.labels(point)[0])


class JoinedSpace(Space):
    """Free space among convex solids with gaps wider than the disc: all of it is connected."""

    def __init__(self, wall: Barrier, radius: float) -> None:
        self._wall, self._least = wall, radius + _TOUCH

    def labels(self, points: FloatArray) -> IntArray:
        return np.where(clear(POINT, points, self._wall, self._least), 0, -1)

    def label(self, point: FloatArray) -> int:
        return first_clear(POINT, point, self._wall, self._least)  # 0: the only part


class PartedSpace(Space):
    """Free space as polygons: the bounds minus everything within the radius of any edge.

    Each polygon lies completely in a solid or completely outside all of them; one point of
    it decides which.
    """

    def __init__(self, wall: Barrier, bounds: Extent, walled: bool, radius: float) -> None:
        import shapely

        reach = radius + _TOUCH
        x0, y0, x1, y1 = bounds
        margin = reach if walled else -4.0 * reach  # without a wall, agents may pass outside
        arena = shapely.box(x0 + margin, y0 + margin, x1 - margin, y1 - margin)
        parts = [p for p in _faces(arena, _grown(wall, reach)) if p.area > 0.0]
        if parts:
            inner = shapely.get_coordinates(shapely.point_on_surface(parts))
            outside = clear(POINT, inner, wall, 0.0)
            parts = [part for part, free in zip(parts, outside, strict=True) if free]
        parts.sort(key=lambda part: -part.area)
        shapely.prepare(parts)
        self._parts: list[Any] = parts
        self._boxes = np.array([part.bounds for part in parts]).reshape(-1, 4)

    def labels(self, points: FloatArray) -> IntArray:
        import shapely

        found = np.full(len(points), -1)
        x, y = points[:, 0, None], points[:, 1, None]
        b = self._boxes
        near = (b[:, 0] <= x) & (x <= b[:, 2]) & (b[:, 1] <= y) & (y <= b[:, 3])  # (N, parts)
        for k in np.flatnonzero(near.any(axis=0)):
            ask = np.flatnonzero(near[:, k] & (found < 0))
            if len(ask):
                held = shapely.contains_xy(self._parts[k], points[ask, 0], points[ask, 1])
                found[ask[held]] = k
        return found


def _grown(wall: Barrier, reach: float) -> Any:
    """Return everything within ``reach`` of an edge or disc of the solids, slightly enlarged."""
    import shapely

    edges = wall.capsules
    if not len(edges):
        return shapely.Polygon()
    goes_on = np.all(edges[1:, :2] == edges[:-1, 2:4], axis=1) & (edges[1:, 4] == edges[:-1, 4])
    lines, radii = [], []
    for run in np.split(edges, np.flatnonzero(~goes_on) + 1):  # the edges of a loop, or a disc
        lines.append(shapely.linestrings(np.vstack([run[:, :2], run[-1:, 2:4]])))
        radii.append((run[0, 4] + reach) * _GROWTH)
    grown = shapely.buffer(np.array(lines), np.array(radii), quad_segs=_QUADRANT)
    return shapely.disjoint_subset_union_all(grown)


def _faces(arena: Any, blocked: Any) -> AnyArray:
    """Return the polygons (N,) of ``arena`` without ``blocked``, a union of polygons.

    Shapely's difference takes time that grows with the square of the number of polygons. It is
    needed only for those that leave the arena, touch others, or are around such a polygon. Outlines
    of all others are already the boundary of what is left: the outer ones are holes in it, and each
    hole is a polygon.
    """
    import shapely

    parts = shapely.get_parts(blocked)
    alone = _stand_alone(arena, parts)
    rest = shapely.get_parts(shapely.difference(arena, shapely.multipolygons(parts[~alone])))
    rings, owner = shapely.get_rings(parts[alone], return_index=True)
    outer = np.ones(len(rings), np.bool_)
    outer[1:] = owner[1:] != owner[:-1]
    faces = np.concatenate([rest, shapely.polygons(rings[~outer])])
    ring, face = _within(shapely.get_point(rings[outer], 0), faces)
    smallest_first = np.lexsort((shapely.area(faces)[face], ring))
    _, first = np.unique(ring[smallest_first], return_index=True)
    around = face[smallest_first][first]
    order = np.argsort(around, kind="stable")
    owners, first = np.unique(around[order], return_index=True)
    for k, holes in zip(owners, np.split(rings[outer][order], first[1:]), strict=False):
        own = shapely.get_rings(faces[k])
        faces[k] = shapely.polygons(own[0], [*own[1:], *holes])
    return faces


def _stand_alone(arena: Any, parts: AnyArray) -> BoolArray:
    """Whether each polygon (N,) is within the arena, touches no other, and is around none such."""
    import shapely

    shapely.prepare(parts)
    shapely.prepare(arena)
    alone: BoolArray = shapely.contains_properly(arena, parts)
    one, other = shapely.STRtree(parts).query(parts)  # by boxes; slower with a predicate
    one, other = one[one < other], other[one < other]
    touching = shapely.intersects(parts[one], parts[other])
    alone[one[touching]] = alone[other[touching]] = False
    outlines = shapely.get_exterior_ring(parts)
    _, around = _within(shapely.get_point(outlines[~alone], 0), shapely.polygons(outlines))
    alone[around] = False
    return alone


def _within(points: AnyArray, polygons: AnyArray) -> tuple[IntArray, IntArray]:
    """Return (point, polygon) of all pairs in which the point lies in the polygon."""
    import shapely

    shapely.prepare(polygons)
    point, polygon = shapely.STRtree(polygons).query(points)
    x, y = shapely.get_x(points), shapely.get_y(points)
    held = shapely.contains_xy(polygons[polygon], x[point], y[point])
    return point[held], polygon[held]
