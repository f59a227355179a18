"""Triangles of free space, and the doors between them: pieces of sides that two of them share."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.geometry import inside_rows, solid_rows
from benchnav.kernels import kernel_without_allocation
from benchnav.navigation import Map

from .border import border_doors, on_lines
from .tile import Tiling

_ROUNDING = 1e-6  # [rad] of the sum of the angles around a vertex


class Mesh(NamedTuple):
    """Triangles, counter-clockwise, and doors, ordered by the triangle that they leave.

    A path may turn at a vertex only if the vertex ``turns``; no shortest path turns at another.
    """

    corner: FloatArray  # (T, 3, 2) [m]
    part: IntArray  # (T,) triangles with the same number are connected; -1: within a solid
    vertex: FloatArray  # (V, 2) [m]
    turns: BoolArray  # (V,)
    first: IntArray  # (T + 1,) first door of each triangle
    to: IntArray  # (D,) the triangle behind each door
    left: IntArray  # (D,) vertex at the left end, seen from the triangle that is left
    right: IntArray  # (D,)


def mesh_of(tiles: Sequence[FloatArray], tiling: Tiling, map: Map) -> Mesh:
    """Return the mesh of the triangles (T, 3, 2) [m] of each tile."""
    corner = np.concatenate(tiles)
    vertex, tail = _numbered(corner.reshape(-1, 2))
    head = np.roll(tail.reshape(-1, 3), -1, axis=1).ravel()
    one, other = _shared(tail, head)
    shared = np.stack([one // 3, other // 3, head[one], tail[one]], axis=1)
    alone = np.ones(len(tail), np.bool_)
    alone[one] = alone[other] = False
    across, joined = border_doors(np.flatnonzero(alone), tail, head, vertex, tiling)
    alone[joined] = False
    doors = np.vstack([shared, across])
    doors = np.vstack([doors, doors[:, [1, 0, 3, 2]]])  # a door leads both ways
    doors = doors[np.lexsort((doors[:, 1], doors[:, 0]))]
    first = np.searchsorted(doors[:, 0], np.arange(len(corner) + 1))
    to, left, right = (np.ascontiguousarray(doors[:, k]) for k in (1, 2, 3))
    edge = np.zeros(len(vertex), np.bool_)  # of free space
    edge[tail[alone]] = edge[head[alone]] = True
    turns = edge & (_is_wide(corner, tail, len(vertex)) | on_lines(vertex, tiling).any(axis=1))
    return Mesh(corner, _parts(corner, doors, map), vertex, turns, first, to, left, right)


def _numbered(places: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the different places (V, 2), and the number (N,) of each place (N, 2).

    np.unique(places, axis=0) gives the same, but takes several times as long.
    """
    order = np.lexsort((places[:, 1], places[:, 0]))
    ordered = places[order]
    new = np.ones(len(order), np.bool_)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    number = np.empty(len(order), np.int64)
    number[order] = np.cumsum(new) - 1
    return ordered[new], number


def _shared(tail: IntArray, head: IntArray) -> tuple[IntArray, IntArray]:
    """Return both sides (E,) wherever two triangles share a side; side k of triangle t is 3 t + k.

    Sides lead from vertex ``tail`` to vertex ``head``, both (3 T,).
    """
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    order = np.lexsort((high, low))
    same = (low[order[1:]] == low[order[:-1]]) & (high[order[1:]] == high[order[:-1]])
    at = np.flatnonzero(same)
    return order[at], order[at + 1]


def _is_wide(corner: FloatArray, tail: IntArray, vertices: int) -> BoolArray:
    """Return (V,), whether the free space around each vertex is half a turn or more.

    A shortest path turns at no other vertex. On the border of a tile the answer may be wrong:
    rounding may have made two vertices of one, with a part of the angle each.
    """
    ahead = np.roll(corner, -1, axis=1) - corner
    back = -np.roll(ahead, 1, axis=1)
    cross = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
    angle = np.arctan2(cross, (ahead * back).sum(axis=-1)).ravel()
    wide: BoolArray = np.bincount(tail, angle, vertices) > math.pi - _ROUNDING
    return wide


def _parts(corner: FloatArray, doors: IntArray, map: Map) -> IntArray:
    """Number the connected parts (T,); -1: within a solid.

    No edge of a solid reaches into free space, so one place of a part decides for all of it.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(corner)
    joined = coo_array((np.ones(len(doors)), (doors[:, 0], doors[:, 1])), shape=(count, count))
    parts, part = connected_components(joined, directed=False)
    part = part.astype(np.int64)
    (ax, ay), (bx, by), (cx, cy) = (corner[:, k].T for k in range(3))
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    order = np.lexsort((-area, part))
    largest = order[np.searchsorted(part[order], np.arange(parts))]
    rows = solid_rows(map.solids)
    solid = [inside_rows(rows, x, y) for x, y in corner[largest].mean(axis=1).tolist()]
    free: IntArray = np.where(np.array(solid, np.bool_)[part], -1, part)
    return free


@kernel_without_allocation
def nearest(mesh: Mesh, part: int, x: float, y: float) -> tuple[int, float, float, float]:
    """Return (triangle, its x, y, distance [m]) nearest to a point; -1 if there are none.

    With ``part`` ≥ 0, only triangles of that part count.
    """
    found, fx, fy, least = -1, x, y, math.inf
    for t in range(len(mesh.corner)):
        if mesh.part[t] < 0 or (part >= 0 and mesh.part[t] != part):
            continue
        inside = True
        for k in range(3):
            ax, ay = mesh.corner[t, k, 0], mesh.corner[t, k, 1]
            bx, by = mesh.corner[t, (k + 1) % 3, 0], mesh.corner[t, (k + 1) % 3, 1]
            dx, dy = bx - ax, by - ay
            if dx * (y - ay) - dy * (x - ax) >= 0.0:
                continue
            inside = False
            share = (dx * (x - ax) + dy * (y - ay)) / (dx * dx + dy * dy)
            share = min(max(share, 0.0), 1.0)
            qx, qy = ax + share * dx, ay + share * dy
            far = math.sqrt((x - qx) * (x - qx) + (y - qy) * (y - qy))
            if far < least:
                found, fx, fy, least = t, qx, qy, far
        if inside:
            return t, x, y, 0.0
    return found, fx, fy, least
