"""Straight motions that touch free arcs: from arc to arc, and from a point to arcs."""

import math

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.geometry.arc_sight import arc_cells, arcs_in_sight
from benchnav.geometry.capsule_grid import CapsuleGrid, doubled, is_clear
from benchnav.geometry.free_arc import TWO_PI, Arcs
from benchnav.kernels import kernel, kernel_without_allocation

FEW = 256  # arcs, so few that all pairs are tested
_ON_ARC = 1e-12  # tolerance of the cosine in the test whether a tangent point is on an arc


@kernel_without_allocation
def _on_arc(arcs: Arcs, k: int, ux: float, uy: float) -> bool:
    cosine: float = ux * arcs.middle[k, 0] + uy * arcs.middle[k, 1]
    least: float = arcs.spread[k] - _ON_ARC
    return cosine >= least


@kernel_without_allocation
def _angle_on(arcs: Arcs, k: int, ux: float, uy: float) -> float:
    """Return the angle [rad] from the beginning of arc k to the direction u, side is on the arc."""
    turn: float = (math.atan2(uy, ux) - arcs.low[k]) % TWO_PI
    width: float = arcs.width[k]
    if turn <= width:
        return turn
    return 0.0 if turn - width > 0.5 * (TWO_PI - width) else width


@kernel
def bitangents(grid: CapsuleGrid, arcs: Arcs, few: int = FEW) -> FloatArray:
    """Return all free tangents of two arcs (M, 5): arc i, angle on i, arc j, angle on j, length.

    The first ``few`` arcs are tested with all before them, the others only with those in sight.
    """
    rows = np.empty((256, 5))
    i, count, size = 0, 0, len(arcs.radius)
    while i < min(size, few):
        i, count = _add_all_tangents(grid, arcs, i, min(size, few), rows, count)
        if i < min(size, few):
            rows = doubled(rows)
    if size <= few:
        return rows[:count]
    cells = arc_cells(grid, arcs)
    for i in range(few, size):
        for j in arcs_in_sight(grid, cells, arcs, i):
            if count + 4 > len(rows):
                rows = doubled(rows)
            count = _add_tangents(grid, arcs, i, j, rows, count)
    return rows[:count]


@kernel_without_allocation
def _add_all_tangents(
    grid: CapsuleGrid, arcs: Arcs, first: int, end: int, rows: FloatArray, count: int
) -> tuple[int, int]:
    """Append the tangents of arcs from ``first`` to ``end`` with all arcs before.

    Return the first arc for which ``rows`` may have too little space, and the new count.
    """
    for i in range(first, end):
        if count + 4 * i > len(rows):
            return i, count
        for j in range(i):
            count = _add_tangents(grid, arcs, i, j, rows, count)
    return end, count


@kernel_without_allocation
def _add_tangents(
    grid: CapsuleGrid, arcs: Arcs, i: int, j: int, rows: FloatArray, count: int
) -> int:
    """Append the free tangents of two arcs to ``rows``; return the new count."""
    dx = arcs.center[j, 0] - arcs.center[i, 0]
    dy = arcs.center[j, 1] - arcs.center[i, 1]
    d2 = dx * dx + dy * dy
    if d2 < 1e-24:
        return count
    d = math.sqrt(d2)
    ex, ey = dx / d, dy / d
    for side in range(4):
        inner = 1.0 if side < 2 else -1.0  # the tangent passes between the two arcs
        k = (arcs.radius[i] + inner * arcs.radius[j]) / d
        if abs(k) > 1.0:
            continue
        across = math.sqrt(1.0 - k * k) * (1.0 if side % 2 == 0 else -1.0)
        ux, uy = k * ex - across * ey, k * ey + across * ex
        vx, vy = -inner * ux, -inner * uy
        if not _on_arc(arcs, i, ux, uy) or not _on_arc(arcs, j, vx, vy):
            continue
        ax = arcs.center[i, 0] + arcs.radius[i] * ux
        ay = arcs.center[i, 1] + arcs.radius[i] * uy
        bx = arcs.center[j, 0] + arcs.radius[j] * vx
        by = arcs.center[j, 1] + arcs.radius[j] * vy
        if not is_clear(grid, ax, ay, bx, by):
            continue
        length = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
        rows[count, 0], rows[count, 1] = i, _angle_on(arcs, i, ux, uy)
        rows[count, 2], rows[count, 3] = j, _angle_on(arcs, j, vx, vy)
        rows[count, 4] = length
        count += 1
    return count


@kernel
def point_tangents(grid: CapsuleGrid, arcs: Arcs, px: float, py: float, short: float) -> FloatArray:
    """Return the free tangents from a point (L, 3): arc, angle on it, length.

    The motion ends ``short`` [m] before the point and must be free up to there;
    tangents that are no longer than ``short`` are omitted.
    """
    rows = np.empty((2 * len(arcs.radius), 3))
    return rows[: _add_point_tangents(grid, arcs, px, py, short, rows)]


@kernel_without_allocation
def _add_point_tangents(
    grid: CapsuleGrid, arcs: Arcs, px: float, py: float, short: float, rows: FloatArray
) -> int:
    """Write the rows of `point_tangents`, and return their number."""
    count = 0
    for k in range(len(arcs.radius)):
        dx, dy = px - arcs.center[k, 0], py - arcs.center[k, 1]
        d = math.sqrt(dx * dx + dy * dy)
        radius = arcs.radius[k]
        if d < radius - 1e-7:
            continue
        cosine = min(radius / d, 1.0)
        length = math.sqrt(max(d * d - radius * radius, 0.0))
        if short > 0.0 and length <= short:
            continue
        ex, ey = dx / d, dy / d
        for side in range(2):
            sine = math.sqrt(1.0 - cosine * cosine) * (1.0 if side == 0 else -1.0)
            ux, uy = cosine * ex - sine * ey, cosine * ey + sine * ex
            if not _on_arc(arcs, k, ux, uy):
                continue
            ax, ay = arcs.center[k, 0] + radius * ux, arcs.center[k, 1] + radius * uy
            part = (length - short) / length if length > 0.0 else 0.0
            if is_clear(grid, ax, ay, ax + part * (px - ax), ay + part * (py - ay)):
                rows[count, 0], rows[count, 1] = k, _angle_on(arcs, k, ux, uy)
                rows[count, 2] = length - short
                count += 1
    return count
