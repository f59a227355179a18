"""The nearest edges of walls and static obstacles that face the agent and are in sight.

If any tested point of an edge is in sight, the whole edge within the sensor's range is reported.
"""

import math
from typing import Any

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.geometry.rotation import cos_sin
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.sensors import sight
from benchnav.sensors.sight import in_sight, list_blockers, stand_at

CANDIDATES = 64  # nearest facing edges that are tested for visibility
_STATIC = int(Kind.STATIC)
_EIGHTH = math.pi / 4.0
_OCTAGON = 1.0 / math.cos(math.pi / 8.0)  # circumradius of the octagon about a unit disc
END = 0.001  # distance of the tested end points from the ends, as a share of the edge's length
BEFORE = 1.0 - 1e-6  # share of the way to a tested point


@kernel
def find_edges(
    low: int, high: int, chosen: IntArray, limit: float, bulge: float, occlusion: bool,
    worlds: AnyArray,
    agents: AnyArray, bodies: AnyArray, shapes: AnyArray, capsules: AnyArray, start: IntArray,
    item: IntArray, first: FloatArray, second: FloatArray, before: FloatArray, after: FloatArray,
    first_convex: BoolArray, second_convex: BoolArray, count: IntArray, identity: IntArray,
) -> None:  # fmt: skip
    """Find edges for rows low:high of the flattened (B, chosen agents).

    Outputs are (B, An, E, …). ``bulge`` [m] is the radius of the largest fixed disc. ``identity``
    numbers the edges of a world, and does not depend on the other worlds of the batch.
    """
    best = np.empty(CANDIDATES)  # squared distances, rising
    code = np.empty(CANDIDATES, np.int64)  # 8 (capsule) + side of the octagon, see `_edge`
    _find_in_rows(
        low, high, chosen, limit, bulge, occlusion, worlds, agents, bodies, shapes, capsules, start,
        item, first, second, before, after, first_convex, second_convex, count, identity, best,
        code, np.empty(10), np.empty(sight.TABLE), np.empty(bodies.shape[1], np.int64),
    )  # fmt: skip


@kernel_without_allocation
def _find_in_rows(
    low: int, high: int, chosen: IntArray, limit: float, bulge: float, occlusion: bool,
    worlds: AnyArray,
    agents: AnyArray, bodies: AnyArray, shapes: AnyArray, capsules: AnyArray, start: IntArray,
    item: IntArray, first: FloatArray, second: FloatArray, before: FloatArray, after: FloatArray,
    first_convex: BoolArray, second_convex: BoolArray, count: IntArray, identity: IntArray,
    best: FloatArray, code: IntArray, edge: FloatArray, table: FloatArray, blockers: IntArray,
) -> None:  # fmt: skip
    width, most = first.shape[1], first.shape[2]
    for b in range(low // width, (high + width - 1) // width):
        world, here, others = worlds[b], agents[b], bodies[b]
        size, discs = sight.copy_fixed(world, capsules, table)
        for k in range(max(low - b * width, 0), min(high - b * width, width)):
            i, kept = chosen[b, k], 0
            if i < 0 or not here[i].present:
                continue
            a = here[i]
            stand_at(a.x, a.y, size, table)
            blocker_count = list_blockers(a, limit, world.bodies, others, blockers)
            n = _gather(
                a, limit, bulge, world, others, shapes, capsules, start, item, size, table, best,
                code,
            )  # fmt: skip
            for s in range(n):
                if kept == most:
                    break
                _edge(code[s], capsules, shapes, others, edge)
                _clip(a, limit, edge)
                if occlusion and not _visible(
                    a, edge, world, capsules, start, item, others, shapes, size, discs, table,
                    blocker_count, blockers,
                ):  # fmt: skip
                    continue
                for t in range(2):
                    first[b, k, kept, t], second[b, k, kept, t] = edge[t], edge[2 + t]
                    before[b, k, kept, t], after[b, k, kept, t] = edge[4 + t], edge[6 + t]
                first_convex[b, k, kept] = edge[8] > 0.0
                second_convex[b, k, kept] = edge[9] > 0.0
                identity[b, k, kept] = _identity(code[s], world, others, capsules, shapes)
                kept += 1
            count[b, k] = kept


@kernel_without_allocation
def _visible(
    a: Any, edge: FloatArray, world: Any, capsules: AnyArray, start: IntArray, item: IntArray,
    bodies: AnyArray, shapes: AnyArray, size: int, discs: bool, table: FloatArray,
    blocker_count: int, blockers: IntArray,
) -> bool:  # fmt: skip
    """Whether the nearest point of the edge, its middle, or one of its ends is in sight.

    The line of sight ends just before the point, so that the edge does not hide itself.
    """
    for point in range(4):
        if point == 0:
            x, y = nearest_on_segment(a.x, a.y, edge[0], edge[1], edge[2], edge[3])
        else:
            u = 0.5 if point == 1 else (END if point == 2 else 1.0 - END)
            x, y = edge[0] + u * (edge[2] - edge[0]), edge[1] + u * (edge[3] - edge[1])
        x, y = a.x + (x - a.x) * BEFORE, a.y + (y - a.y) * BEFORE
        if in_sight(
            a.x, a.y, x, y, -1, world, capsules, start, item, bodies, shapes, size, discs, table,
            blocker_count, blockers,
        ):  # fmt: skip
            return True
    return False


@kernel_without_allocation
def _gather(
    a: Any, limit: float, bulge: float, world: Any, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, size: int, table: FloatArray,
    best: FloatArray, code: IntArray,
) -> int:  # fmt: skip
    """Gather the nearest facing edges within ``limit``, sorted; return their number."""
    if size >= 0:
        n = _gather_few(a, limit, world, capsules, size, table, best, code)
    else:
        n = _gather_cells(a, limit, limit + bulge, world, capsules, start, item, best, code)
    for m in range(world.bodies):
        body = bodies[m]
        if body.kind == _STATIC:
            for q in range(body.first, body.last):
                at = len(capsules) + q
                n = _consider(a, body.x, body.y, shapes[q], at, limit, n, best, code)
    return n


@kernel_without_allocation
def _gather_few(
    a: Any, limit: float, world: Any, capsules: AnyArray, size: int, table: FloatArray,
    best: FloatArray, code: IntArray,
) -> int:  # fmt: skip
    """Gather from a table of all fixed capsules."""
    px, py, reach2 = a.x, a.y, limit * limit
    for k in range(size):
        dx, dy = table[sight.DX + k], table[sight.DY + k]
        along = -(dx * table[sight.FROM_X0 + k] + dy * table[sight.FROM_Y0 + k])
        length2 = table[sight.LENGTH2 + k]
        t = along / length2
        x = table[sight.X0 + k] + t * dx
        x = (
            table[sight.X0 + k]
            if along <= 0.0
            else (table[sight.X1 + k] if along >= length2 else x)
        )
        y = table[sight.Y0 + k] + t * dy
        y = (
            table[sight.Y0 + k]
            if along <= 0.0
            else (table[sight.Y1 + k] if along >= length2 else y)
        )
        table[sight.FREE + k] = (px - x) * (px - x) + (py - y) * (py - y)
    n = 0
    for k in range(world.last - world.first):
        p = world.first + k
        if table[sight.R + k] > 0.0:
            n = _consider(a, 0.0, 0.0, capsules[p], p, limit, n, best, code)
        elif table[sight.SIDE + k] < 0.0 and table[sight.FREE + k] <= reach2:
            ahead = table[sight.NX + k] * (a.x - table[sight.X0 + k]) + table[sight.NY + k] * (
                a.y - table[sight.Y0 + k]
            )
            if ahead > 0.0:
                n = _insert(table[sight.FREE + k], 8 * p, n, best, code)
    return n


@kernel_without_allocation
def _gather_cells(
    a: Any, limit: float, far: float, world: Any, capsules: AnyArray, start: IntArray,
    item: IntArray, best: FloatArray, code: IntArray,
) -> int:  # fmt: skip
    """Gather from cells within ``far``; a capsule counts in the cell of its point nearest to a."""
    n, side = 0, world.side
    i0 = max(0, math.floor((a.x - far - world.origin_x) / side))
    j0 = max(0, math.floor((a.y - far - world.origin_y) / side))
    i1 = min(world.nx - 1, math.floor((a.x + far - world.origin_x) / side))
    j1 = min(world.ny - 1, math.floor((a.y + far - world.origin_y) / side))
    for i in range(i0, i1 + 1):
        for j in range(j0, j1 + 1):
            cell = world.grid + i * world.ny + j
            for at in range(start[cell], start[cell + 1]):
                c = capsules[item[at]]
                x, y = nearest_on_segment(a.x, a.y, c.x0, c.y0, c.x1, c.y1)
                ci = math.floor((x - world.origin_x) / side)
                cj = math.floor((y - world.origin_y) / side)
                if ci == i and cj == j:
                    n = _consider(a, 0.0, 0.0, c, item[at], limit, n, best, code)
    return n


@kernel_without_allocation
def _consider(
    a: Any, ox: float, oy: float, c: Any, at: int, limit: float, n: int, best: FloatArray,
    code: IntArray,
) -> int:  # fmt: skip
    """Offer capsule c, shifted by (ox, oy): an edge, or the sides of the octagon around a disc."""
    if c.before >= 0:
        x0, y0, x1, y1 = ox + c.x0, oy + c.y0, ox + c.x1, oy + c.y1
        return _offer(a, x0, y0, x1, y1, 8 * at, limit, n, best, code)
    for side in range(8):
        x0, y0, x1, y1 = _octagon_side(c, side)
        n = _offer(a, ox + x0, oy + y0, ox + x1, oy + y1, 8 * at + side, limit, n, best, code)
    return n


@kernel_without_allocation
def _octagon_side(c: Any, side: int) -> tuple[float, float, float, float]:
    """Return a side of the octagon around a disc, by 45° steps; side 0 faces +x."""
    c0, s0 = cos_sin((side - 0.5) * _EIGHTH)
    c1, s1 = cos_sin((side + 0.5) * _EIGHTH)
    radius = c.r * _OCTAGON
    return c.x0 + radius * c0, c.y0 + radius * s0, c.x0 + radius * c1, c.y0 + radius * s1


@kernel_without_allocation
def _offer(
    a: Any, x0: float, y0: float, x1: float, y1: float, edge_code: int, limit: float, n: int,
    best: FloatArray, code: IntArray,
) -> int:  # fmt: skip
    """Insert an edge if agent a is on its free (right-hand) side and within ``limit``."""
    if (x1 - x0) * (a.y - y0) - (y1 - y0) * (a.x - x0) >= 0.0:
        return n
    qx, qy = nearest_on_segment(a.x, a.y, x0, y0, x1, y1)
    d2 = (a.x - qx) * (a.x - qx) + (a.y - qy) * (a.y - qy)
    return n if d2 > limit * limit else _insert(d2, edge_code, n, best, code)


@kernel_without_allocation
def _insert(d2: float, edge_code: int, n: int, best: FloatArray, code: IntArray) -> int:
    """Insert an edge into n sorted ones, if it is near enough or there is room; return n."""
    if n == len(best) and d2 >= best[n - 1]:
        return n
    n = min(n + 1, len(best))
    at = n - 1
    while at > 0 and (best[at - 1] > d2 or (best[at - 1] == d2 and code[at - 1] > edge_code)):
        best[at], code[at] = best[at - 1], code[at - 1]
        at -= 1
    best[at], code[at] = d2, edge_code
    return n


@kernel_without_allocation
def _identity(code: int, world: Any, bodies: AnyArray, capsules: AnyArray, shapes: AnyArray) -> int:
    """Return a number of an edge that is unique in its world, from its code in the batch."""
    q = code // 8 - len(capsules)
    if q < 0:
        return code - 8 * int(world.first)
    m = int(shapes[q].solid)
    return 4294967296 * (m + 1) + code - 8 * (len(capsules) + int(bodies[m].first))


@kernel_without_allocation
def _edge(
    code: int, capsules: AnyArray, shapes: AnyArray, bodies: AnyArray, edge: FloatArray
) -> None:
    """Write an edge by its code: ends, directions of the edges before and after, convexities."""
    at, side = code // 8, code % 8
    fixed = at < len(capsules)
    q = at - len(capsules)
    c = capsules[at] if fixed else shapes[q]
    ox, oy = (0.0, 0.0) if fixed else (bodies[c.solid].x, bodies[c.solid].y)
    if c.before < 0:
        edge[0], edge[1], edge[2], edge[3] = _octagon_side(c, side)
        edge[4], edge[5] = cos_sin((side + 1.0) * _EIGHTH)
        edge[6], edge[7] = cos_sin((side + 3.0) * _EIGHTH)
        edge[8], edge[9] = 1.0, 1.0
    else:
        prior = capsules[c.before] if fixed else shapes[c.before]
        later = capsules[c.after] if fixed else shapes[c.after]
        edge[0], edge[1], edge[2], edge[3] = c.x0, c.y0, c.x1, c.y1
        # a direction is the outward normal turned by +90°
        edge[4], edge[5], edge[6], edge[7] = -prior.ny, prior.nx, -later.ny, later.nx
        edge[8] = 1.0 if prior.nx * c.ny - prior.ny * c.nx >= 0.0 else -1.0
        edge[9] = 1.0 if c.nx * later.ny - c.ny * later.nx >= 0.0 else -1.0
    edge[0] += ox
    edge[1] += oy
    edge[2] += ox
    edge[3] += oy


@kernel_without_allocation
def _clip(a: Any, limit: float, edge: FloatArray) -> None:
    """Cut an edge at the sensor's range; a cut end looks like a straight wall that continues."""
    dx, dy = edge[2] - edge[0], edge[3] - edge[1]
    length = math.sqrt(dx * dx + dy * dy)
    ux, uy = dx / length, dy / length
    fx, fy = edge[0] - a.x, edge[1] - a.y
    middle = -(fx * ux + fy * uy)  # position along the edge of the point nearest to a
    half = math.sqrt(max(limit * limit - (fx * fx + fy * fy) + middle * middle, 0.0))
    x0, y0 = edge[0], edge[1]
    if middle - half > 0.0:
        edge[0], edge[1] = x0 + (middle - half) * ux, y0 + (middle - half) * uy
        edge[4], edge[5], edge[8] = ux, uy, 1.0
    if middle + half < length:
        edge[2], edge[3] = x0 + (middle + half) * ux, y0 + (middle + half) * uy
        edge[6], edge[7], edge[9] = ux, uy, 1.0
