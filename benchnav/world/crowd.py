"""Touches between the agents of a crowd: each agent reads only the cells around it.

Within a substep, the motion of all agents is kept in plain arrays, in the order of their spots: a
touch moves every agent, and the loops over plain arrays are compiled to vector code.
"""

import math
from typing import Any

from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.episode.episode import Status
from benchnav.geometry.capsule import disc_time
from benchnav.geometry.hash_grid import bucket, fill, follow
from benchnav.kernels import kernel_without_allocation
from benchnav.world.contacts import MAX_HITS, record_wedged, touch
from benchnav.world.fixed import cell_at
from benchnav.world.footprint import agents_time
from benchnav.world.touch import AGENT, WIDER, find_next

X, Y, VX, VY, RADIUS, TAU = range(6)  # rows of the motion: [m], [m/s], [s] until the next touch
ROWS = 6
BLOCK = 16  # spots that are tested together
_ACTIVE = int(Status.ACTIVE)


@kernel_without_allocation
def sort_spots(
    world: Any, agents: AnyArray, hashed: IntArray, spots: AnyArray, beyond: FloatArray,
    motion: FloatArray,
) -> None:  # fmt: skip
    """Bring spots and ``motion`` (6, A) up to date at the start of a substep.

    The spots that sensing sorted, and its lists, serve again unless agents have moved since.
    """
    if not follow(agents, hashed, spots):
        world.cells = world.reach
        fill(agents, hashed, spots, world.cells)
        beyond[:] = -1.0
    for at in range(hashed[-1]):
        spot = spots[at]
        agents[spot.index].spot = at
        motion[X, at], motion[Y, at] = spot.x, spot.y
        motion[VX, at], motion[VY, at] = spot.vx, spot.vy
        motion[RADIUS, at], motion[TAU, at] = spot.radius, math.inf


@kernel_without_allocation
def listed_agent(
    own: int, left: float, way: float, widest: float, shaped: bool, agents: AnyArray,
    spots: AnyArray, listed: IntArray, motion: FloatArray,
) -> tuple[float, int]:  # fmt: skip
    """Return the same as `next_agent` from a list of the nearest spots.

    Both come closer by at most ``way`` [m], and no radius is larger than ``widest`` [m].
    """
    best, partner = math.inf, -1
    far = motion[RADIUS, own] + widest + way
    for k in range(1, listed[0] + 1):
        at = listed[k]
        fx, fy = motion[X, own] - motion[X, at], motion[Y, own] - motion[Y, at]
        if fx * fx + fy * fy > WIDER * far * far:
            break
        t, j = pair_time(own, at, left, shaped, agents, spots, motion), spots[at].index
        if t <= left and (t < best or (t == best and j < partner)):
            best, partner = t, j
    return best, partner


@kernel_without_allocation
def next_agent(
    own: int, left: float, reach: float, side: float, shaped: bool, agents: AnyArray,
    hashed: IntArray, spots: AnyArray, motion: FloatArray, near: IntArray,
) -> tuple[float, int]:  # fmt: skip
    """Return (time, index) of the agent that spot ``own`` touches first within ``left`` [s].

    It is (inf, -1) if there is none. Spots of cells (of ``side`` [m]) within ``reach`` [m] that
    approach and are near enough are listed in ``near`` (scratch), without branches that cannot be
    predicted. Long bodies may touch although their centres separate.
    """
    n, size = 0, len(hashed) - 1
    x, y, vx, vy = motion[X, own], motion[Y, own], motion[VX, own], motion[VY, own]
    radius, separating = motion[RADIUS, own], math.inf if shaped else 0.0
    first, last = math.floor((x - reach) / side), math.floor((x + reach) / side)
    for row in range(math.floor((y - reach) / side), math.floor((y + reach) / side) + 1):
        low = bucket(first, row, size)
        high = low + min(last - first + 1, size)
        for part in range(2 if high > size else 1):  # the row may continue at the table's start
            begin, end = (low, min(high, size)) if part == 0 else (0, high - size)
            for at in range(hashed[begin], hashed[end]):
                fx, fy = x - motion[X, at], y - motion[Y, at]
                wx, wy = vx - motion[VX, at], vy - motion[VY, at]
                far = radius + motion[RADIUS, at] + WIDER * (abs(wx) + abs(wy)) * left
                near[n] = at
                approach = fx * wx + fy * wy < separating
                within = (fx * fx + fy * fy <= WIDER * far * far) & approach
                n += within & (spots[at].cj == row)
    best, partner = math.inf, -1
    for k in range(n):
        if near[k] == own:
            continue
        t, j = pair_time(own, near[k], left, shaped, agents, spots, motion), spots[near[k]].index
        if t <= left and (t < best or (t == best and j < partner)):
            best, partner = t, j
    return best, partner


@kernel_without_allocation
def pair_time(
    a: int, b: int, left: float, shaped: bool, agents: AnyArray, spots: AnyArray,
    motion: FloatArray,
) -> float:  # fmt: skip
    """Return the time until the agents at spots a and b touch at their current velocities."""
    if shaped:
        own, other = agents[spots[a].index], agents[spots[b].index]
        if own.shaped or other.shaped:
            return agents_time(
                motion[X, a] - motion[X, b], motion[Y, a] - motion[Y, b],
                motion[VX, a] - motion[VX, b], motion[VY, a] - motion[VY, b], left, own, other,
            )  # fmt: skip
    return disc_time(
        motion[X, a] - motion[X, b], motion[Y, a] - motion[Y, b],
        motion[VX, a] - motion[VX, b], motion[VY, a] - motion[VY, b],
        motion[RADIUS, a] + motion[RADIUS, b],
    )  # fmt: skip


@kernel_without_allocation
def find_all_in_crowd(
    top: float, world: Any, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray, spots: AnyArray,
    listed: IntArray, beyond: FloatArray, motion: FloatArray, near: IntArray,
) -> None:  # fmt: skip
    """Find the next touch of every agent; none is faster than ``top`` [m/s]."""
    for own in range(hashed[-1]):
        i = spots[own].index
        a = agents[i]
        a.tau = math.inf
        if a.status == _ACTIVE:
            a.home = cell_at(world, a.x, a.y)
            way = WIDER * (math.sqrt(a.vx * a.vx + a.vy * a.vy) + top) * world.h
            far = a.radius + world.widest + way
            if WIDER * far < beyond[i]:
                meeting, partner = listed_agent(
                    own, world.h, way, world.widest, world.shaped, agents, spots, listed[i], motion
                )  # fmt: skip
            else:
                meeting, partner = next_agent(
                    own, world.h, far, world.cells, world.shaped, agents, hashed, spots, motion,
                    near,
                )  # fmt: skip
            find_next(
                i, meeting, partner, world.h, world.tolerance, agents, bodies, shapes, capsules,
                start, item, world.bodies,
            )  # fmt: skip
            motion[TAU, own] = a.tau


@kernel_without_allocation
def advance_crowd(
    begin: float, top: float, world: Any, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, opened: AnyArray, closed: AnyArray,
    hashed: IntArray, spots: AnyArray, motion: FloatArray, near: IntArray,
) -> float:  # fmt: skip
    """Do the same as `step.advance` for a crowd: agents far from a touch only move on."""
    left: float = world.h
    count = hashed[-1]
    first = earliest(count, spots, motion)
    if first < 0 or motion[TAU, first] > left:
        return left
    fastest = max(top, 0.5 * world.reach / world.h) if world.bodies > 0 else top  # pushed by bodies
    while first >= 0 and motion[TAU, first] <= left:
        elapsed = motion[TAU, first]
        drift(elapsed, count, motion)
        for m in range(world.bodies):
            bodies[m].x += bodies[m].vx * elapsed
            bodies[m].y += bodies[m].vy * elapsed
        left -= elapsed
        i, code = spots[first].index, agents[spots[first].index].code
        second = agents[code // 4].spot if code % 4 == AGENT else first
        _take_motion(agents[i], first, motion)
        _take_motion(agents[spots[second].index], second, motion)
        now = begin + (world.h - left)
        touch(i, now, world, agents, bodies, shapes, capsules, opened, closed)
        affected = near_either(first, second, count, world.reach, motion, near)
        _give_motion(agents[i], first, motion)
        _give_motion(agents[spots[second].index], second, motion)
        for k in range(affected):
            own = near[k]
            a = agents[spots[own].index]
            motion[TAU, own] = math.inf
            if a.status != _ACTIVE or not a.present:
                continue
            _take_motion(a, own, motion)
            if a.hits >= MAX_HITS:  # it stands still until the next substep
                record_wedged(
                    spots[own].index, now, left, world, agents, bodies, shapes, opened, closed
                )
            else:
                way = (math.sqrt(a.vx * a.vx + a.vy * a.vy) + fastest) * left
                way += fastest * (world.h - left)  # since the spots were sorted
                meeting, partner = next_agent(
                    own, left, a.radius + world.widest + WIDER * way, world.cells, world.shaped,
                    agents, hashed, spots, motion, near[affected:],
                )  # fmt: skip
                find_next(
                    spots[own].index, meeting, partner, left, world.tolerance, agents, bodies,
                    shapes, capsules, start, item, world.bodies,
                )  # fmt: skip
                motion[TAU, own] = a.tau
        first = earliest(count, spots, motion)
    for own in range(count):
        if agents[spots[own].index].present:
            _take_motion(agents[spots[own].index], own, motion)
    return left


@kernel_without_allocation
def _take_motion(a: Any, own: int, motion: FloatArray) -> None:
    a.x, a.y = motion[X, own], motion[Y, own]


@kernel_without_allocation
def _give_motion(a: Any, own: int, motion: FloatArray) -> None:
    """Copy the velocity of agent a after a touch; put it out of reach if it has vanished."""
    motion[VX, own], motion[VY, own] = a.vx, a.vy
    if not a.present:
        motion[X, own] = math.inf


@kernel_without_allocation
def drift(t: float, count: int, motion: FloatArray) -> None:
    """Move all agents straight for t seconds."""
    for at in range(count):
        motion[X, at] += motion[VX, at] * t
        motion[Y, at] += motion[VY, at] * t
        motion[TAU, at] -= t


@kernel_without_allocation
def earliest(count: int, spots: AnyArray, motion: FloatArray) -> int:
    """Return the spot of the agent with the earliest next touch; -1 if there is none.

    Of several, it is the agent with the smallest index.
    """
    best, first = math.inf, -1
    for block in range(0, count, BLOCK):
        soon = False
        for at in range(block, min(block + BLOCK, count)):
            soon |= motion[TAU, at] <= best
        if not soon:
            continue
        for at in range(block, min(block + BLOCK, count)):
            t = motion[TAU, at]
            if t < best or (t == best < math.inf and spots[at].index < spots[first].index):
                best, first = t, at
    return first


@kernel_without_allocation
def near_either(
    first: int, second: int, count: int, reach: float, motion: FloatArray, near: IntArray
) -> int:
    """List the spots whose next touch could be with one of two, whose motion changed."""
    n = 0
    for block in range(0, count, BLOCK):
        end, close = min(block + BLOCK, count), False
        for at in range(block, end):
            close |= _within(at, first, reach, motion) | _within(at, second, reach, motion)
        if not close:
            continue
        for at in range(block, end):
            near[n] = at
            n += _within(at, first, reach, motion) | _within(at, second, reach, motion)
    return n


@kernel_without_allocation
def _within(a: int, b: int, reach: float, motion: FloatArray) -> bool:
    fx, fy = motion[X, a] - motion[X, b], motion[Y, a] - motion[Y, b]
    return bool(fx * fx + fy * fy < reach * reach)
