"""Slow twins of the placement test: shapely polygons, and a path search on a fine grid."""

from collections import deque
from itertools import pairwise

import numpy as np
import shapely

from benchnav.arena.solid import Kind, Solid

_FAR = 1e4


def solid_area(solid):
    """The solid as a shapely geometry; the outside of a walled arena is a huge ring."""
    if solid.is_disc:
        return shapely.Point(solid.center).buffer(solid.radius, quad_segs=128)
    area = shapely.Polygon()
    for loop in solid.loops:
        ring = shapely.LinearRing(loop)
        if shapely.Polygon(loop).area == 0.0:
            area = area.union(shapely.LineString(loop))
        elif not ring.is_ccw and area.is_empty:
            area = shapely.box(-_FAR, -_FAR, _FAR, _FAR).difference(shapely.Polygon(loop))
        elif ring.is_ccw:
            area = area.union(shapely.Polygon(loop))
        else:
            area = area.difference(shapely.Polygon(loop))
    return area


def shape_area(shape):
    """Capsules (Q, 5) as a shapely geometry; thin closed chains are filled."""
    if len(shape) > 2 and np.all(shape[:, 4] == 0.0):
        ends = [q for q in range(len(shape)) if np.any(shape[q, 0:2] != shape[q - 1, 2:4])] or [0]
        loops = [shape[a:b, 0:2] for a, b in pairwise([*ends, len(shape)])]
        return solid_area(Solid(Kind.STATIC, tuple(loops)))
    return shapely.union_all([
        shapely.LineString([c[0:2], c[2:4]]).buffer(c[4], quad_segs=128) if c[4] > 0
        else shapely.LineString([c[0:2], c[2:4]])
        for c in shape
    ])  # fmt: skip


def gap(shape, solids):
    """Distance [m] of a shape to the nearest solid; 0 where they overlap."""
    area = shape_area(shape)
    return min((area.distance(solid_area(solid)) for solid in solids), default=np.inf)


def clearances(points, solids):
    """(N,) distance [m] of points to the nearest solid; 0 inside."""
    where = shapely.points(points)
    distances = [shapely.distance(where, solid_area(solid)) for solid in solids]
    return np.min([np.full(len(points), np.inf), *distances], axis=0)


def joined(start, goal, radius, solids, bounds, step=0.05):
    """True where a path on a grid of ``step`` [m] proves that a disc gets from start to goal.

    A disc at both ends of a grid edge, each with half a step to spare, is free all
    along the edge; so True is a proof, and False is none.
    """
    x0, y0, x1, y1 = bounds
    xs, ys = np.arange(x0, x1 + step, step), np.arange(y0, y1 + step, step)
    grid = np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=-1)
    blocked = shapely.union_all([solid_area(solid) for solid in solids])
    shapely.prepare(blocked)
    free = ~shapely.dwithin(shapely.points(grid), blocked, radius + step / 2)

    def near(point):
        cell = np.argmin(np.sum((grid - point) ** 2, axis=-1) + np.where(free, 0, _FAR))
        return tuple(int(i) for i in np.unravel_index(cell, free.shape))

    first, last = near(start), near(goal)
    seen, queue = {first}, deque([first])
    while queue:
        i, j = queue.popleft()
        if (i, j) == last:
            return True
        for cell in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            inside = 0 <= cell[0] < len(xs) and 0 <= cell[1] < len(ys)
            if inside and free[cell] and cell not in seen:
                seen.add(cell)
                queue.append(cell)
    return False
