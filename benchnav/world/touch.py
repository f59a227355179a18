"""The partner that a moving agent touches next, and the geometry of a touch.

Partner codes: 4k + 0 own goal, 4k + 1 agent k, 4k + 2 fixed capsule k (recorded as
its solid), 4k + 3 body k.
"""

import math
from typing import Any

from benchnav.arrays import AnyArray, IntArray
from benchnav.geometry.capsule import capsule_time, disc_time, nearest_on_segment
from benchnav.kernels import inlined, kernel_without_allocation
from benchnav.world.footprint import (
    agent_capsule_gap,
    agent_capsule_time,
    agents_gap,
    agents_time,
    depth_within,
)

GOAL, AGENT, FIXED, BODY = 0, 1, 2, 3
BRUTE_FORCE = 24  # up to this many agents, testing all pairs is cheaper than cells
WIDER = 1.000001  # factor of a distance, so that rounding never excludes a touch


@kernel_without_allocation
def goal_time(a: Any, tolerance: float, left: float) -> float:
    """Return the time until agent a touches its goal disc; 0 inside, inf if not within ``left``."""
    fx, fy = a.x - a.goal_x, a.y - a.goal_y
    f2 = fx * fx + fy * fy
    if f2 <= tolerance * tolerance:
        return 0.0
    far = tolerance + WIDER * (abs(a.vx) + abs(a.vy)) * left
    if f2 > WIDER * far * far:
        return math.inf
    return disc_time(fx, fy, a.vx, a.vy, tolerance)


@kernel_without_allocation
def pair_time(a: Any, b: Any) -> float:
    """Return the time until agents a and b touch at their current velocities."""
    return disc_time(a.x - b.x, a.y - b.y, a.vx - b.vx, a.vy - b.vy, a.radius + b.radius)


@kernel_without_allocation
def fixed_time(a: Any, c: Any, way: float) -> float:
    """Return the time until agent a touches a fixed capsule, within ``way`` [m]."""
    return capsule_time(a.x, a.y, a.vx, a.vy, a.radius + c.r, way, c.x0, c.y0, c.x1, c.y1)


@kernel_without_allocation
def body_time(a: Any, body: Any, shapes: AnyArray, left: float) -> float:
    """Return the time until agent a touches a body; inf if it cannot within ``left`` [s]."""
    fx, fy = a.x - body.x, a.y - body.y
    wx, wy = a.vx - body.vx, a.vy - body.vy
    way = (abs(wx) + abs(wy)) * left
    far = a.radius + body.bound + way
    if fx * fx + fy * fy > far * far:
        return math.inf
    best = math.inf
    for q in range(body.first, body.last):
        c = shapes[q]
        if a.shaped:
            t = agent_capsule_time(fx, fy, wx, wy, way, a, c)
        else:
            t = capsule_time(fx, fy, wx, wy, a.radius + c.r, way, c.x0, c.y0, c.x1, c.y1)
        best = min(best, t)
    return best


@inlined
def next_agent(i: int, left: float, agents: AnyArray) -> tuple[float, int]:
    """Return (time, index) of the agent that i touches first within ``left`` [s], or (inf, -1)."""
    a, best, partner = agents[i], math.inf, -1
    for j in range(len(agents)):
        if j != i and agents[j].present:
            b = agents[j]
            if a.shaped or b.shaped:
                t = agents_time(a.x - b.x, a.y - b.y, a.vx - b.vx, a.vy - b.vy, left, a, b)
            else:
                t = pair_time(a, b)
            if t <= left and t < best:
                best, partner = t, j
    return best, partner


@inlined
def find_next(
    i: int, meeting: float, partner: int, left: float, tolerance: float, agents: AnyArray,
    bodies: AnyArray, shapes: AnyArray, capsules: AnyArray, start: IntArray, item: IntArray,
    body_count: int,
) -> None:  # fmt: skip
    """Write tau and code of active agent i: its next touch within ``left`` [s].

    Of simultaneous touches the goal comes first, then fixed geometry, bodies, and
    agents, each by index: a fixed order, independent of the search. The next agent (partner,
    touched after ``meeting`` [s]) is an argument, because there are two ways to find it.
    """
    a = agents[i]
    best, code = math.inf, -1
    t = goal_time(a, tolerance, left)
    if t <= left:
        best, code = t, GOAL
    if a.vx != 0.0 or a.vy != 0.0:
        way = (abs(a.vx) + abs(a.vy)) * left
        for at in range(start[a.home], start[a.home + 1]):
            c = capsules[item[at]]
            if a.shaped:
                t = agent_capsule_time(a.x, a.y, a.vx, a.vy, way, a, c)
            else:
                t = fixed_time(a, c, way)
            if t < best and t <= left:
                best, code = t, 4 * item[at] + FIXED
    for m in range(body_count):
        t = body_time(a, bodies[m], shapes, left)
        if t < best and t <= left:
            best, code = t, 4 * m + BODY
    if meeting < best:
        best, code = meeting, 4 * partner + AGENT
    a.tau, a.code = best, code


@kernel_without_allocation
def from_fixed(a: Any, c: Any) -> tuple[float, float, float]:
    """Return (dx, dy, gap): away from the capsule, any length, and between the surfaces."""
    if a.shaped:
        return agent_capsule_gap(a.x, a.y, a, c)
    qx, qy = nearest_on_segment(a.x, a.y, c.x0, c.y0, c.x1, c.y1)
    dx, dy = a.x - qx, a.y - qy
    return dx, dy, math.sqrt(dx * dx + dy * dy) - c.r - a.radius


@kernel_without_allocation
def from_body(a: Any, body: Any, shapes: AnyArray) -> tuple[float, float, float]:
    """Like `from_fixed`, for the nearest of a body's capsules."""
    gap, dx, dy = math.inf, 0.0, 0.0
    fx, fy = a.x - body.x, a.y - body.y
    for q in range(body.first, body.last):
        c = shapes[q]
        if a.shaped:
            ex, ey, d = agent_capsule_gap(fx, fy, a, c)
        else:
            qx, qy = nearest_on_segment(fx, fy, c.x0, c.y0, c.x1, c.y1)
            ex, ey = fx - qx, fy - qy
            d = math.sqrt(ex * ex + ey * ey) - c.r - a.radius
        if d < gap:
            gap, dx, dy = d, ex, ey
    return dx, dy, gap


@kernel_without_allocation
def encloses(body: Any, shapes: AnyArray, x: float, y: float) -> bool:
    """Whether (x, y) is inside the loops of a body (even-odd rule); False for a disc."""
    inside = False
    fx, fy = x - body.x, y - body.y
    for q in range(body.first, body.last):
        c = shapes[q]
        if (c.y0 > fy) != (c.y1 > fy) and fx < c.x0 + (fy - c.y0) / (c.y1 - c.y0) * (c.x1 - c.x0):
            inside = not inside
    return inside


@kernel_without_allocation
def from_agent(a: Any, b: Any) -> tuple[float, float, float]:
    """Like `from_fixed`, for another agent."""
    if a.shaped or b.shaped:
        return agents_gap(a.x - b.x, a.y - b.y, a, b)
    dx, dy = a.x - b.x, a.y - b.y
    return dx, dy, math.sqrt(dx * dx + dy * dy) - a.radius - b.radius


@kernel_without_allocation
def body_gap(a: Any, body: Any, shapes: AnyArray) -> float:
    """Return the gap [m] of agent a and a body; minus the depth if its centre is within."""
    gap = from_body(a, body, shapes)[2]
    if not encloses(body, shapes, a.x, a.y):
        return gap
    if a.shaped:
        return -depth_within(a, body, shapes)
    return -gap - 2.0 * float(a.radius)
