"""The nearest other agents and dynamic obstacles, in range and in sight."""

import math
from typing import Any

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry.hash_grid import bucket
from benchnav.kernels import inlined, kernel, kernel_without_allocation
from benchnav.sensors.sight import in_sight
from benchnav.world.touch import BRUTE_FORCE

CANDIDATES = 32  # nearest ones in range that are tested for visibility first
SHORT, LONG = 6, 64  # numbers of candidates between which sorting by counting is the fastest
AHEAD = 1.12  # the search starts with this multiple of the last distance of the farthest one found
_AGENT, _DYNAMIC = int(Kind.AGENT), int(Kind.DYNAMIC)


@kernel
def find_neighbours(
    low: int, high: int, chosen: IntArray, limit: float, occlusion: bool, side: float,
    sees: BoolArray, worlds: AnyArray, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray, spots: AnyArray,
    near: FloatArray, position: FloatArray, velocity: FloatArray, radius: FloatArray,
    kind: ByteArray, count: IntArray,
) -> None:  # fmt: skip
    """Find neighbours for rows low:high of the flattened (B, chosen agents).

    Outputs are (B, An, K, …), zero behind the last neighbour. If obstacles can hide neighbours,
    more than K candidates are gathered, and the number doubles until K are in sight or no
    candidate is left in range.

    The search starts within ``near`` (B, A) [m], a guess from the last call, and is repeated within
    a larger radius if it finds too few. The guess changes the time that it takes, not the result.
    """
    best = np.empty(agents.shape[1] + bodies.shape[1] + 16)  # squared distances, and padding
    code = np.empty(len(best), np.int64)  # j for an agent, A + m for a body
    ranked = np.empty(LONG, np.int64)
    _find_in_rows(
        low, high, chosen, limit, occlusion, side, sees, worlds, agents, bodies, shapes, capsules,
        start, item, hashed, spots, near, position, velocity, radius, kind, count, best, code,
        ranked,
    )  # fmt: skip


@kernel_without_allocation
def _find_in_rows(
    low: int, high: int, chosen: IntArray, limit: float, occlusion: bool, side: float,
    sees: BoolArray, worlds: AnyArray, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray, spots: AnyArray,
    near: FloatArray, position: FloatArray, velocity: FloatArray, radius: FloatArray,
    kind: ByteArray, count: IntArray, best: FloatArray, code: IntArray, ranked: IntArray,
) -> None:  # fmt: skip
    width, most, total = position.shape[1], position.shape[2], agents.shape[1]
    for b in range(low // width, (high + width - 1) // width):
        world, here, things = worlds[b], agents[b], bodies[b]
        seen, table, crowd = sees[b], hashed[b], spots[b]
        hidden = occlusion and (world.bodies > 0 or world.last > world.first)
        for k in range(max(low - b * width, 0), min(high - b * width, width)):
            i, kept = chosen[b, k], 0
            searching = i >= 0 and here[i].present
            a = here[i]
            room = max(most, CANDIDATES) if hidden else most
            far = limit if total <= BRUTE_FORCE else min(near[b, i], limit)
            while searching:
                n = _gather_bodies(a, far * far, total, world.bodies, things, best, code)
                if total <= BRUTE_FORCE:
                    n = _gather_all(i, far * far, seen, here, n, best, code)
                else:
                    n = _gather_cells(i, far, side, seen, here, table, crowd, n, best, code)
                if n < room and far < limit:
                    far = min(max(1.5 * far, side), limit)
                    continue
                kept = n = _sort(n, room, best, code, ranked)
                near[b, i] = limit
                if n == room > 0:
                    near[b, i] = AHEAD * _distance(a, code[n - 1], here, things)
                if hidden:
                    kept = _keep_visible(
                        a, n, most, here, world, capsules, start, item, things, shapes, code
                    )
                if kept == most or n < room:
                    break
                room *= 2
            for s in range(kept):
                if code[s] < total:
                    other = here[code[s]]
                    position[b, k, s, 0], position[b, k, s, 1] = other.x, other.y
                    velocity[b, k, s, 0], velocity[b, k, s, 1] = other.vx, other.vy
                    radius[b, k, s], kind[b, k, s] = other.radius, _AGENT
                else:
                    body = things[code[s] - total]
                    position[b, k, s, 0], position[b, k, s, 1] = body.x, body.y
                    velocity[b, k, s, 0], velocity[b, k, s, 1] = body.vx, body.vy
                    radius[b, k, s], kind[b, k, s] = body.bound, _DYNAMIC
            for s in range(kept, most):
                position[b, k, s, 0], position[b, k, s, 1] = 0.0, 0.0
                velocity[b, k, s, 0], velocity[b, k, s, 1] = 0.0, 0.0
                radius[b, k, s], kind[b, k, s] = 0.0, 0
            count[b, k] = kept


@kernel_without_allocation
def _keep_visible(
    a: Any, n: int, most: int, agents: AnyArray, world: Any, capsules: AnyArray, start: IntArray,
    item: IntArray, bodies: AnyArray, shapes: AnyArray, code: IntArray,
) -> int:  # fmt: skip
    """Move the visible candidates to the front of ``code``, up to ``most``; return their number."""
    kept = 0
    for s in range(n):
        m = code[s] - len(agents)
        x, y = 0.0, 0.0
        if m < 0:
            x, y = agents[code[s]].x, agents[code[s]].y
        else:
            x, y = bodies[m].x, bodies[m].y
        if kept < most and in_sight(
            a.x, a.y, x, y, max(m, -1), world, capsules, start, item, bodies, shapes
        ):
            code[kept] = code[s]
            kept += 1
    return kept


@inlined
def _gather_bodies(
    a: Any, far: float, total: int, count: int, bodies: AnyArray, best: FloatArray, code: IntArray
) -> int:
    """List the dynamic obstacles within the root of ``far`` [m²]; return their number."""
    n = 0
    for m in range(count):
        body = bodies[m]
        d2 = (body.x - a.x) * (body.x - a.x) + (body.y - a.y) * (body.y - a.y)
        if body.kind == _DYNAMIC and d2 <= far:
            best[n], code[n] = d2, total + m
            n += 1
    return n


@inlined
def _gather_all(
    i: int, far: float, sees: BoolArray, agents: AnyArray, n: int, best: FloatArray, code: IntArray
) -> int:
    """Add the other agents within the root of ``far`` [m²] that are not ignored."""
    x, y, team = agents[i].x, agents[i].y, agents[i].team
    for j in range(len(agents)):
        b = agents[j]
        d2 = (b.x - x) * (b.x - x) + (b.y - y) * (b.y - y)
        if j != i and b.present and d2 <= far and sees[team, b.team]:
            best[n], code[n] = d2, j
            n += 1
    return n


@inlined
def _gather_cells(
    i: int, far: float, side: float, sees: BoolArray, agents: AnyArray, hashed: IntArray,
    spots: AnyArray, n: int, best: FloatArray, code: IntArray,
) -> int:  # fmt: skip
    """Add the other agents within ``far`` [m] that are not ignored, from the cells around i.

    A row of cells is contiguous in the table, but for other rows that share its buckets. Every
    candidate is written, and the next one overwrites it if it does not count: a branch that
    cannot be predicted costs more.
    """
    x, y, team, size = agents[i].x, agents[i].y, agents[i].team, len(hashed) - 1
    first, last = math.floor((x - far) / side), math.floor((x + far) / side)
    for row in range(math.floor((y - far) / side), math.floor((y + far) / side) + 1):
        low = bucket(first, row, size)
        high = low + min(last - first + 1, size)
        for part in range(2 if high > size else 1):  # the row may continue at the table's start
            begin, end = (low, min(high, size)) if part == 0 else (0, high - size)
            for at in range(hashed[begin], hashed[end]):
                spot = spots[at]
                d2 = (spot.x - x) * (spot.x - x) + (spot.y - y) * (spot.y - y)
                best[n], code[n] = d2, spot.index
                seen = sees[team, spot.team]
                n += 1 if (d2 <= far * far) & (spot.cj == row) & (spot.index != i) & seen else 0
    return n


@kernel_without_allocation
def _distance(a: Any, code: int, agents: AnyArray, bodies: AnyArray) -> float:
    x, y = 0.0, 0.0
    if code < len(agents):
        x, y = agents[code].x - a.x, agents[code].y - a.y
    else:
        x, y = bodies[code - len(agents)].x - a.x, bodies[code - len(agents)].y - a.y
    return math.sqrt(x * x + y * y)


@kernel_without_allocation
def _sort(n: int, room: int, best: FloatArray, code: IntArray, ranked: IntArray) -> int:
    """Sort n candidates by (distance, code); return how many of them are in ``room``.

    The order is total, so that the order of discovery does not matter.
    """
    if n <= SHORT or n > len(ranked):
        _insert(n, room, best, code)
        return min(n, room)
    padded = (n + 15) // 16 * 16  # whole vector operations
    for k in range(n, padded):
        best[k], code[k] = math.inf, 0
    for k in range(n):
        d2, candidate, rank = best[k], code[k], 0
        for other in range(padded):
            nearer = best[other] < d2
            rank += 1 if nearer | ((best[other] == d2) & (code[other] < candidate)) else 0
        ranked[rank] = candidate
    for k in range(n):
        code[k] = ranked[k]
    return min(n, room)


@kernel_without_allocation
def _insert(n: int, room: int, best: FloatArray, code: IntArray) -> None:
    """Sort the first ``room`` of n candidates by (distance, code)."""
    kept = 0
    for k in range(n):
        d2, candidate, at = best[k], code[k], kept
        if kept == room:
            at -= 1
            if d2 > best[at] or (d2 == best[at] and candidate > code[at]):
                continue
        else:
            kept += 1
        while at > 0 and (best[at - 1] > d2 or (best[at - 1] == d2 and code[at - 1] > candidate)):
            best[at], code[at] = best[at - 1], code[at - 1]
            at -= 1
        best[at], code[at] = d2, candidate
