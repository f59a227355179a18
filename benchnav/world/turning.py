"""Turns of agents that are not discs: no part of a body swings into anything.

Agents turn at the end of a substep, one after another. A turn is divided into pieces in which no
point of the core moves more than SWING. If a piece would overlap something, it is a contact with
the contact rule's effect: under `slide`, the body gives way along the normal, so that it can
turn away from a wall; if there is no room to give way, or under the other rules, the rest of the
turn is refused. A turn leaves no overlap deeper than SLACK that was not there before. Between
two pieces, a corner may be deeper by the sagitta of its arc, at most SWING² / (8 r) for its
distance r to the centre.
"""

import math
from typing import Any

from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.episode.episode import Status
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.geometry.hash_grid import bucket
from benchnav.geometry.rotation import cos_sin, wrap
from benchnav.kernels import kernel_without_allocation
from benchnav.world.contacts import MAX_HITS, touch_in_turn
from benchnav.world.fixed import cell_at
from benchnav.world.touch import (
    AGENT,
    BODY,
    BRUTE_FORCE,
    FIXED,
    WIDER,
    from_agent,
    from_body,
    from_fixed,
)

SWING = 0.005  # [m] way of a core's point in a piece of a turn; less for thin bodies
SLACK = 1e-9  # [m] an overlap that rounding may cause
GIVES = 4  # times that a body may give way within a piece
_ACTIVE = int(Status.ACTIVE)


@kernel_without_allocation
def turn_agents(
    time: float, world: Any, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, direction: FloatArray, opened: AnyArray,
    closed: AnyArray, hashed: IntArray, spots: AnyArray, near: IntArray,
) -> None:  # fmt: skip
    """Turn the agents that are not discs, at the end of a substep.

    A twist turns an agent at its turn rate, and a planar velocity towards its ``direction`` (A,)
    [rad], at most at the largest turn rate. ``hashed`` and ``spots`` of a crowd are those of the
    start of the substep; ``near`` (A,) is scratch.
    """
    moved = _farthest(agents, hashed, spots)
    for i in range(world.agents):
        a = agents[i]
        if not a.shaped or a.status != _ACTIVE or not a.present:
            continue
        turn = a.drive_1 * world.h
        if not a.turning:
            most = a.max_turn_rate * world.h
            moves = a.drive_0 != 0.0 or a.drive_1 != 0.0
            turn = min(max(wrap(direction[i] - a.heading), -most), most) if moves else 0.0
        if turn != 0.0:
            _turn(
                i, turn, time, world, agents, bodies, shapes, capsules, start, item, opened, closed,
                hashed, spots, moved, near,
            )  # fmt: skip
            if len(agents) > BRUTE_FORCE:
                moved = max(moved, _way_from(a, spots[a.spot]))


@kernel_without_allocation
def _turn(
    i: int, turn: float, time: float, world: Any, agents: AnyArray, bodies: AnyArray,
    shapes: AnyArray, capsules: AnyArray, start: IntArray, item: IntArray, opened: AnyArray,
    closed: AnyArray, hashed: IntArray, spots: AnyArray, moved: float, near: IntArray,
) -> None:  # fmt: skip
    """Turn agent i by ``turn`` [rad], or as far as nothing is in its way."""
    a = agents[i]
    way = abs(turn) * math.sqrt(a.core_length * a.core_length + a.core_width * a.core_width)
    x, y, axis_x, axis_y = a.x, a.y, a.axis_x, a.axis_y
    gap = _worst(
        i, way, x, y, axis_x, axis_y, world, agents, bodies, shapes, capsules, start, item, hashed,
        spots, moved, near,
    )[0]  # fmt: skip
    pieces, touches, touched = 1, 0, -1
    if gap < way:
        pieces = math.ceil(way / min(SWING, 0.5 * a.inner_radius))
    for _ in range(pieces):
        x, y, heading, axis_x, axis_y = a.x, a.y, a.heading, a.axis_x, a.axis_y
        a.heading = wrap(heading + turn / pieces)
        a.axis_x, a.axis_y = cos_sin(a.heading)
        for attempt in range(GIVES + 1):
            if gap >= way:
                break  # nothing is near enough
            _, deficit, nx, ny, code = _worst(
                i, 0.0, x, y, axis_x, axis_y, world, agents, bodies, shapes, capsules, start, item,
                hashed, spots, moved, near,
            )  # fmt: skip
            if code < 0:
                break
            gives = attempt < GIVES and touches < MAX_HITS
            if code != touched and touches < MAX_HITS:
                touched, touches = code, touches + 1
                closing = deficit * pieces / world.h
                slides = touch_in_turn(
                    i, time, closing, nx, ny, code, world, agents, opened, closed
                )
                gives = gives and slides
            if not gives:
                a.x, a.y, a.heading, a.axis_x, a.axis_y = x, y, heading, axis_x, axis_y
                return
            a.x += deficit * nx
            a.y += deficit * ny


@kernel_without_allocation
def _worst(
    i: int, reach: float, x: float, y: float, axis_x: float, axis_y: float, world: Any,
    agents: AnyArray, bodies: AnyArray, shapes: AnyArray, capsules: AnyArray, start: IntArray,
    item: IntArray, hashed: IntArray, spots: AnyArray, moved: float, near: IntArray,
) -> tuple[float, float, float, float, int]:  # fmt: skip
    """Compare agent i with its earlier pose at (x, y).

    Return the least gap [m] to anything within ``reach`` [m], and of the partner whose overlap grew
    most: the growth [m], the unit normal towards the agent, and the code as recorded (of
    a fixed capsule, that of its solid), -1 if there is none. Of equals it is the first, by index.
    """
    a = agents[i]
    least, most, nx, ny, code = math.inf, SLACK, 0.0, 0.0, -1
    cell = cell_at(world, a.x, a.y)
    for at in range(start[cell], start[cell + 1]):
        c = capsules[item[at]]
        qx, qy = nearest_on_segment(a.x, a.y, c.x0, c.y0, c.x1, c.y1)
        if not _within(a.x - qx, a.y - qy, a.radius + c.r + reach):
            continue
        ex, ey, gap = from_fixed(a, c)
        least = min(least, gap)
        if -gap > most:
            pose = _take_pose(a, x, y, axis_x, axis_y)
            growth = min(from_fixed(a, c)[2], 0.0) - gap
            _take_pose(a, pose[0], pose[1], pose[2], pose[3])
            if growth > most:
                most, nx, ny, code = growth, ex, ey, 4 * c.solid + FIXED
    for m in range(world.bodies):
        body = bodies[m]
        if not _within(a.x - body.x, a.y - body.y, a.radius + body.bound + reach):
            continue
        ex, ey, gap = from_body(a, body, shapes)
        least = min(least, gap)
        if -gap > most:
            pose = _take_pose(a, x, y, axis_x, axis_y)
            growth = min(from_body(a, body, shapes)[2], 0.0) - gap
            _take_pose(a, pose[0], pose[1], pose[2], pose[3])
            if growth > most:
                most, nx, ny, code = growth, ex, ey, 4 * m + BODY
    for k in range(_list_agents(i, reach, moved, world, agents, hashed, spots, near)):
        j = near[k]
        b = agents[j]
        ex, ey, gap = from_agent(a, b)
        least = min(least, gap)
        if -gap >= most:
            pose = _take_pose(a, x, y, axis_x, axis_y)
            growth = min(from_agent(a, b)[2], 0.0) - gap
            _take_pose(a, pose[0], pose[1], pose[2], pose[3])
            first = code % 4 == AGENT and j < code // 4
            if growth > most or (growth == most and first):
                most, nx, ny, code = growth, ex, ey, 4 * j + AGENT
    length = math.sqrt(nx * nx + ny * ny)
    if length > 0.0:
        nx, ny = nx / length, ny / length
    return least, most, nx, ny, code


@kernel_without_allocation
def _list_agents(
    i: int, reach: float, moved: float, world: Any, agents: AnyArray, hashed: IntArray,
    spots: AnyArray, near: IntArray,
) -> int:  # fmt: skip
    """List the agents within ``reach`` [m] of agent i in ``near``; return their number.

    No agent is farther than ``moved`` [m] from its spot.
    """
    a, n = agents[i], 0
    if len(agents) <= BRUTE_FORCE:
        for j in range(world.agents):
            near[n] = j
            n += _is_near(i, j, reach, agents)
        return n
    size, side = len(hashed) - 1, world.cells
    far = WIDER * (a.radius + world.widest + reach + moved)
    first, last = math.floor((a.x - far) / side), math.floor((a.x + far) / side)
    for row in range(math.floor((a.y - far) / side), math.floor((a.y + far) / side) + 1):
        low = bucket(first, row, size)
        high = low + min(last - first + 1, size)
        for part in range(2 if high > size else 1):  # the row may continue at the table's start
            begin, end = (low, min(high, size)) if part == 0 else (0, high - size)
            for at in range(hashed[begin], hashed[end]):
                near[n] = spots[at].index
                n += spots[at].cj == row and _is_near(i, near[n], reach, agents)
    return n


@kernel_without_allocation
def _is_near(i: int, j: int, reach: float, agents: AnyArray) -> bool:
    a, b = agents[i], agents[j]
    close = _within(a.x - b.x, a.y - b.y, a.radius + b.radius + reach)
    return bool(close and j != i and b.present)


@kernel_without_allocation
def _farthest(agents: AnyArray, hashed: IntArray, spots: AnyArray) -> float:
    """Return the largest way [m] of an agent of a crowd from its spot."""
    farthest = 0.0
    if len(agents) > BRUTE_FORCE:
        for at in range(hashed[-1]):
            farthest = max(farthest, _way_from(agents[spots[at].index], spots[at]))
    return farthest


@kernel_without_allocation
def _way_from(a: Any, spot: Any) -> float:
    dx, dy = a.x - spot.x, a.y - spot.y
    return math.sqrt(dx * dx + dy * dy)


@kernel_without_allocation
def _within(dx: float, dy: float, reach: float) -> bool:
    return bool(dx * dx + dy * dy < reach * reach)


@kernel_without_allocation
def _take_pose(
    a: Any, x: float, y: float, axis_x: float, axis_y: float
) -> tuple[float, float, float, float]:
    """Give agent a another pose; return the one that it had."""
    pose = (a.x, a.y, a.axis_x, a.axis_y)
    a.x, a.y, a.axis_x, a.axis_y = x, y, axis_x, axis_y
    return pose
