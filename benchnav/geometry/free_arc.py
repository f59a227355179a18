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
from benchnav.kernels import kernel

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
    circles = _circles(grid.capsules, grid.reach)
    rows = _free_parts(grid, circles)
    low, width = rows[:, 3].copy(), rows[:, 4].copy()
    at = low + 0.5 * width
    middle = np.stack([np.cos(at), np.sin(at)], axis=1)
    spread = np.where(width >= TWO_PI, -2.0, np.cos(0.5 * width))
    return Arcs(rows[:, :2].copy(), rows[:, 2].copy(), low, width, middle, spread)


def _circles(capsules: FloatArray, reach: FloatArray) -> FloatArray:
    """Return circles (C, 3) x, y, radius around every capsule end, without inward corners.

    Edges are in loop order with the solid on the left, so a path cannot touch a corner
    that turns right.
    """
    if len(capsules) == 0:
        return np.zeros((0, 3))
    begin, end = capsules[:, :2], capsules[:, 2:4]
    index = np.arange(len(capsules))
    breaks = np.concatenate([[True], np.any(begin[1:] != end[:-1], axis=1)])
    first = np.flatnonzero(breaks)
    last = np.append(first[1:], len(capsules)) - 1
    before = index - 1
    before[first] = last
    closed = np.all(begin == end[before], axis=1)
    along, into = end - begin, (end - begin)[before]
    cross = into[:, 0] * along[:, 1] - into[:, 1] * along[:, 0]
    size = np.sqrt((along**2).sum(axis=1) * (into**2).sum(axis=1))
    straight = (np.abs(cross) <= 1e-12 * size) & ((into * along).sum(axis=1) > 0.0)
    edge = size > 0.0
    inward = closed & edge & ((cross < -1e-12 * size) | straight)
    open_end = np.ones(len(capsules), bool)
    open_end[before[closed]] = False
    ends = np.vstack(
        [np.column_stack([begin, reach])[~inward], np.column_stack([end, reach])[open_end]]
    )
    # np.unique(ends, axis=0), which takes five times as long
    ordered = ends[np.lexsort(ends.T[::-1])]
    another = np.ones(len(ordered), np.bool_)
    another[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    return ordered[another]


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


@kernel
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


@kernel
def _is_free(grid: CapsuleGrid, near: IntArray, x: float, y: float) -> bool:
    for p in near:
        c, reach = grid.capsules[p], grid.reach[p] - SLACK
        qx, qy = nearest_on_segment(x, y, c[0], c[1], c[2], c[3])
        if (x - qx) * (x - qx) + (y - qy) * (y - qy) < reach * reach:
            return False
    return True
