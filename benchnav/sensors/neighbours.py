"""The nearest other agents and dynamic obstacles, in range and in sight."""

import math
from typing import Any

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.sensors.nearest import (
    CHAIN,
    LANES,
    SLOTS,
    gather,
    insert,
    look_at_all,
    put_into_lane,
    sort_lanes,
    take_from_lane,
)
from benchnav.sensors.sight import TABLE, copy_fixed, in_sight, list_blockers, stand_at
from benchnav.world.records import LISTED
from benchnav.world.touch import BRUTE_FORCE

CANDIDATES = 32  # nearest ones in range that are tested for visibility first
AHEAD = 1.12  # the search starts with this multiple of the last distance of the farthest one found
_AGENT, _DYNAMIC = int(Kind.AGENT), int(Kind.DYNAMIC)


@kernel_without_allocation
def number_rows(
    low: int, high: int, chosen: IntArray, agents: AnyArray, row: IntArray, position: FloatArray,
    velocity: FloatArray, radius: FloatArray, kind: ByteArray, count: IntArray,
) -> None:  # fmt: skip
    """Write the ``row`` (B, A) of each chosen agent (B, An) in worlds low:high; -1: not chosen.

    Readings of padding and of agents that are not present become zero.
    """
    for b in range(low, high):
        row[b] = -1
        for k in range(chosen.shape[1]):
            i = chosen[b, k]
            if i >= 0 and agents[b, i].present:
                row[b, i] = k
            else:
                _clear(0, position[b, k], velocity[b, k], radius[b, k], kind[b, k])
                count[b, k] = 0


@kernel
def find_neighbours(
    low: int, high: int, row: IntArray, limit: float, occlusion: bool, side: float,
    sees: BoolArray, worlds: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray, spots: AnyArray,
    near: FloatArray, listed: IntArray, beyond: FloatArray, position: FloatArray,
    velocity: FloatArray, radius: FloatArray, kind: ByteArray, count: IntArray, identity: IntArray,
) -> None:  # fmt: skip
    """Find neighbours of the agents at spots low:high of the flattened (B, A).

    Outputs are (B, An, K, …), zero behind the last neighbour; `number_rows` gives the ``row`` of
    each agent. ``identity`` (B, An, K) is the index of a neighbour among the agents, or -1 - m for
    body m; it has no value behind the last neighbour.

    The search starts within ``near`` (B, A) [m], a guess from the last call, and is repeated within
    a larger radius if it finds too few. The guess changes the time that it takes, not the result.

    The nearest agents of a crowd are ``listed`` (B, A, …) for the step, which reads the list up to
    the distance ``beyond`` (B, A) [m].
    """
    most = spots.shape[1] + bodies.shape[1] + 1
    best, given = np.empty(most), np.empty(SLOTS * LANES)  # squared distances
    smallest = np.empty((CHAIN + 1) * LANES)
    _find_in_rows(
        low, high, row, limit, occlusion, side, sees, worlds, bodies, shapes, capsules,
        start, item, hashed, spots, near, listed, beyond, position, velocity, radius, kind, count,
        identity, np.empty((2, most)), np.empty(most, np.int64),
        np.empty(4, np.int64), best,
        best.view(np.int64), np.empty((LANES, most), np.int64), np.empty(most, np.int64), given,
        given.view(np.int64), smallest, smallest.view(np.int64), np.empty(LANES, np.int64),
        np.empty(TABLE), np.empty(bodies.shape[1], np.int64),
    )  # fmt: skip


@kernel_without_allocation
def _find_in_rows(
    low: int, high: int, row: IntArray, limit: float, occlusion: bool, side: float,
    sees: BoolArray, worlds: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray, spots: AnyArray,
    near: FloatArray, listed: IntArray, beyond: FloatArray, position: FloatArray,
    velocity: FloatArray, radius: FloatArray, kind: ByteArray, count: IntArray, identity: IntArray,
    around: FloatArray, at: IntArray, window: IntArray,
    best: FloatArray, exact: IntArray, place: IntArray, ranked: IntArray, given: FloatArray,
    given_bits: IntArray,
    smallest: FloatArray, bits: IntArray, sizes: IntArray, fixed: FloatArray, blockers: IntArray,
) -> None:  # fmt: skip
    """Sort the candidates of `LANES` agents together, or those of one agent by insertion.

    Insertion is for many candidates, equal distances, and worlds where obstacles hide neighbours.
    """
    total, most = spots.shape[1], position.shape[2]
    few, x, y = total <= BRUTE_FORCE, around[0], around[1]
    for b in range(low // total, (high + total - 1) // total):
        world, things, table, crowd = worlds[b], bodies[b], hashed[b], spots[b]
        hidden = occlusion and (world.bodies > 0 or world.last > world.first)
        size, discs = copy_fixed(world, capsules, fixed) if hidden else (-1, False)
        everyone = _all_seen(sees[b])
        window[:], given[:] = -1, math.inf
        if few:
            look_at_all(table, crowd, window, x, y, at)
        begin, end = max(low - b * total, 0), min(high - b * total, table[-1])
        for first in range(begin, end, LANES):
            longest = 0
            for lane in range(min(LANES, end - first)):
                own, sizes[lane] = first + lane, 0
                i = crowd[own].index
                if row[b, i] < 0:
                    continue
                far = limit if few else min(near[b, i], limit)
                n = SLOTS + 1
                if not hidden and most < CHAIN:
                    n = gather(
                        own, most, far, limit, side, few, everyone, sees[b], crowd[own],
                        world.bodies, things, table, crowd, window, x, y, at, best, place[lane],
                    )  # fmt: skip
                sizes[lane] = n
                if n <= SLOTS:
                    longest = max(longest, n)
                    put_into_lane(n, lane, exact, given_bits)
            sort_lanes(longest, given, smallest)
            given[: longest * LANES] = math.inf
            for lane in range(min(LANES, end - first)):
                own, n = first + lane, sizes[lane]
                i = crowd[own].index
                k, a = row[b, i], crowd[own]
                if k < 0:
                    continue
                kept = min(n, most)
                if n <= SLOTS and take_from_lane(n, most, lane, bits, place[lane], ranked):
                    last = smallest[(most - 1) * LANES + lane] if most > 0 else 0.0
                    near[b, i] = AHEAD * math.sqrt(last) if n >= most > 0 else limit
                    if everyone and not few:
                        beyond[b, i] = _list(
                            a, kept, n < most, limit, crowd, ranked, listed[b, i]
                        )  # fmt: skip
                else:
                    kept = _find_one(
                        own, most, limit, side, few, hidden, everyone, sees[b], a, world, things,
                        shapes, capsules, start, item, table, crowd, near[b], listed[b], beyond[b],
                        window, x, y, at, best, place[lane], ranked, size, discs, fixed, blockers,
                    )  # fmt: skip
                _write(
                    kept, crowd, things, ranked, position[b, k], velocity[b, k], radius[b, k],
                    kind[b, k],
                )  # fmt: skip
                _identify(kept, crowd, ranked, identity[b, k])
                count[b, k] = kept


@kernel_without_allocation
def _find_one(
    own: int, most: int, limit: float, side: float, few: bool, hidden: bool, everyone: bool,
    seen: BoolArray, a: Any, world: Any, bodies: AnyArray, shapes: AnyArray, capsules: AnyArray,
    start: IntArray, item: IntArray, hashed: IntArray, spots: AnyArray, near: FloatArray,
    listed: IntArray, beyond: FloatArray, window: IntArray, x: FloatArray, y: FloatArray,
    at: IntArray, best: FloatArray, place: IntArray, ranked: IntArray, size: int, discs: bool,
    fixed: FloatArray, blockers: IntArray,
) -> int:  # fmt: skip
    """Write the places of the neighbours of agent a into ``ranked``; return their number.

    If obstacles can hide neighbours, more than K candidates are gathered, and the number doubles
    until K are in sight or no candidate is left in range.
    """
    i = spots[own].index
    room = max(most, CANDIDATES) if hidden else most
    while True:
        far = limit if few else min(near[i], limit)
        n = gather(
            own, room, far, limit, side, few, everyone, seen, a, world.bodies, bodies, hashed,
            spots, window, x, y, at, best, place,
        )  # fmt: skip
        farthest = insert(n, room, len(near), spots, best, place, ranked)
        kept = n = min(n, room)
        near[i] = AHEAD * math.sqrt(farthest) if n == room > 0 else limit
        if everyone and not few:
            beyond[i] = _list(a, n, n < room, limit, spots, ranked, listed[i])
        if hidden:
            kept = _keep_visible(
                a, n, most, limit, spots, world, capsules, start, item, bodies, shapes, ranked,
                size, discs, fixed, blockers,
            )  # fmt: skip
        if kept == most or n < room:
            return kept
        room *= 2


@kernel_without_allocation
def _write(
    kept: int, spots: AnyArray, bodies: AnyArray, ranked: IntArray, position: FloatArray,
    velocity: FloatArray, radius: FloatArray, kind: ByteArray,
) -> None:  # fmt: skip
    """Write the readings of the ranked places; zero behind them."""
    for s in range(kept):
        if ranked[s] >= 0:
            spot = spots[ranked[s]]
            position[s, 0], position[s, 1] = spot.x, spot.y
            velocity[s, 0], velocity[s, 1] = spot.vx, spot.vy
            radius[s], kind[s] = spot.radius, _AGENT
        else:
            body = bodies[-1 - ranked[s]]
            position[s, 0], position[s, 1] = body.x, body.y
            velocity[s, 0], velocity[s, 1] = body.vx, body.vy
            radius[s], kind[s] = body.bound, _DYNAMIC
    _clear(kept, position, velocity, radius, kind)


@kernel_without_allocation
def write_forms(
    low: int, high: int, agents: AnyArray, count: IntArray, identity: IntArray,
    heading: FloatArray, half_length: FloatArray, half_width: FloatArray, rounding: FloatArray,
) -> None:  # fmt: skip
    """Write the shapes (B, An, K) of the neighbours in worlds low:high that are not discs."""
    for b in range(low, high):
        for k in range(count.shape[1]):
            for s in range(count[b, k]):
                j = identity[b, k, s]
                if j >= 0 and agents[b, j].shaped:
                    a = agents[b, j]
                    heading[b, k, s], rounding[b, k, s] = a.heading, a.rounding
                    half_length[b, k, s] = a.core_length + a.rounding
                    half_width[b, k, s] = a.core_width + a.rounding


@kernel_without_allocation
def _identify(kept: int, spots: AnyArray, ranked: IntArray, identity: IntArray) -> None:
    """Write the identities of the ranked places."""
    for s in range(kept):
        identity[s] = spots[ranked[s]].index if ranked[s] >= 0 else ranked[s]


@kernel_without_allocation
def _clear(
    first: int, position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray
) -> None:
    """Set the readings behind the last neighbour to zero."""
    for s in range(first, len(radius)):
        position[s, 0], position[s, 1] = 0.0, 0.0
        velocity[s, 0], velocity[s, 1] = 0.0, 0.0
        radius[s], kind[s] = 0.0, 0


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
    a: Any, n: int, most: int, limit: float, spots: AnyArray, world: Any, capsules: AnyArray,
    start: IntArray, item: IntArray, bodies: AnyArray, shapes: AnyArray, ranked: IntArray,
    size: int, discs: bool, fixed: FloatArray, blockers: IntArray,
) -> int:  # fmt: skip
    """Move up to ``most`` visible candidates to the front of ``ranked``; return their number."""
    stand_at(a.x, a.y, size, fixed)
    blocker_count = list_blockers(a, limit, world.bodies, bodies, blockers)
    kept = 0
    for s in range(n):
        m = -1 - ranked[s]
        x, y = 0.0, 0.0
        if m < 0:
            x, y = spots[ranked[s]].x, spots[ranked[s]].y
        else:
            x, y = bodies[m].x, bodies[m].y
        if kept < most and in_sight(
            a.x, a.y, x, y, max(m, -1), world, capsules, start, item, bodies, shapes, size, discs,
            fixed, blocker_count, blockers,
        ):  # fmt: skip
            ranked[kept] = ranked[s]
            kept += 1
    return kept
