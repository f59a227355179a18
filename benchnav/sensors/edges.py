"""The nearest edges of walls and static obstacles that face the agent and are in sight."""

import math
from typing import Any

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.geometry.rotation import cos_sin
from benchnav.kernels import kernel
from benchnav.sensors.sight import FEW, in_sight

CANDIDATES = 64  # nearest facing edges of which the visible ones are kept
_STATIC = int(Kind.STATIC)
_EIGHTH = math.pi / 4.0
_OCTAGON = 1.0 / math.cos(math.pi / 8.0)  # circumradius of the octagon about a unit disc
END = 0.001  # where an end of an edge is looked at, as a share of its length
BEFORE = 1.0 - 1e-6  # of the way to a point that is looked at


@kernel
def find_edges(
    low: int, high: int, chosen: IntArray, limit: float, occlusion: bool, worlds: AnyArray,
    agents: AnyArray, bodies: AnyArray, shapes: AnyArray, capsules: AnyArray, start: IntArray,
    item: IntArray, first: FloatArray, second: FloatArray, before: FloatArray, after: FloatArray,
    first_convex: BoolArray, second_convex: BoolArray, count: IntArray,
) -> None:  # fmt: skip
    """Rows low:high of the flattened (B, chosen agents); outputs are (B, An, E, …)."""
    width, most = first.shape[1], first.shape[2]
    best = np.empty(CANDIDATES)
    found = np.empty((CANDIDATES, 12))  # x0 y0 x1 y1, before, after, convex flags, nearest point
    for b in range(low // width, (high + width - 1) // width):
        world, here, others = worlds[b], agents[b], bodies[b]
        for k in range(max(low - b * width, 0), min(high - b * width, width)):
            i, kept = chosen[b, k], 0
            if i < 0 or not here[i].present:
                continue
            a = here[i]
            n = _gather(a, limit, world, others, shapes, capsules, start, item, best, found)
            for s in range(n):
                if kept == most:
                    break
                if occlusion and not _visible(
                    a, found, s, world, capsules, start, item, others, shapes
                ):
                    continue
                for t in range(2):
                    first[b, k, kept, t], second[b, k, kept, t] = found[s, t], found[s, 2 + t]
                    before[b, k, kept, t], after[b, k, kept, t] = found[s, 4 + t], found[s, 6 + t]
                first_convex[b, k, kept] = found[s, 8] > 0.0
                second_convex[b, k, kept] = found[s, 9] > 0.0
                kept += 1
            count[b, k] = kept


@kernel
def _visible(
    a: Any, found: FloatArray, s: int, world: Any, capsules: AnyArray, start: IntArray,
    item: IntArray, bodies: AnyArray, shapes: AnyArray,
) -> bool:  # fmt: skip
    """Is the nearest point of edge s, its middle, or one of its ends in sight?

    A point is looked at from just before it, so that the edge does not hide itself.
    """
    for look in range(4):
        x, y = found[s, 10], found[s, 11]
        if look > 0:
            u = 0.5 if look == 1 else (END if look == 2 else 1.0 - END)
            x = found[s, 0] + u * (found[s, 2] - found[s, 0])
            y = found[s, 1] + u * (found[s, 3] - found[s, 1])
        x, y = a.x + (x - a.x) * BEFORE, a.y + (y - a.y) * BEFORE
        if in_sight(a.x, a.y, x, y, -1, world, capsules, start, item, bodies, shapes):
            return True
    return False


@kernel
def _gather(
    a: Any, limit: float, world: Any, bodies: AnyArray, shapes: AnyArray, capsules: AnyArray,
    start: IntArray, item: IntArray, best: FloatArray, found: FloatArray,
) -> int:  # fmt: skip
    """The nearest facing edges within ``limit``, sorted; returns how many."""
    n = 0
    if world.last - world.first <= FEW:
        for p in range(world.first, world.last):
            n = _consider(a, 0.0, 0.0, p, capsules, limit, n, best, found)
    else:
        n = _gather_cells(a, limit, world, capsules, start, item, best, found)
    for m in range(world.bodies):
        body = bodies[m]
        if body.kind == _STATIC:
            for q in range(body.first, body.last):
                n = _consider(a, body.x, body.y, q, shapes, limit, n, best, found)
    return n


@kernel
def _gather_cells(
    a: Any, limit: float, world: Any, capsules: AnyArray, start: IntArray, item: IntArray,
    best: FloatArray, found: FloatArray,
) -> int:  # fmt: skip
    """Over the cells within ``limit``; a capsule counts in the cell of its point nearest to a."""
    n, side = 0, world.side
    i0 = max(0, math.floor((a.x - limit - world.origin_x) / side))
    j0 = max(0, math.floor((a.y - limit - world.origin_y) / side))
    i1 = min(world.nx - 1, math.floor((a.x + limit - world.origin_x) / side))
    j1 = min(world.ny - 1, math.floor((a.y + limit - world.origin_y) / side))
    for i in range(i0, i1 + 1):
        for j in range(j0, j1 + 1):
            cell = world.grid + i * world.ny + j
            for at in range(start[cell], start[cell + 1]):
                c = capsules[item[at]]
                x, y = nearest_on_segment(a.x, a.y, c.x0, c.y0, c.x1, c.y1)
                ci = math.floor((x - world.origin_x) / side)
                cj = math.floor((y - world.origin_y) / side)
                if ci == i and cj == j:
                    n = _consider(a, 0.0, 0.0, item[at], capsules, limit, n, best, found)
    return n


@kernel
def _consider(
    a: Any, ox: float, oy: float, p: int, capsules: AnyArray, limit: float, n: int,
    best: FloatArray, found: FloatArray,
) -> int:  # fmt: skip
    """Insert edge p of ``capsules`` (shifted by (ox, oy)), or the octagon about a disc."""
    c = capsules[p]
    if c.before >= 0:
        prior, later = capsules[c.before], capsules[c.after]
        bx, by = _direction(prior)
        dx, dy = _direction(c)
        ax, ay = _direction(later)
        turn_0, turn_1 = bx * dy - by * dx, dx * ay - dy * ax
        return _offer(
            a, ox + c.x0, oy + c.y0, ox + c.x1, oy + c.y1, bx, by, ax, ay,
            turn_0 >= 0.0, turn_1 >= 0.0, limit, n, best, found,
        )  # fmt: skip
    radius = c.r * _OCTAGON
    for k in range(8):
        c0, s0 = cos_sin((k - 0.5) * _EIGHTH)
        c1, s1 = cos_sin((k + 0.5) * _EIGHTH)
        cb, sb = cos_sin((k + 1.0) * _EIGHTH)
        ca, sa = cos_sin((k + 3.0) * _EIGHTH)
        x, y = ox + c.x0, oy + c.y0
        n = _offer(
            a, x + radius * c0, y + radius * s0, x + radius * c1, y + radius * s1,
            cb, sb, ca, sa, True, True, limit, n, best, found,
        )  # fmt: skip
    return n


@kernel
def _direction(c: Any) -> tuple[float, float]:
    dx, dy = c.x1 - c.x0, c.y1 - c.y0
    length = math.sqrt(dx * dx + dy * dy)
    return (dx / length, dy / length) if length > 0.0 else (0.0, 0.0)


@kernel
def _offer(
    a: Any, x0: float, y0: float, x1: float, y1: float, bx: float, by: float, ax: float, ay: float,
    convex_0: bool, convex_1: bool, limit: float, n: int, best: FloatArray, found: FloatArray,
) -> int:  # fmt: skip
    """Insert an edge if agent a is on its free (right-hand) side and near enough."""
    if (x1 - x0) * (a.y - y0) - (y1 - y0) * (a.x - x0) >= 0.0:
        return n
    qx, qy = nearest_on_segment(a.x, a.y, x0, y0, x1, y1)
    d2 = (a.x - qx) * (a.x - qx) + (a.y - qy) * (a.y - qy)
    if d2 > limit * limit or (n == len(best) and d2 >= best[n - 1]):
        return n
    if n < len(best):
        n += 1
    at = n - 1
    while at > 0 and best[at - 1] > d2:
        best[at] = best[at - 1]
        found[at, :] = found[at - 1, :]
        at -= 1
    best[at] = d2
    row = found[at]
    row[0], row[1], row[2], row[3] = x0, y0, x1, y1
    row[4], row[5], row[6], row[7] = bx, by, ax, ay
    row[8], row[9] = (1.0 if convex_0 else -1.0), (1.0 if convex_1 else -1.0)
    row[10], row[11] = qx, qy
    return n
