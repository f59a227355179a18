"""Free arcs: the parts of circles around corners along which a disc can move.

The disc's centre stays out of the capsules grown by its radius. The boundary of the remaining
free space consists of straight pieces and of arcs around the capsules' ends; shortest
paths bend on these arcs only.
"""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.geometry.capsule_grid import SLACK, CapsuleGrid, doubled, nearby
from benchnav.kernels import kernel, kernel_without_allocation

TWO_PI = 2.0 * math.pi
_NARROW = 1e-9  # [rad] narrower arcs are ignored
_TANGENT = 1e-12  # tolerance of a cosine of ±1: two curves that touch


class Arcs(NamedTuple):
    """Free arcs of circles."""

    center: FloatArray  # (N, 2) [m]
    radius: FloatArray  # (N,) [m]
    low: FloatArray  # (N,) [rad] angle where it begins
    width: FloatArray  # (N,) [rad], 2 pi for a full circle
    middle: FloatArray  # (N, 2) unit vector to its middle
    spread: FloatArray  # (N,) cosine of half its width; -2 for a full circle


def free_arcs(grid: CapsuleGrid) -> Arcs:
    """Return the arcs around the ends of the grid's capsules that no capsule covers."""
    ends = _ends(grid.capsules, grid.reach)
    ordered = ends[np.lexsort(ends.T[::-1])]
    found: Arcs = _free_arcs(grid, ordered)
    return found


@kernel
def _ends(capsules: FloatArray, reach: FloatArray) -> FloatArray:
    """Return circles (C, 3) x, y, radius around every capsule end, without inward corners.

    Edges are in loop order with the solid on the left, so a path cannot touch a corner
    that turns right.
    """
    count, c = len(capsules), capsules
    before, is_open = np.empty(count, np.int64), np.ones(count, np.bool_)
    first = 0
    for k in range(count):
        before[k] = k - 1
        if k + 1 == count or c[k + 1, 0] != c[k, 2] or c[k + 1, 1] != c[k, 3]:
            before[first], first = k, k + 1
    ends, found = np.empty((2 * count, 3)), 0
    for k in range(count):
        b = before[k]
        closed = c[k, 0] == c[b, 2] and c[k, 1] == c[b, 3]
        ax, ay, ix, iy = c[k, 2] - c[k, 0], c[k, 3] - c[k, 1], c[b, 2] - c[b, 0], c[b, 3] - c[b, 1]
        cross = ix * ay - iy * ax
        size = math.sqrt((ax * ax + ay * ay) * (ix * ix + iy * iy))
        straight = abs(cross) <= 1e-12 * size and ix * ax + iy * ay > 0.0
        if closed:
            is_open[b] = False
        if not (closed and size > 0.0 and (cross < -1e-12 * size or straight)):
            ends[found, 0], ends[found, 1], ends[found, 2] = c[k, 0], c[k, 1], reach[k]
            found += 1
    for k in range(count):
        if is_open[k]:
            ends[found, 0], ends[found, 1], ends[found, 2] = c[k, 2], c[k, 3], reach[k]
            found += 1
    return ends[:found]


@kernel
def _free_arcs(grid: CapsuleGrid, ends: FloatArray) -> Arcs:
    """Return the free arcs of circles (C, 3), sorted and perhaps repeated."""
    rows = _free_parts(grid, _unique(ends))
    count = len(rows)
    center, radius, low = rows[:, :2].copy(), rows[:, 2].copy(), rows[:, 3].copy()
    width, middle, spread = rows[:, 4].copy(), np.empty((count, 2)), np.empty(count)
    for k in range(count):
        at = low[k] + 0.5 * width[k]
        middle[k, 0], middle[k, 1] = math.cos(at), math.sin(at)
        spread[k] = -2.0 if width[k] >= TWO_PI else math.cos(0.5 * width[k])
    return Arcs(center, radius, low, width, middle, spread)


@kernel
def _unique(rows: FloatArray) -> FloatArray:
    """Return sorted rows (C, 3) without repetitions."""
    kept, count = np.empty(rows.shape), 0
    for k in range(len(rows)):
        x, y, radius = rows[k, 0], rows[k, 1], rows[k, 2]
        at = count - 1
        if at < 0 or x != kept[at, 0] or y != kept[at, 1] or radius != kept[at, 2]:
            kept[count, 0], kept[count, 1], kept[count, 2] = x, y, radius
            count += 1
    return kept[:count]


@kernel
def _free_parts(grid: CapsuleGrid, circles: FloatArray) -> FloatArray:
    """Return the free parts (N, 5) x, y, radius, low, width of circles (C, 3)."""
    rows = np.empty((16, 5))
    count = 0
    for index in range(len(circles)):
        x, y, radius = circles[index, 0], circles[index, 1], circles[index, 2]
        near = nearby(grid, x, y, radius)
        angles = _crossings(grid, near, x, y, radius)
        size = len(angles) - 1  # the last angle is the first one plus a full turn
        free = np.empty(size, np.bool_)
        for k in range(size):
            at = 0.5 * (angles[k] + angles[k + 1])
            free[k] = _is_free(grid, near, x + radius * math.cos(at), y + radius * math.sin(at))
        first = 0  # a piece after a covered piece, if there is one
        while first < size and free[first - 1]:
            first += 1
        k = 0
        while k < size:
            low, width = angles[(first + k) % size], 0.0
            while k < size and free[(first + k) % size]:
                width += angles[(first + k) % size + 1] - angles[(first + k) % size]
                k += 1
            k += 1
            if width > 0.0:
                if count == len(rows):
                    rows = doubled(rows)
                rows[count, 0], rows[count, 1], rows[count, 2] = x, y, radius
                rows[count, 3], rows[count, 4] = low, (TWO_PI if first == size else width)
                count += 1
    return rows[:count]


@kernel
def _crossings(grid: CapsuleGrid, near: IntArray, x: float, y: float, radius: float) -> FloatArray:
    """Return the angles where a circle may enter or leave a grown capsule, ascending.

    There is at least one, and no two are closer than ``_NARROW``; the last is the
    first plus a full turn.
    """
    angles = np.empty(8 * len(near) + 1)
    count = 0
    for p in near:
        c, reach = grid.capsules[p], grid.reach[p]
        for end in range(2):
            dx, dy = c[2 * end] - x, c[2 * end + 1] - y
            d = math.sqrt(dx * dx + dy * dy)
            if d > 1e-12:
                k = (radius * radius + d * d - reach * reach) / (2.0 * radius * d)
                count = _add(angles, count, math.atan2(dy, dx), k)
        dx, dy = c[2] - c[0], c[3] - c[1]
        d = math.sqrt(dx * dx + dy * dy)
        if d > 0.0:
            nx, ny = -dy / d, dx / d
            off = nx * (x - c[0]) + ny * (y - c[1])
            facing = math.atan2(ny, nx)
            count = _add(angles, count, facing, (reach - off) / radius)
            count = _add(angles, count, facing, (-reach - off) / radius)
    if count == 0:
        return np.array([0.0, TWO_PI])
    for k in range(1, count):  # insertion sort: there are few
        angle, at = angles[k], k
        while at > 0 and angles[at - 1] > angle:
            angles[at] = angles[at - 1]
            at -= 1
        angles[at] = angle
    size = 1
    for k in range(1, count):
        if angles[k] - angles[size - 1] > _NARROW and angles[k] < angles[0] + TWO_PI - _NARROW:
            angles[size] = angles[k]
            size += 1
    angles[size] = angles[0] + TWO_PI
    return angles[: size + 1]


@kernel_without_allocation
def _add(angles: FloatArray, count: int, facing: float, cosine: float) -> int:
    """Append facing ± arccos(cosine) in [0, 2 pi), if defined; return the new count."""
    if abs(cosine) > 1.0 + _TANGENT:
        return count
    if abs(cosine) > 1.0 - _TANGENT:
        cosine = 1.0 if cosine > 0.0 else -1.0
    turn = math.acos(cosine)
    angles[count] = (facing + turn) % TWO_PI
    angles[count + 1] = (facing - turn) % TWO_PI
    return count + 2


@kernel_without_allocation
def _is_free(grid: CapsuleGrid, near: IntArray, x: float, y: float) -> bool:
    for k in range(len(near)):
        p, c = near[k], grid.capsules
        reach = grid.reach[p] - SLACK
        qx, qy = nearest_on_segment(x, y, c[p, 0], c[p, 1], c[p, 2], c[p, 3])
        if (x - qx) * (x - qx) + (y - qy) * (y - qy) < reach * reach:
            return False
    return True
