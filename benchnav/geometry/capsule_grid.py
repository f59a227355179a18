"""Capsules sorted into cells of a uniform grid, to test whether a motion of a disc is free."""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.geometry.sweep import segment_distance2
from benchnav.kernels import kernel, kernel_without_allocation

SLACK = 1e-8  # [m] overlap that counts as touching, so that rounding closes no passage
_MAX_SIDE = 512  # cells along an axis


class CapsuleGrid(NamedTuple):
    """Capsules grown by a disc's radius; each cell lists the capsules that reach into it."""

    capsules: FloatArray  # (P, 5)
    reach: FloatArray  # (P,) [m] radius of the capsule + radius of the disc
    start: IntArray  # (nx ny + 1,) first item of each cell
    item: IntArray  # capsule indices by cell
    x: float  # [m] lower left corner of the grid
    y: float
    side: float  # [m] of a cell
    nx: int
    ny: int


def capsule_grid(capsules: FloatArray, radius: float) -> CapsuleGrid:
    """Return the grid of capsules (P, 5) for a disc of ``radius`` [m]."""
    capsules = np.ascontiguousarray(capsules, np.float64).reshape(-1, 5)
    reach = capsules[:, 4] + radius
    if len(capsules) == 0:
        empty = np.zeros(0, np.int64)
        return CapsuleGrid(capsules, reach, np.zeros(2, np.int64), empty, 0.0, 0.0, 1.0, 1, 1)
    x, y, wide, tall = _extent(capsules, reach)
    side = max(math.sqrt(wide * tall / len(capsules)), max(wide, tall) / (_MAX_SIDE - 1))
    nx, ny = int(wide / side) + 1, int(tall / side) + 1
    start, item = _sorted(capsules, reach, x, y, side, nx, ny)
    return CapsuleGrid(capsules, reach, start, item, x, y, side, nx, ny)


@kernel_without_allocation
def _extent(capsules: FloatArray, reach: FloatArray) -> tuple[float, float, float, float]:
    """Return the lower left corner, width and height [m] of all grown capsules."""
    x0, y0, x1, y1 = math.inf, math.inf, -math.inf, -math.inf
    for p in range(len(capsules)):
        x0 = min(x0, min(capsules[p, 0], capsules[p, 2]) - reach[p])
        y0 = min(y0, min(capsules[p, 1], capsules[p, 3]) - reach[p])
        x1 = max(x1, max(capsules[p, 0], capsules[p, 2]) + reach[p])
        y1 = max(y1, max(capsules[p, 1], capsules[p, 3]) + reach[p])
    return x0, y0, x1 - x0, y1 - y0


@kernel
def _sorted(
    capsules: FloatArray, reach: FloatArray, x: float, y: float, side: float, nx: int, ny: int
) -> tuple[IntArray, IntArray]:
    """Sort capsules by counting into every cell that they reach, ascending within a cell."""
    start = np.zeros(nx * ny + 1, np.int64)
    item = np.zeros(0, np.int64)
    for fill in range(2):
        for p in range(len(capsules)):
            x0, y0, x1, y1 = capsules[p, 0], capsules[p, 1], capsules[p, 2], capsules[p, 3]
            far = reach[p] + 0.7072 * side
            i0 = max(0, int((min(x0, x1) - reach[p] - x) / side))
            i1 = min(nx - 1, int((max(x0, x1) + reach[p] - x) / side))
            j0 = max(0, int((min(y0, y1) - reach[p] - y) / side))
            j1 = min(ny - 1, int((max(y0, y1) + reach[p] - y) / side))
            for i in range(i0, i1 + 1):
                for j in range(j0, j1 + 1):
                    cx, cy = x + (i + 0.5) * side, y + (j + 0.5) * side
                    qx, qy = nearest_on_segment(cx, cy, x0, y0, x1, y1)
                    if (cx - qx) * (cx - qx) + (cy - qy) * (cy - qy) <= far * far:
                        k = i * ny + j
                        if fill == 0:
                            start[k + 1] += 1
                        else:
                            item[start[k]] = p
                            start[k] += 1
        if fill == 0:
            for k in range(nx * ny):
                start[k + 1] += start[k]
            item = np.zeros(start[nx * ny], np.int64)
    for k in range(nx * ny, 0, -1):
        start[k] = start[k - 1]
    start[0] = 0
    return start, item


@kernel_without_allocation
def is_clear(grid: CapsuleGrid, ax: float, ay: float, bx: float, by: float) -> bool:
    """Whether the disc can move straight from a to b; touching is allowed."""
    if ax > bx:
        ax, ay, bx, by = bx, by, ax, ay
    side, wide = grid.side, bx - ax
    dx, dy = bx - ax, by - ay
    length = math.sqrt(dx * dx + dy * dy)
    i0 = max(0, math.floor((ax - grid.x) / side - 1e-9))
    i1 = min(grid.nx - 1, math.floor((bx - grid.x) / side + 1e-9))
    for i in range(i0, i1 + 1):
        # the piece of ab over this column of cells
        t0, t1 = 0.0, 1.0
        if wide > 0.0:
            t0 = min(max((grid.x + i * side - ax) / wide - 1e-9, 0.0), 1.0)
            t1 = min(max((grid.x + (i + 1) * side - ax) / wide + 1e-9, 0.0), 1.0)
        y0, y1 = ay + t0 * (by - ay), ay + t1 * (by - ay)
        j0 = max(0, math.floor((min(y0, y1) - grid.y) / side - 1e-9))
        j1 = min(grid.ny - 1, math.floor((max(y0, y1) - grid.y) / side + 1e-9))
        for j in range(j0, j1 + 1):
            cell = i * grid.ny + j
            for k in range(grid.start[cell], grid.start[cell + 1]):
                p = grid.item[k]
                reach = grid.reach[p] - SLACK
                x0, y0 = grid.capsules[p, 0], grid.capsules[p, 1]
                x1, y1 = grid.capsules[p, 2], grid.capsules[p, 3]
                left = dx * (y0 - ay) - dy * (x0 - ax)
                if left * (dx * (y1 - ay) - dy * (x1 - ax)) > 0.0:  # both ends on one side
                    far = length * grid.reach[p]
                    if abs(left) > far and abs(dx * (y1 - ay) - dy * (x1 - ax)) > far:
                        continue
                if segment_distance2(ax, ay, bx, by, x0, y0, x1, y1) < reach * reach:
                    return False
    return True


@kernel
def nearby(grid: CapsuleGrid, x: float, y: float, radius: float) -> IntArray:
    """Return all capsules within ``radius`` of a point, perhaps with others and duplicates."""
    side = grid.side
    i0 = max(0, math.floor((x - radius - grid.x) / side))
    i1 = min(grid.nx - 1, math.floor((x + radius - grid.x) / side))
    j0 = max(0, math.floor((y - radius - grid.y) / side))
    j1 = min(grid.ny - 1, math.floor((y + radius - grid.y) / side))
    count = 0
    for i in range(i0, i1 + 1):
        for j in range(j0, j1 + 1):
            count += grid.start[i * grid.ny + j + 1] - grid.start[i * grid.ny + j]
    found = np.empty(count, np.int64)
    count = 0
    for i in range(i0, i1 + 1):
        for j in range(j0, j1 + 1):
            cell = i * grid.ny + j
            for k in range(grid.start[cell], grid.start[cell + 1]):
                found[count] = grid.item[k]
                count += 1
    return found


@kernel
def doubled(rows: FloatArray) -> FloatArray:
    """Return the same rows with space for twice as many."""
    more = np.empty((2 * rows.shape[0], rows.shape[1]))
    for i in range(rows.shape[0]):
        for j in range(rows.shape[1]):
            more[i, j] = rows[i, j]
    return more
