"""The points where the rim of a goal disc meets the boundary of free space; ways to the disc."""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.geometry.capsule_grid import CapsuleGrid, is_clear, nearby
from benchnav.geometry.free_arc import Arcs
from benchnav.geometry.tangent import point_tangents
from benchnav.kernels import kernel, kernel_without_allocation


class Arrivals(NamedTuple):
    """The ways into a goal disc."""

    links: FloatArray  # (L, 3) tangents to the goal disc, as by `point_tangents`
    rim: FloatArray  # (E, 2) [m] points of the goal disc at the boundary of free space
    owner: IntArray  # (L,) index of the rim point where a link ends; -1: at the nearest point
    direct: BoolArray  # (E,) the straight motion from the start to the rim point is free


@kernel
def arrivals(
    grid: CapsuleGrid, arcs: Arcs, sx: float, sy: float, x: float, y: float, radius: float
) -> Arrivals:
    """Return the ways from s into the disc with centre (x, y)."""
    links = point_tangents(grid, arcs, x, y, radius)
    rim = rim_points(grid, x, y, radius) if radius > 0.0 else np.empty((0, 2))
    owner, direct = np.full(len(links), -1), np.empty(len(rim), np.bool_)
    for e in range(len(rim)):
        px, py = rim[e, 0], rim[e, 1]
        direct[e] = is_clear(grid, sx, sy, px, py)
        more = point_tangents(grid, arcs, px, py, 0.0)
        links = np.concatenate((links, more))
        owner = np.concatenate((owner, np.full(len(more), e)))
    return Arrivals(links, rim, owner, direct)


@kernel
def rim_points(grid: CapsuleGrid, x: float, y: float, radius: float) -> FloatArray:
    """Return the free points (E, 2) [m] at ``radius`` from (x, y) that touch a capsule."""
    near = nearby(grid, x, y, radius)
    points = np.empty((8 * len(near), 2))
    count = 0
    for p in near:
        c, reach = grid.capsules[p], grid.reach[p]
        for end in range(2):
            count = _on_circle(points, count, x, y, radius, c[2 * end], c[2 * end + 1], reach)
        for side in range(2):
            count = _on_edge(points, count, x, y, radius, c, reach if side == 0 else -reach)
    kept = 0
    for k in range(count):
        px, py = points[k, 0], points[k, 1]
        if is_clear(grid, px, py, px, py):
            points[kept, 0], points[kept, 1] = px, py
            kept += 1
    return points[:kept]


@kernel_without_allocation
def _on_circle(
    points: FloatArray, count: int,
    x: float, y: float, radius: float, cx: float, cy: float, reach: float,
) -> int:  # fmt: skip
    """Append the crossings of the rim with the circle around c."""
    dx, dy = cx - x, cy - y
    d = math.sqrt(dx * dx + dy * dy)
    if d == 0.0:
        return count
    along = (radius * radius + d * d - reach * reach) / (2.0 * d)
    if abs(along) > radius:
        return count
    across = math.sqrt(radius * radius - along * along)
    ex, ey = dx / d, dy / d
    points[count, 0], points[count, 1] = x + along * ex - across * ey, y + along * ey + across * ex
    count += 1
    points[count, 0], points[count, 1] = x + along * ex + across * ey, y + along * ey - across * ex
    return count + 1


@kernel_without_allocation
def _on_edge(
    points: FloatArray, count: int,
    x: float, y: float, radius: float, c: FloatArray, offset: float,
) -> int:  # fmt: skip
    """Append the crossings of the rim with the segment of c, shifted by ``offset`` to its left."""
    dx, dy = c[2] - c[0], c[3] - c[1]
    d = math.sqrt(dx * dx + dy * dy)
    if d == 0.0:
        return count
    tx, ty = dx / d, dy / d
    ox, oy = c[0] - ty * offset, c[1] + tx * offset
    along = tx * (x - ox) + ty * (y - oy)
    off = tx * (y - oy) - ty * (x - ox)
    if abs(off) > radius:
        return count
    half = math.sqrt(radius * radius - off * off)
    for sign in range(2):
        t = along - half if sign == 0 else along + half
        if 0.0 <= t <= d:
            points[count, 0], points[count, 1] = ox + t * tx, oy + t * ty
            count += 1
    return count
