"""The nearest other agents and dynamic obstacles, in range and in sight."""

import math
from typing import Any

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry.hash_grid import bucket
from benchnav.kernels import inlined, kernel
from benchnav.sensors.sight import in_sight
from benchnav.world.touch import BRUTE_FORCE

CANDIDATES = 32  # nearest ones in range that are tested for visibility first
_AGENT, _DYNAMIC = int(Kind.AGENT), int(Kind.DYNAMIC)


@kernel
def find_neighbours(
    low: int, high: int, chosen: IntArray, limit: float, occlusion: bool, side: float,
    sees: BoolArray, worlds: AnyArray, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray, spots: AnyArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray,
    count: IntArray,
) -> None:  # fmt: skip
    """Find neighbours for rows low:high of the flattened (B, chosen agents).

    Outputs are (B, An, K, …). If obstacles can hide neighbours, more than K candidates are
    gathered, and the number doubles until K are in sight or no candidate is left in range.
    """
    width, most, total = position.shape[1], position.shape[2], agents.shape[1]
    best = np.empty(total + bodies.shape[1] + 1)  # squared distances
    code = np.empty(len(best), np.int64)  # j for an agent, A + m for a body
    for b in range(low // width, (high + width - 1) // width):
        world, here, things = worlds[b], agents[b], bodies[b]
        seen, table, crowd = sees[b], hashed[b], spots[b]
        hidden = occlusion and (world.bodies > 0 or world.last > world.first)
        for k in range(max(low - b * width, 0), min(high - b * width, width)):
            i, kept = chosen[b, k], 0
            if i < 0 or not here[i].present:
                continue
            a = here[i]
            room = max(most, CANDIDATES) if hidden else most
            while True:
                n = _gather_bodies(a, limit, total, world.bodies, things, best, code)
                n = _gather_agents(i, limit, room, side, seen, here, table, crowd, n, best, code)
                kept = n
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
            count[b, k] = kept


@kernel
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
    a: Any, limit: float, total: int, count: int, bodies: AnyArray, best: FloatArray,
    code: IntArray,
) -> int:  # fmt: skip
    """List the dynamic obstacles within ``limit``, as space allows; return their number."""
    n = 0
    for m in range(count):
        body = bodies[m]
        d2 = (body.x - a.x) * (body.x - a.x) + (body.y - a.y) * (body.y - a.y)
        if body.kind == _DYNAMIC and d2 <= limit * limit and n < len(best):
            best[n], code[n] = d2, total + m
            n += 1
    return n


@inlined
def _gather_agents(
    i: int, limit: float, room: int, side: float, sees: BoolArray, agents: AnyArray,
    hashed: IntArray, spots: AnyArray, n: int, best: FloatArray, code: IntArray,
) -> int:  # fmt: skip
    """Add the other agents that are not ignored; return the number of nearest ones in the list."""
    a = agents[i]
    x, y, team, far = a.x, a.y, a.team, limit * limit
    n = _nearest(0, n, room, best, code)
    done = n  # sorted so far
    if len(agents) <= BRUTE_FORCE:
        for j in range(len(agents)):
            b = agents[j]
            d2 = (b.x - x) * (b.x - x) + (b.y - y) * (b.y - y)
            if j != i and b.present and d2 <= far and sees[team, b.team]:
                best[n], code[n] = d2, j
                n += 1
        return _nearest(done, n, room, best, code)
    ai, aj, size, worst = a.ci, a.cj, len(hashed) - 1, far
    for ring in range(math.ceil(limit / side) + 1):
        # nothing in this ring or beyond is nearer than ring - 1 whole cells
        if ring > 1 and worst < ((ring - 1) * side) * ((ring - 1) * side):
            break
        for ci in range(ai - ring, ai + ring + 1):
            rim = ci == ai - ring or ci == ai + ring
            for cj in range(aj - ring, aj + ring + 1, 1 if rim or ring == 0 else 2 * ring):
                k = bucket(ci, cj, size)
                for at in range(hashed[k], hashed[k + 1]):
                    spot = spots[at]
                    d2 = (spot.x - x) * (spot.x - x) + (spot.y - y) * (spot.y - y)
                    if d2 > worst or spot.ci != ci or spot.cj != cj or spot.index == i:
                        continue
                    if sees[team, spot.team]:
                        best[n], code[n] = d2, spot.index
                        n += 1
        n = done = _nearest(done, n, room, best, code)
        if n == room:
            worst = min(far, best[n - 1])
    return n


@kernel
def _nearest(done: int, n: int, room: int, best: FloatArray, code: IntArray) -> int:
    """Sort the list, whose first ``done`` entries are sorted, by (distance, code); keep ``room``.

    The order is total, so that the order of discovery does not matter.
    """
    for k in range(done, n):
        d2, candidate, at = best[k], code[k], k
        while at > 0 and (best[at - 1] > d2 or (best[at - 1] == d2 and code[at - 1] > candidate)):
            best[at], code[at] = best[at - 1], code[at - 1]
            at -= 1
        best[at], code[at] = d2, candidate
    return min(n, room)
