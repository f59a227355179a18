"""One decision of every running world: reads t, writes t + dt.

Within a substep all bodies move straight, so every touch has a closed-form time.
The world advances from touch to touch, earliest first (ties by agent index,
then by the order in `touch.find_next`): bodies never tunnel at any speed, and no
result depends on how worlds are batched or shared between threads.
"""

import math
from typing import Any

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Status
from benchnav.geometry.rotation import angle_of, wrap
from benchnav.kernels import inlined, kernel, kernel_without_allocation
from benchnav.world.bodies import body_at, is_away
from benchnav.world.contacts import MAX_HITS, follow_up, record_wedged, touch
from benchnav.world.crowd import ROWS, advance_crowd, find_all_in_crowd, sort_spots
from benchnav.world.dynamics import limited, planar_velocity
from benchnav.world.entry import admit
from benchnav.world.fixed import cell_at
from benchnav.world.footprint import set_axes
from benchnav.world.motion_limits import within_limits
from benchnav.world.touch import BRUTE_FORCE, find_next, next_agent
from benchnav.world.turning import turn_agents

_ACTIVE = int(Status.ACTIVE)
_STATIC = int(Kind.STATIC)


@kernel
def step_worlds(
    low: int, high: int, command: FloatArray, twist: BoolArray, executed: FloatArray,
    worlds: AnyArray, agents: AnyArray, limits: AnyArray, bodies: AnyArray, shapes: AnyArray,
    knots: AnyArray, capsules: AnyArray, start: IntArray, item: IntArray, opened: AnyArray,
    closed: AnyArray, hashed: IntArray, spots: AnyArray, listed: IntArray, beyond: FloatArray,
) -> None:  # fmt: skip
    """Advance the running worlds of rows low:high; ``executed`` gets the commands within limits."""
    count = agents.shape[1]
    driven, motion = np.empty((3, count)), np.empty((ROWS, count))
    near = np.empty(2 * count + 1, np.int64)
    _step_rows(
        low, high, command, twist, executed, worlds, agents, limits, bodies, shapes, knots,
        capsules, start, item, opened, closed, hashed, spots, listed, beyond, driven, motion, near,
    )  # fmt: skip


@kernel_without_allocation
def _step_rows(
    low: int, high: int, command: FloatArray, twist: BoolArray, executed: FloatArray,
    worlds: AnyArray, agents: AnyArray, limits: AnyArray, bodies: AnyArray, shapes: AnyArray,
    knots: AnyArray, capsules: AnyArray, start: IntArray, item: IntArray, opened: AnyArray,
    closed: AnyArray, hashed: IntArray, spots: AnyArray, listed: IntArray, beyond: FloatArray,
    driven: FloatArray, motion: FloatArray, near: IntArray,
) -> None:  # fmt: skip
    for b in range(low, high):
        if worlds[b].running:
            step_world(
                command[b], twist[b], executed[b], worlds[b], agents[b], limits[b], bodies[b],
                shapes, knots, capsules, start, item, opened[b], closed[b], hashed[b], spots[b],
                listed[b], beyond[b], driven, motion, near,
            )  # fmt: skip


@kernel_without_allocation
def step_world(
    command: FloatArray, twist: BoolArray, executed: FloatArray, world: Any, agents: AnyArray,
    limits: AnyArray, bodies: AnyArray, shapes: AnyArray, knots: AnyArray, capsules: AnyArray,
    start: IntArray, item: IntArray, opened: AnyArray, closed: AnyArray, hashed: IntArray,
    spots: AnyArray, listed: IntArray, beyond: FloatArray, driven: FloatArray, motion: FloatArray,
    near: IntArray,
) -> None:  # fmt: skip
    """Advance one world: arrays over its agents (A,), bodies (M,) and contacts (A, 8).

    ``driven`` (3, A), ``motion`` (6, A) and ``near`` (2 A + 1,) are scratch.
    """
    relocate(world.steps_done * world.dt, world, agents, bodies, knots)
    if world.shaped:
        set_axes(world, agents)
    if obey(command, twist, executed, world, agents, limits, driven):
        find_directions(driven[0], driven[1], driven[2])
    for s in range(world.substeps):
        tick = world.steps_done * world.substeps + s
        begin, end = tick * world.h, (tick + 1) * world.h
        aim_bodies(end, world, bodies, knots)
        top = aim_agents(world, agents)
        if len(agents) > BRUTE_FORCE:
            sort_spots(world, agents, hashed, spots, beyond, motion)
            find_all_in_crowd(
                top, world, agents, bodies, shapes, capsules, start, item, hashed, spots, listed,
                beyond, motion, near,
            )  # fmt: skip
            left = advance_crowd(
                begin, top, world, agents, bodies, shapes, capsules, start, item, opened, closed,
                hashed, spots, motion, near,
            )  # fmt: skip
        else:
            find_all(world, agents, bodies, shapes, capsules, start, item)
            left = advance(
                begin, world, agents, bodies, shapes, capsules, start, item, opened, closed
            )
        land_agents(left, world, agents, driven[2])
        land_bodies(world, bodies)
        if world.shaped:
            turn_agents(
                end, world, agents, bodies, shapes, capsules, start, item, driven[2], opened,
                closed, hashed, spots, near,
            )  # fmt: skip
        follow_up(end, world, agents, bodies, shapes, capsules, start, item, opened, closed)
    world.steps_done += 1
    if world.waiting > 0:
        admit(world, agents, bodies, shapes)
    world.running = goes_on(world, agents)


@kernel_without_allocation
def relocate(time: float, world: Any, agents: AnyArray, bodies: AnyArray, knots: AnyArray) -> None:
    """Relocate the static obstacles that are due and whose new place is free.

    Free: no agent or dynamic obstacle touches the obstacle's circumscribed circle there.
    `build` keeps the new place clear of other static solids.
    """
    for m in range(world.bodies):
        body = bodies[m]
        if body.kind != _STATIC or body.placed or time < knots[body.law_last - 1].t:
            continue
        x, y = knots[body.law_last - 1].x, knots[body.law_last - 1].y
        free = True
        for i in range(world.agents):
            a = agents[i]
            if a.present and _within(a.x - x, a.y - y, body.bound + a.radius):
                free = False
        for k in range(world.bodies):
            other = bodies[k]
            if other.kind != _STATIC and _within(
                other.x - x, other.y - y, body.bound + other.bound
            ):
                free = False
        if free:
            body.placed = True
            body.x, body.y = x, y
            world.revision += 1


@kernel_without_allocation
def _within(dx: float, dy: float, reach: float) -> bool:
    return bool(dx * dx + dy * dy < reach * reach)


@inlined
def obey(
    command: FloatArray, twist: BoolArray, executed: FloatArray, world: Any, agents: AnyArray,
    limits: AnyArray, driven: FloatArray,
) -> bool:  # fmt: skip
    """Store commands within limits; return whether any is a planar velocity.

    They are copied to the first two rows of ``driven`` too.
    """
    planar = False
    for i in range(world.agents):
        a = agents[i]
        a.halted = False
        a.turning = a.nonholonomic or twist[i]
        if a.status != _ACTIVE or not a.present:
            a.drive_0, a.drive_1 = 0.0, 0.0
        elif world.limited:
            a.drive_0, a.drive_1 = within_limits(
                command[i, 0], command[i, 1], twist[i], a.heading, a.drive_0, a.drive_1, limits[i],
                world.dt,
            )  # fmt: skip
        else:
            a.drive_0, a.drive_1 = limited(
                command[i, 0], command[i, 1], twist[i], a.nonholonomic, a.heading, a.max_speed,
                a.max_turn_rate, world.dt,
            )  # fmt: skip
        executed[i, 0], executed[i, 1] = a.drive_0, a.drive_1
        driven[0, i], driven[1, i] = a.drive_0, a.drive_1
        planar = planar or not a.turning
    return planar


@kernel_without_allocation
def find_directions(vx: FloatArray, vy: FloatArray, direction: FloatArray) -> None:
    """Write the direction [rad] of each velocity (A,). The loop is compiled to vector code."""
    for i in range(len(direction)):
        direction[i] = wrap(angle_of(vx[i], vy[i]))


@inlined
def aim_bodies(end: float, world: Any, bodies: AnyArray, knots: AnyArray) -> None:
    """Set the velocities that move the bodies straight to their laws' positions at ``end`` [s].

    A body that appears or vanishes within the substep stands still until its end.
    """
    for m in range(world.bodies):
        body = bodies[m]
        body.next_x, body.next_y = body_at(body, knots, end)
        body.vx, body.vy = (body.next_x - body.x) / world.h, (body.next_y - body.y) / world.h
        if is_away(body.next_x, body.next_y) != is_away(body.x, body.y):
            body.vx, body.vy = 0.0, 0.0


@inlined
def aim_agents(world: Any, agents: AnyArray) -> float:
    """Set the velocities of this substep; return the highest speed [m/s]."""
    top = 0.0
    for i in range(world.agents):
        a = agents[i]
        a.hits = 0
        a.vx, a.vy = 0.0, 0.0
        if a.status == _ACTIVE and a.present and not a.halted:
            a.vx, a.vy = planar_velocity(a.drive_0, a.drive_1, a.turning, a.heading, world.h)
            top = max(top, a.vx * a.vx + a.vy * a.vy)
    return math.sqrt(top)


@inlined
def find_all(
    world: Any, agents: AnyArray, bodies: AnyArray, shapes: AnyArray, capsules: AnyArray,
    start: IntArray, item: IntArray,
) -> None:  # fmt: skip
    """Find the next touch of every agent."""
    for i in range(world.agents):
        a = agents[i]
        a.tau = math.inf
        if a.status == _ACTIVE and a.present:
            a.home = cell_at(world, a.x, a.y)
            meeting, partner = next_agent(i, world.h, agents)
            find_next(
                i, meeting, partner, world.h, world.tolerance, agents, bodies, shapes, capsules,
                start, item, world.bodies,
            )  # fmt: skip


@inlined
def advance(
    begin: float, world: Any, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, opened: AnyArray, closed: AnyArray,
) -> float:  # fmt: skip
    """Advance from touch to touch; return the time [s] from the last one to the substep's end."""
    left: float = world.h
    i = earliest(world, agents)
    while i >= 0 and agents[i].tau <= left:
        elapsed = agents[i].tau
        drift(elapsed, world, agents, bodies)
        left -= elapsed
        now = begin + (world.h - left)
        j = touch(i, now, world, agents, bodies, shapes, capsules, opened, closed)
        best, first = math.inf, -1
        for k in range(world.agents):
            a = agents[k]
            if k in (i, j) or _affected(a, i, j, world.reach, agents):
                a.tau = math.inf
                if a.status != _ACTIVE or not a.present:
                    continue
                if a.hits >= MAX_HITS:  # it stands still until the next substep
                    record_wedged(k, now, left, world, agents, bodies, shapes, opened, closed)
                else:
                    meeting, partner = next_agent(k, left, agents)
                    find_next(
                        k, meeting, partner, left, world.tolerance, agents, bodies, shapes,
                        capsules, start, item, world.bodies,
                    )  # fmt: skip
            if a.tau < best:
                best, first = a.tau, k
        i = first
    return left


@kernel_without_allocation
def _affected(a: Any, i: int, j: int, reach: float, agents: AnyArray) -> bool:
    """Whether the next touch of a could be with i or j, after their motion changed."""
    if _within(a.x - agents[i].x, a.y - agents[i].y, reach):
        return True
    return j >= 0 and _within(a.x - agents[j].x, a.y - agents[j].y, reach)


@kernel_without_allocation
def earliest(world: Any, agents: AnyArray) -> int:
    """Return the agent with the earliest next touch; -1 if there is none."""
    best, first = math.inf, -1
    for i in range(world.agents):
        if agents[i].tau < best:
            best, first = agents[i].tau, i
    return first


@inlined
def drift(t: float, world: Any, agents: AnyArray, bodies: AnyArray) -> None:
    """Move everything straight for t seconds."""
    for i in range(world.agents):
        a = agents[i]
        a.x += a.vx * t
        a.y += a.vy * t
        a.tau -= t
    for m in range(world.bodies):
        body = bodies[m]
        body.x += body.vx * t
        body.y += body.vy * t


@inlined
def land_bodies(world: Any, bodies: AnyArray) -> None:
    """Put bodies at their laws' positions, to remove accumulated rounding."""
    for m in range(world.bodies):
        body = bodies[m]
        body.x, body.y = body.next_x, body.next_y


@inlined
def land_agents(left: float, world: Any, agents: AnyArray, direction: FloatArray) -> None:
    """Move agents straight for ``left`` [s], and turn the discs.

    A twist turns an agent at its turn rate, and a planar velocity to face its direction.
    """
    for i in range(world.agents):
        a = agents[i]
        a.x += a.vx * left
        a.y += a.vy * left
        if a.status != _ACTIVE or not a.present or a.shaped:
            continue  # `turn_agents` turns bodies that are not discs
        if a.turning:
            a.heading = wrap(a.heading + a.drive_1 * world.h)
        elif a.drive_0 != 0.0 or a.drive_1 != 0.0:
            a.heading = direction[i]


@inlined
def goes_on(world: Any, agents: AnyArray) -> bool:
    """Whether an evaluated agent is active and the horizon is ahead."""
    if world.steps_done >= world.steps:
        return False
    for i in range(world.agents):
        if agents[i].evaluated and agents[i].present and agents[i].status == _ACTIVE:
            return True
    return False
