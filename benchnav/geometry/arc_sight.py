"""Which free arcs may have a free tangent with another, found ring by ring of grid cells.

The search around an arc ends where capsules nearby block all directions in which a motion can
leave it, so that the tangents of a large map are found without a test of every pair.
"""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arrays import BoolArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.geometry.capsule_grid import SLACK, CapsuleGrid
from benchnav.geometry.free_arc import TWO_PI, Arcs
from benchnav.kernels import kernel

_BINS = 256  # directions that an arc's angles are divided into
_MARGIN = 1e-5  # [rad] by which the ends of an arc are uncertain
_DIAGONAL = 1.4143


class ArcCells(NamedTuple):
    """Free arcs by the grid cell of their centres, and which arc last met each capsule."""

    start: IntArray  # (nx ny + 1,) first item of each cell
    item: IntArray  # arc indices by cell, ascending within a cell
    widest: float  # [m] largest radius of an arc
    met: IntArray  # (P,) arc whose search has the whole capsule marked


@kernel
def arc_cells(grid: CapsuleGrid, arcs: Arcs) -> ArcCells:
    """Sort arcs by counting."""
    start = np.zeros(grid.nx * grid.ny + 1, np.int64)
    cell = np.empty(len(arcs.radius), np.int64)
    widest = 0.0
    for k in range(len(cell)):
        i, j = _cell(grid, arcs.center[k, 0], arcs.center[k, 1])
        cell[k] = i * grid.ny + j
        start[cell[k] + 1] += 1
        widest = max(widest, arcs.radius[k])
    start = np.cumsum(start)
    free, item = start.copy(), np.empty(len(cell), np.int64)
    for k in range(len(cell)):
        item[free[cell[k]]] = k
        free[cell[k]] += 1
    return ArcCells(start, item, widest, np.full(len(grid.reach), -1))


@kernel
def arcs_in_sight(grid: CapsuleGrid, cells: ArcCells, arcs: Arcs, k: int) -> IntArray:
    """Return the arcs before arc k, ascending, except those that no free tangent joins with it."""
    x, y, radius = arcs.center[k, 0], arcs.center[k, 1], arcs.radius[k]
    i, j = _cell(grid, x, y)
    blocked = np.zeros((2, _BINS), np.bool_)  # directions in which the arc is right, left behind
    found, count = np.empty(64, np.int64), 0
    marked = 0  # rings whose capsules are marked in `blocked`
    for ring in range(max(max(i, grid.nx - 1 - i), max(j, grid.ny - 1 - j)) + 1):
        for c in _ring(grid, i, j, ring):
            for n in range(cells.start[c], cells.start[c + 1]):
                if cells.item[n] >= k:
                    break
                if count == len(found):
                    found = np.concatenate((found, found))
                found[count] = cells.item[n]
                count += 1
        # every other arc is farther than this, and a motion to it longer than `least`
        far = min(
            min(x - (grid.x + (i - ring) * grid.side), grid.x + (i + ring + 1) * grid.side - x),
            min(y - (grid.y + (j - ring) * grid.side), grid.y + (j + ring + 1) * grid.side - y),
        )
        if far <= radius + cells.widest:
            continue
        least = math.sqrt(far * far - (radius + cells.widest) ** 2)
        while (marked + 1) * grid.side * _DIAGONAL < least:
            for c in _ring(grid, i, j, marked):
                for n in range(grid.start[c], grid.start[c + 1]):
                    p = grid.item[n]
                    if cells.met[p] != k and _block(grid, p, arcs, k, least, blocked):
                        cells.met[p] = k
            marked += 1
        if blocked.all():
            break
    return np.sort(found[:count])


@kernel
def _cell(grid: CapsuleGrid, x: float, y: float) -> tuple[int, int]:
    i = min(max(int((x - grid.x) / grid.side), 0), grid.nx - 1)
    j = min(max(int((y - grid.y) / grid.side), 0), grid.ny - 1)
    return i, j


@kernel
def _ring(grid: CapsuleGrid, i: int, j: int, ring: int) -> IntArray:
    """Return the cells of the grid that are ``ring`` columns or rows away from cell (i, j)."""
    found, count = np.empty(max(8 * ring, 1), np.int64), 0
    for a in range(max(i - ring, 0), min(i + ring, grid.nx - 1) + 1):
        edge = a == i - ring or a == i + ring
        for b in range(j - ring, j + ring + 1, 1 if edge else max(2 * ring, 1)):
            if 0 <= b < grid.ny:
                found[count] = a * grid.ny + b
                count += 1
    return found[:count]


@kernel
def _block(grid: CapsuleGrid, p: int, arcs: Arcs, k: int, least: float, blocked: BoolArray) -> bool:
    """Mark the directions in which capsule p blocks a motion from arc k within ``least`` [m].

    Returns whether nothing of the capsule is farther away.

    A motion that leaves the arc at the angle ψ passes its centre at the distance of its radius s.
    It meets a point at the distance D in the direction φ if ψ = φ ∓ asin(s / D) ± π/2, with the
    upper signs if the centre lies to its right. Between the two ends of a capsule it meets the
    capsule's axis.
    """
    c, x, y, s = grid.capsules[p], arcs.center[k, 0], arcs.center[k, 1], arcs.radius[k]
    if (c[2] - c[0]) * (y - c[1]) > (x - c[0]) * (c[3] - c[1]):
        return True  # seen from inside the solid: the motion meets another edge before
    nx, ny = nearest_on_segment(x, y, c[0], c[1], c[2], c[3])
    near = math.hypot(nx - x, ny - y)
    if near <= s + SLACK:
        return True
    if near >= least:
        return False
    a, reach_a = _end(x, y, nx, ny, c[0], c[1], near, least)
    b, reach_b = _end(x, y, nx, ny, c[2], c[3], near, least)
    q = grid.reach[p] - 2.0 * SLACK  # the motion must not pass closer to the axis
    for side in range(2):
        sign = 1.0 - 2.0 * side
        middle = a - sign * math.asin(s / reach_a)
        turn = (b - sign * math.asin(s / reach_b) - middle + math.pi) % TWO_PI - math.pi
        a_low, a_high = _width(s, q, reach_a, sign)
        b_low, b_high = _width(s, q, reach_b, sign)
        low = middle + min(a_low, turn + b_low)
        high = middle + max(a_high, turn + b_high)
        _mark(blocked[side], arcs, k, low + sign * 0.5 * math.pi, high - low)
    return max(math.hypot(c[0] - x, c[1] - y), math.hypot(c[2] - x, c[3] - y)) <= least


@kernel
def _end(
    x: float, y: float, nx: float, ny: float, ex: float, ey: float, near: float, least: float
) -> tuple[float, float]:
    """Return (direction, distance) of the point towards (ex, ey) that is still within ``least``."""
    far = math.hypot(ex - x, ey - y)
    if far > least:
        # on the way from the nearest point, distances grow as those from the foot of a line
        dx, dy = ex - nx, ey - ny
        squared = dx * dx + dy * dy
        along = (nx - x) * dx + (ny - y) * dy
        root = math.sqrt(max(along * along + squared * (least * least - near * near), 0.0))
        share = min(max((root - along) / squared, 0.0), 1.0)
        ex, ey = nx + share * dx, ny + share * dy
        far = math.hypot(ex - x, ey - y)
    return math.atan2(ey - y, ex - x), far


@kernel
def _width(s: float, q: float, far: float, sign: float) -> tuple[float, float]:
    """Return the angles by which a disc of radius q is wider than its centre, to both sides."""
    if far <= s + q:
        return 0.0, 0.0
    middle = math.asin(s / far)
    more, less = math.asin((s + q) / far) - middle, middle - math.asin((s - q) / far)
    return (-more, less) if sign > 0.0 else (-less, more)


@kernel
def _mark(bins: BoolArray, arcs: Arcs, k: int, low: float, width: float) -> None:
    """Mark the bins of arc k that lie between the angles ``low`` and ``low`` + ``width``."""
    size = (arcs.width[k] + 2.0 * _MARGIN) / len(bins)
    begin = (low - arcs.low[k] + _MARGIN) % TWO_PI
    for turn in range(2):
        first = math.ceil((begin - turn * TWO_PI + SLACK) / size)
        last = math.floor((begin - turn * TWO_PI + width - SLACK) / size)
        bins[max(int(first), 0) : max(min(int(last), len(bins)), 0)] = True
