"""Voronoi cells by half-planes, where GEOS cannot cut the cells that it computes itself.

The Voronoi diagram of GEOS has invalid cells if agents stand nearly on a line, for example along a
wall: their corners lie many kilometres away. Each cell here starts as a disc and is cut by one
line for each neighbour, so that it stays small and convex.
"""

from typing import Any

import numpy as np

from benchnav.arrays import BoolArray, FloatArray


def voronoi_cells(points: FloatArray, walkable: Any, reach: float, quarter: int) -> list[Any]:
    """Return the cell of each point (N, 2) [m] in a walkable area, a polygon that contains it.

    A cell ends at a distance of ``reach`` [m], on a polygon with ``quarter`` segments in a quarter
    of a circle. In an area that is not convex, a cell is the part that contains its point.
    """
    import shapely

    found = []
    for point in points:
        ring = np.array(shapely.Point(point).buffer(reach, quad_segs=quarter).exterior.coords)
        for other in points[_near(point, points, 2.0 * reach)]:
            ring = _nearer(ring, point, other)
        cell = shapely.intersection(shapely.Polygon(ring), walkable)
        found.append(part_with(point, cell))
    return found


def part_with(point: FloatArray, cell: Any) -> Any:
    """Return the polygon of a cell that contains its point (2,), or is the nearest to it."""
    import shapely

    parts = [part for part in shapely.get_parts(cell) if part.geom_type == "Polygon"]
    return min(parts, key=lambda part: part.distance(shapely.Point(point)))


def _near(point: FloatArray, points: FloatArray, reach: float) -> BoolArray:
    """Return the mask (N,) of other points that are closer than ``reach``."""
    away = np.linalg.norm(points - point, axis=1)
    near: BoolArray = (away > 0.0) & (away < reach)
    return near


def _nearer(ring: FloatArray, point: FloatArray, other: FloatArray) -> FloatArray:
    """Return the part of a closed convex ring (N, 2) that is nearer to ``point`` than ``other``."""
    beyond = (ring - 0.5 * (point + other)) @ (other - point)
    kept: list[FloatArray] = []
    for k in range(len(ring) - 1):
        a, b = beyond[k], beyond[k + 1]
        if a <= 0.0:
            kept.append(ring[k])
        if (a < 0.0 < b) or (b < 0.0 < a):
            kept.append(ring[k] + a / (a - b) * (ring[k + 1] - ring[k]))
    return np.array([*kept, kept[0]])
