"""The nearest other agents and dynamic obstacles, in range and in sight."""

import math
from typing import Any

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry.hash_grid import bucket
from benchnav.kernels import kernel
from benchnav.sensors.sight import in_sight
from benchnav.world.touch import BRUTE_FORCE

_AGENT, _DYNAMIC = int(Kind.AGENT), int(Kind.DYNAMIC)


@kernel
def find_neighbours(
    low: int, high: int, chosen: IntArray, limit: float, occlusion: bool, side: float,
    sees: BoolArray, worlds: AnyArray, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray, sorted_: IntArray,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray,
    count: IntArray,
) -> None:  # fmt: skip
    """Rows low:high of the flattened (B, chosen agents); outputs are (B, An, K, …)."""
    width, most = position.shape[1], position.shape[2]
    best = np.empty(most)  # squared distances, rising
    code = np.empty(most, np.int64)  # j for an agent, A + m for a body
    for row in range(low, high):
        b, k = row // width, row % width
        i = chosen[b, k]
        count[b, k] = 0
        if i < 0 or not agents[b, i].present:
            continue
        n = _gather(
            i, limit, occlusion, side, sees[b], worlds[b], agents[b], bodies[b], shapes, capsules,
            start, item, hashed[b], sorted_[b], best, code,
        )  # fmt: skip
        count[b, k] = n
        total = agents.shape[1]
        for s in range(n):
            if code[s] < total:
                a = agents[b, code[s]]
                position[b, k, s, 0], position[b, k, s, 1] = a.x, a.y
                velocity[b, k, s, 0], velocity[b, k, s, 1] = a.vx, a.vy
                radius[b, k, s], kind[b, k, s] = a.radius, _AGENT
            else:
                body = bodies[b, code[s] - total]
                position[b, k, s, 0], position[b, k, s, 1] = body.x, body.y
                velocity[b, k, s, 0], velocity[b, k, s, 1] = body.vx, body.vy
                radius[b, k, s], kind[b, k, s] = body.bound, _DYNAMIC


@kernel
def _gather(
    i: int, limit: float, occlusion: bool, side: float, sees: BoolArray, world: Any,
    agents: AnyArray, bodies: AnyArray, shapes: AnyArray, capsules: AnyArray, start: IntArray,
    item: IntArray, hashed: IntArray, sorted_: IntArray, best: FloatArray, code: IntArray,
) -> int:  # fmt: skip
    """Fills ``best`` and ``code`` with the nearest, and returns how many there are."""
    a, n, total = agents[i], 0, len(agents)
    hidden = occlusion and (world.bodies > 0 or world.last > world.first)
    for m in range(world.bodies):
        body = bodies[m]
        if body.kind == _DYNAMIC:
            d2 = _squared(a, body)
            if _belongs(d2, limit, n, best) and (
                not hidden
                or in_sight(
                    a.x, a.y, body.x, body.y, m, world, capsules, start, item, bodies, shapes
                )
            ):
                n = _insert(d2, total + m, n, best, code)
    if total <= BRUTE_FORCE:
        for j in range(total):
            n = _consider(
                i, j, limit, hidden, sees, world, agents, bodies, shapes, capsules, start, item, n,
                best, code,
            )  # fmt: skip
        return n
    size = len(hashed) - 1
    for ring in range(math.ceil(limit / side) + 1):
        # nothing in this ring or beyond is nearer than ring - 1 whole cells
        if n == len(best) and best[n - 1] < ((ring - 1) * side) * ((ring - 1) * side):
            break
        for ci in range(a.ci - ring, a.ci + ring + 1):
            rim = ci == a.ci - ring or ci == a.ci + ring
            for cj in range(a.cj - ring, a.cj + ring + 1, 1 if rim or ring == 0 else 2 * ring):
                k = bucket(ci, cj, size)
                for at in range(hashed[k], hashed[k + 1]):
                    j = sorted_[at]
                    if agents[j].ci == ci and agents[j].cj == cj:
                        n = _consider(
                            i, j, limit, hidden, sees, world, agents, bodies, shapes, capsules,
                            start, item, n, best, code,
                        )  # fmt: skip
    return n


@kernel
def _squared(a: Any, b: Any) -> float:
    dx, dy = b.x - a.x, b.y - a.y
    return float(dx * dx + dy * dy)


@kernel
def _belongs(d2: float, limit: float, n: int, best: FloatArray) -> bool:
    return bool(d2 <= limit * limit and (n < len(best) or d2 < best[n - 1]))


@kernel
def _consider(
    i: int, j: int, limit: float, hidden: bool, sees: BoolArray, world: Any, agents: AnyArray,
    bodies: AnyArray, shapes: AnyArray, capsules: AnyArray, start: IntArray, item: IntArray,
    n: int, best: FloatArray, code: IntArray,
) -> int:  # fmt: skip
    """Insert agent j if it is present, not ignored, in range, near enough and in sight."""
    a, b = agents[i], agents[j]
    if j == i or not b.present or not sees[a.team, b.team]:
        return n
    d2 = _squared(a, b)
    if not _belongs(d2, limit, n, best):
        return n
    if hidden and not in_sight(
        a.x, a.y, b.x, b.y, -1, world, capsules, start, item, bodies, shapes
    ):
        return n
    return _insert(d2, j, n, best, code)


@kernel
def _insert(d2: float, what: int, n: int, best: FloatArray, code: IntArray) -> int:
    """Insertion sort by (distance, code): the order of discovery does not matter."""
    if n < len(best):
        n += 1
    at = n - 1
    while at > 0 and (best[at - 1] > d2 or (best[at - 1] == d2 and code[at - 1] > what)):
        best[at], code[at] = best[at - 1], code[at - 1]
        at -= 1
    best[at], code[at] = d2, what
    return n
