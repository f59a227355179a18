"""The nearest other agents and dynamic obstacles, in range and in sight."""

import math
from typing import Any

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry.hash_grid import bucket
from benchnav.kernels import inlined, kernel, kernel_without_allocation
from benchnav.sensors.sight import in_sight
from benchnav.world.records import LISTED
from benchnav.world.touch import BRUTE_FORCE

CANDIDATES = 32  # nearest ones in range that are tested for visibility first
SLOTS = 1024  # candidates that are numbered by the last bits of a distance
CHAIN = 11  # length of a chain that sorts: neighbours, and one more to compare with the last one
AHEAD = 1.12  # the search starts with this multiple of the last distance of the farthest one found
_AGENT, _DYNAMIC = int(Kind.AGENT), int(Kind.DYNAMIC)


@kernel
def find_neighbours(
    low: int, high: int, chosen: IntArray, limit: float, occlusion: bool, side: float,
    sees: BoolArray, worlds: AnyArray, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray, spots: AnyArray,
    near: FloatArray, listed: IntArray, beyond: FloatArray, position: FloatArray,
    velocity: FloatArray, radius: FloatArray, kind: ByteArray, count: IntArray,
) -> None:  # fmt: skip
    """Find neighbours for rows low:high of the flattened (B, chosen agents).

    Outputs are (B, An, K, …), zero behind the last neighbour. If obstacles can hide neighbours,
    more than K candidates are gathered, and the number doubles until K are in sight or no
    candidate is left in range.

    The search starts within ``near`` (B, A) [m], a guess from the last call, and is repeated within
    a larger radius if it finds too few. The guess changes the time that it takes, not the result.

    The nearest agents of a crowd are ``listed`` (B, A, …) for the step, which reads the list up to
    the distance ``beyond`` (B, A) [m].
    """
    best = np.empty(agents.shape[1] + bodies.shape[1] + 1)  # squared distances
    keys = np.empty(CHAIN + SLOTS)
    place = np.empty(len(best), np.int64)  # of a spot, or -1 - m for body m
    ranked = np.empty(len(best), np.int64)  # places, nearest first
    _find_in_rows(
        low, high, chosen, limit, occlusion, side, sees, worlds, agents, bodies, shapes, capsules,
        start, item, hashed, spots, near, listed, beyond, position, velocity, radius, kind, count,
        best, best.view(np.int64), keys, keys.view(np.int64), place, ranked,
    )  # fmt: skip


@kernel_without_allocation
def _find_in_rows(
    low: int, high: int, chosen: IntArray, limit: float, occlusion: bool, side: float,
    sees: BoolArray, worlds: AnyArray, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray, spots: AnyArray,
    near: FloatArray, listed: IntArray, beyond: FloatArray, position: FloatArray,
    velocity: FloatArray, radius: FloatArray, kind: ByteArray, count: IntArray, best: FloatArray,
    exact: IntArray, keys: FloatArray, bits: IntArray, place: IntArray, ranked: IntArray,
) -> None:  # fmt: skip
    width, most, total = position.shape[1], position.shape[2], agents.shape[1]
    for b in range(low // width, (high + width - 1) // width):
        world, here, things = worlds[b], agents[b], bodies[b]
        seen, table, crowd = sees[b], hashed[b], spots[b]
        hidden = occlusion and (world.bodies > 0 or world.last > world.first)
        everyone = _all_seen(seen)
        for k in range(max(low - b * width, 0), min(high - b * width, width)):
            i, kept = chosen[b, k], 0
            searching = i >= 0 and here[i].present
            a = here[i]
            room = max(most, CANDIDATES) if hidden else most
            far = limit if total <= BRUTE_FORCE else min(near[b, i], limit)
            while searching:
                n = _gather_bodies(a, far * far, world.bodies, things, best, place)
                if total <= BRUTE_FORCE:
                    n = _gather_all(i, far * far, seen, here, table, crowd, n, best, place)
                else:
                    n = _gather_cells(
                        i, far, side, everyone, seen, here, table, crowd, n, best, place
                    )
                if n < room and far < limit:
                    far = min(max(1.5 * far, side), limit)
                    continue
                farthest = _sort(n, room, total, crowd, best, exact, keys, bits, place, ranked)
                kept = n = min(n, room)
                near[b, i] = AHEAD * math.sqrt(farthest) if n == room > 0 else limit
                if everyone and total > BRUTE_FORCE:
                    beyond[b, i] = _list(a, n, n < room, limit, crowd, ranked, listed[b, i])
                if hidden:
                    kept = _keep_visible(
                        a, n, most, crowd, world, capsules, start, item, things, shapes, ranked
                    )
                if kept == most or n < room:
                    break
                room *= 2
            for s in range(kept):
                if ranked[s] >= 0:
                    spot = crowd[ranked[s]]
                    position[b, k, s, 0], position[b, k, s, 1] = spot.x, spot.y
                    velocity[b, k, s, 0], velocity[b, k, s, 1] = spot.vx, spot.vy
                    radius[b, k, s], kind[b, k, s] = spot.radius, _AGENT
                else:
                    body = things[-1 - ranked[s]]
                    position[b, k, s, 0], position[b, k, s, 1] = body.x, body.y
                    velocity[b, k, s, 0], velocity[b, k, s, 1] = body.vx, body.vy
                    radius[b, k, s], kind[b, k, s] = body.bound, _DYNAMIC
            for s in range(kept, most):
                position[b, k, s, 0], position[b, k, s, 1] = 0.0, 0.0
                velocity[b, k, s, 0], velocity[b, k, s, 1] = 0.0, 0.0
                radius[b, k, s], kind[b, k, s] = 0.0, 0
            count[b, k] = kept


@kernel_without_allocation
def _all_seen(sees: BoolArray) -> bool:
    """Whether no team is ignored by any other."""
    for team in range(len(sees)):
        for other in range(len(sees)):
            if not sees[team, other]:
                return False
    return True


@kernel_without_allocation
def _list(
    a: Any, n: int, complete: bool, limit: float, spots: AnyArray, ranked: IntArray,
    listed: IntArray,
) -> float:  # fmt: skip
    """List the nearest agents of n candidates; return the distance [m] beyond which others are."""
    kept = 0
    for s in range(n):
        if ranked[s] < 0:
            continue
        if kept == LISTED:
            complete = False
            break
        kept += 1
        listed[kept] = ranked[s]
    listed[0] = kept
    if complete or kept == 0:
        return limit if complete else -1.0
    last = spots[listed[kept]]
    return math.sqrt((last.x - a.x) * (last.x - a.x) + (last.y - a.y) * (last.y - a.y))


@kernel_without_allocation
def _keep_visible(
    a: Any, n: int, most: int, spots: AnyArray, world: Any, capsules: AnyArray, start: IntArray,
    item: IntArray, bodies: AnyArray, shapes: AnyArray, ranked: IntArray,
) -> int:  # fmt: skip
    """Move up to ``most`` visible candidates to the front of ``ranked``; return their number."""
    kept = 0
    for s in range(n):
        m = -1 - ranked[s]
        x, y = 0.0, 0.0
        if m < 0:
            x, y = spots[ranked[s]].x, spots[ranked[s]].y
        else:
            x, y = bodies[m].x, bodies[m].y
        if kept < most and in_sight(
            a.x, a.y, x, y, max(m, -1), world, capsules, start, item, bodies, shapes
        ):
            ranked[kept] = ranked[s]
            kept += 1
    return kept


@inlined
def _gather_bodies(
    a: Any, far: float, count: int, bodies: AnyArray, best: FloatArray, place: IntArray
) -> int:
    """List the dynamic obstacles within the root of ``far`` [m²]; return their number."""
    n = 0
    for m in range(count):
        body = bodies[m]
        d2 = (body.x - a.x) * (body.x - a.x) + (body.y - a.y) * (body.y - a.y)
        if body.kind == _DYNAMIC and d2 <= far:
            best[n], place[n] = d2, -1 - m
            n += 1
    return n


@inlined
def _gather_all(
    i: int, far: float, sees: BoolArray, agents: AnyArray, hashed: IntArray, spots: AnyArray,
    n: int, best: FloatArray, place: IntArray,
) -> int:  # fmt: skip
    """Add the other agents within the root of ``far`` [m²] that are not ignored."""
    x, y, team = agents[i].x, agents[i].y, agents[i].team
    for at in range(hashed[-1]):
        spot = spots[at]
        d2 = (spot.x - x) * (spot.x - x) + (spot.y - y) * (spot.y - y)
        if spot.index != i and d2 <= far and sees[team, spot.team]:
            best[n], place[n] = d2, at
            n += 1
    return n


@inlined
def _gather_cells(
    i: int, far: float, side: float, everyone: bool, sees: BoolArray, agents: AnyArray,
    hashed: IntArray, spots: AnyArray, n: int, best: FloatArray, place: IntArray,
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
                best[n], place[n] = d2, at
                seen = everyone | sees[team, spot.team]
                n += 1 if (d2 <= far * far) & (spot.cj == row) & (spot.index != i) & seen else 0
    return n


@kernel_without_allocation
def _sort(
    n: int, room: int, total: int, spots: AnyArray, best: FloatArray, exact: IntArray,
    keys: FloatArray, bits: IntArray, place: IntArray, ranked: IntArray,
) -> float:  # fmt: skip
    """Write the places of the nearest of n candidates, up to ``room``, into ``ranked``.

    Return about the squared distance [m²] of the last one. Equal distances are ordered by index,
    agents before bodies: the order is total, so that the order of discovery does not matter.

    Each key is a distance whose last bits are replaced by the number of its candidate. It moves
    down a chain of minima and maxima, which has no branch that cannot be predicted. Distances that
    then look equal are compared exactly. ``exact`` and ``bits`` are ``best`` and ``keys`` as
    integers.
    """
    kept = min(n, room)
    if n > SLOTS or room >= CHAIN:
        return _insert(n, room, total, spots, best, place, ranked)
    for q in range(CHAIN):
        keys[q] = math.inf
    for k in range(n):
        bits[CHAIN + k] = exact[k] & -SLOTS | k
    for k in range(n):
        x = keys[CHAIN + k]
        for q in range(CHAIN):
            y = keys[q]
            keys[q] = y if y < x else x
            x = x if y < x else y
    equal = False
    for k in range(min(n - 1, room)):
        equal |= bits[k] // SLOTS == bits[k + 1] // SLOTS
    if equal:
        return _insert(n, room, total, spots, best, place, ranked)
    for k in range(kept):
        ranked[k] = place[bits[k] % SLOTS]
    return float(keys[kept - 1]) if kept > 0 else 0.0


@kernel_without_allocation
def _insert(
    n: int, room: int, total: int, spots: AnyArray, best: FloatArray, place: IntArray,
    ranked: IntArray,
) -> float:  # fmt: skip
    """Return the same as `_sort`, by insertion into ``best`` and ``ranked``."""
    kept = 0
    for k in range(n):
        d2, candidate, at = best[k], place[k], kept
        key = _order(candidate, total, spots)
        if kept == room:
            at -= 1
            if at < 0 or not _precedes(d2, key, best[at], ranked[at], total, spots):
                continue
        else:
            kept += 1
        while at > 0 and _precedes(d2, key, best[at - 1], ranked[at - 1], total, spots):
            best[at], ranked[at] = best[at - 1], ranked[at - 1]
            at -= 1
        best[at], ranked[at] = d2, candidate
    return float(best[kept - 1]) if kept > 0 else 0.0


@kernel_without_allocation
def _precedes(
    d2: float, key: int, other_d2: float, other: int, total: int, spots: AnyArray
) -> bool:
    return d2 < other_d2 or (d2 == other_d2 and key < _order(other, total, spots))


@kernel_without_allocation
def _order(place: int, total: int, spots: AnyArray) -> int:
    """Return the key of a candidate among those at equal distance."""
    return int(spots[place].index) if place >= 0 else total - 1 - place
