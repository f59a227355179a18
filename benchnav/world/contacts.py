"""Effects of contacts: the record of collision events, and the response of the bodies."""

import math
from typing import Any

from benchnav.arena.world import ContactRule
from benchnav.arrays import AnyArray, IntArray
from benchnav.episode.episode import Status
from benchnav.kernels import kernel_without_allocation
from benchnav.world.fixed import cell_at
from benchnav.world.touch import (
    AGENT,
    BODY,
    FIXED,
    GOAL,
    body_gap,
    body_time,
    from_agent,
    from_body,
    from_fixed,
)

RELEASE = 0.01  # [m] a contact ends at a wider gap: sliding bodies separate by a sagitta
MAX_HITS = 8  # after this many touches within a substep, an agent is wedged and stands still

_ACTIVE, _ARRIVED, _ENDED = int(Status.ACTIVE), int(Status.ARRIVED), int(Status.ENDED)
_STOP, _END = int(ContactRule.STOP), int(ContactRule.END)


@kernel_without_allocation
def touch(
    i: int, time: float, world: Any, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, opened: AnyArray, closed: AnyArray,
) -> int:  # fmt: skip
    """Record agent i's contact with the partner in its code, and respond. Return an agent or -1."""
    a = agents[i]
    which, k = a.code % 4, a.code // 4
    if which == GOAL:
        a.arrival = time
        _finish(i, _ARRIVED, world.vanish_on_arrival, time, world, a, opened[i], closed)
        return -1
    if which == AGENT:
        _touch_agent(i, k, time, world, agents, opened, closed)
        return int(k)
    ux, uy = 0.0, 0.0
    code = a.code
    if which == FIXED:
        dx, dy, _ = from_fixed(a, capsules[k])
        code = 4 * capsules[k].solid + FIXED
    else:
        dx, dy, _ = from_body(a, bodies[k], shapes)
        ux, uy = bodies[k].vx, bodies[k].vy
    nx, ny = _unit(dx, dy)
    closing = (ux - a.vx) * nx + (uy - a.vy) * ny
    a.hits += 1
    _record(i, code, time, closing, True, world, a, opened[i], closed)
    _respond(i, nx, ny, closing, time, world, a, opened[i], closed)
    return -1


@kernel_without_allocation
def _touch_agent(
    i: int, j: int, time: float, world: Any, agents: AnyArray, opened: AnyArray, closed: AnyArray
) -> None:
    """Remove each agent's own motion towards the other: agents do not push each other."""
    a, b = agents[i], agents[j]
    dx, dy, _ = from_agent(a, b)
    nx, ny = _unit(dx, dy)
    own, other = a.vx * nx + a.vy * ny, b.vx * nx + b.vy * ny
    active = b.status == _ACTIVE
    a.hits += 1
    b.hits += 1
    _record(i, 4 * j + AGENT, time, other - own, True, world, a, opened[i], closed)
    charged = active or world.charge_both
    _record(j, 4 * i + AGENT, time, other - own, charged, world, b, opened[j], closed)
    give_i = max(min(other, 0.0) - own, 0.0)
    give_j = max(other - max(own, 0.0), 0.0)
    if active:
        _respond(j, -nx, -ny, give_j, time, world, b, opened[j], closed)
    _respond(i, nx, ny, give_i, time, world, a, opened[i], closed)


@kernel_without_allocation
def touch_in_turn(
    i: int, time: float, closing: float, nx: float, ny: float, code: int, world: Any,
    agents: AnyArray, opened: AnyArray, closed: AnyArray,
) -> bool:  # fmt: skip
    """Record a contact of agent i that turns, and respond; return whether it may give way.

    Its velocity stays: only its turn is in the way.
    """
    a, k = agents[i], code // 4
    if code % 4 == AGENT:
        b = agents[k]
        active = b.status == _ACTIVE
        _record(i, code, time, closing, True, world, a, opened[i], closed)
        charged = active or world.charge_both
        _record(k, 4 * i + AGENT, time, closing, charged, world, b, opened[k], closed)
        if active:
            _respond(k, -nx, -ny, 0.0, time, world, b, opened[k], closed)
    else:
        _record(i, code, time, closing, True, world, a, opened[i], closed)
    _respond(i, nx, ny, 0.0, time, world, a, opened[i], closed)
    return bool(world.contact != _STOP and world.contact != _END)


@kernel_without_allocation
def record_wedged(
    i: int, now: float, left: float, world: Any, agents: AnyArray, bodies: AnyArray,
    shapes: AnyArray, opened: AnyArray, closed: AnyArray,
) -> None:  # fmt: skip
    """Record the bodies that touch agent i, which is wedged, within the ``left`` [s] of a substep.

    It stands still until then, and bodies never yield: nothing but the record changes. A full
    table stays as it is.
    """
    a = agents[i]
    for m in range(world.bodies):
        body = bodies[m]
        t = body_time(a, body, shapes, left)
        if t > left or not _has_room(opened[i]):
            continue
        x, y = body.x, body.y
        body.x, body.y = x + body.vx * t, y + body.vy * t
        dx, dy, _ = from_body(a, body, shapes)
        body.x, body.y = x, y
        nx, ny = _unit(dx, dy)
        closing = body.vx * nx + body.vy * ny
        _record(i, 4 * m + BODY, now + t, closing, True, world, a, opened[i], closed)


@kernel_without_allocation
def _unit(dx: float, dy: float) -> tuple[float, float]:
    length = math.sqrt(dx * dx + dy * dy)
    return (dx / length, dy / length) if length > 0.0 else (1.0, 0.0)


@kernel_without_allocation
def _respond(
    i: int, nx: float, ny: float, give: float, time: float, world: Any, a: Any, opened: AnyArray,
    closed: AnyArray,
) -> None:  # fmt: skip
    """Apply the contact rule to agent a; SLIDE adds ``give`` [m/s] along the normal (nx, ny)."""
    if world.contact == _END:
        _finish(i, _ENDED, world.vanish_on_end, time, world, a, opened, closed)
    elif world.contact == _STOP or a.hits >= MAX_HITS:
        a.vx = 0.0
        a.vy = 0.0
        a.halted = a.halted or world.contact == _STOP
    else:
        a.vx += give * nx
        a.vy += give * ny


@kernel_without_allocation
def _finish(
    i: int, status: int, vanish: bool, time: float, world: Any, a: Any, opened: AnyArray,
    closed: AnyArray,
) -> None:  # fmt: skip
    """End the attempt of agent a: it stands still or vanishes, and its contacts end."""
    a.status = status
    a.vx = 0.0
    a.vy = 0.0
    if vanish:
        a.present = False
    _close_all(i, time, world, a, opened, closed)


@kernel_without_allocation
def _record(
    i: int, code: int, time: float, closing: float, charged: bool, world: Any, a: Any,
    opened: AnyArray, closed: AnyArray,
) -> None:  # fmt: skip
    """Open an event unless this contact is already open; a full table closes its oldest."""
    free, oldest = -1, 0
    for slot in range(len(opened)):
        if opened[slot].code == code:
            return
        if opened[slot].code < 0 and free < 0:
            free = slot
        if opened[slot].start < opened[oldest].start:
            oldest = slot
    if free < 0:
        free = oldest
        _close(i, time, world, opened[free], closed)
    event = opened[free]
    event.code, event.start, event.closing = code, time, closing
    event.penetration, event.charged = 0.0, charged
    event.x, event.y = a.x, a.y
    a.open = True


@kernel_without_allocation
def _has_room(opened: AnyArray) -> bool:
    room = False
    for slot in range(len(opened)):
        room |= opened[slot].code < 0
    return room


@kernel_without_allocation
def _close(i: int, time: float, world: Any, event: Any, closed: AnyArray) -> None:
    """Move an open contact to the list of closed ones."""
    row = closed[world.closed]
    row.agent, row.code, row.start, row.end = i, event.code, event.start, time
    row.penetration, row.closing, row.charged = event.penetration, event.closing, event.charged
    row.x, row.y = event.x, event.y
    world.closed += 1
    event.code = -1


@kernel_without_allocation
def _close_all(i: int, time: float, world: Any, a: Any, opened: AnyArray, closed: AnyArray) -> None:
    for slot in range(len(opened)):
        if opened[slot].code >= 0:
            _close(i, time, world, opened[slot], closed)
    a.open = False


@kernel_without_allocation
def follow_up(
    time: float, world: Any, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray, opened: AnyArray, closed: AnyArray,
) -> None:  # fmt: skip
    """After a substep, deepen the overlaps that last, and close the contacts that ended."""
    for i in range(world.agents):
        a = agents[i]
        if not a.open:
            continue
        a.open = False
        for slot in range(opened.shape[1]):
            event = opened[i, slot]
            if event.code < 0:
                continue
            gap = _gap(a, event.code, world, agents, bodies, shapes, capsules, start, item)
            if gap > RELEASE or not a.present:
                _close(i, time, world, event, closed)
            else:
                event.penetration = max(event.penetration, -gap)
                a.open = True


@kernel_without_allocation
def _gap(
    a: Any, code: int, world: Any, agents: AnyArray, bodies: AnyArray, shapes: AnyArray,
    capsules: AnyArray, start: IntArray, item: IntArray,
) -> float:  # fmt: skip
    """Return the gap [m] of agent a to a recorded partner; negative: overlap; inf: gone or far."""
    k = code // 4
    if code % 4 == AGENT:
        return from_agent(a, agents[k])[2] if agents[k].present else math.inf
    if code % 4 == BODY:
        return body_gap(a, bodies[k], shapes)
    gap = math.inf
    cell = cell_at(world, a.x, a.y)
    for at in range(start[cell], start[cell + 1]):
        if capsules[item[at]].solid == k:
            gap = min(gap, from_fixed(a, capsules[item[at]])[2])
    return gap
