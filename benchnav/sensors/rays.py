"""Rays: what each meets first, and the goal on a layer of its own.

A thick ray is a cast of the agent's own disc: it stops where the body would.
"""

import math
from typing import Any

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.episode.episode import Status
from benchnav.geometry.capsule import capsule_time, disc_time
from benchnav.geometry.hash_grid import bucket
from benchnav.geometry.rotation import cos_sin
from benchnav.kernels import kernel
from benchnav.sensors.sight import FEW
from benchnav.world.touch import BRUTE_FORCE

_AGENT, _NOTHING, _DYNAMIC = int(Kind.AGENT), int(Kind.NOTHING), int(Kind.DYNAMIC)
_ACTIVE = int(Status.ACTIVE)


@kernel
def cast_rays(
    low: int, high: int, chosen: IntArray, angle: FloatArray, limit: float, thick: bool,
    side: float, sees: BoolArray, worlds: AnyArray, agents: AnyArray, bodies: AnyArray,
    shapes: AnyArray, capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray,
    sorted_: IntArray, distance: FloatArray, kind: ByteArray, approach: FloatArray,
    goal: FloatArray,
) -> None:  # fmt: skip
    """Rows low:high of the flattened (B, chosen agents); outputs are (B, An, R).

    ``side`` [m] is that of the hashed cells; ``sees`` (B, teams, teams).
    """
    width = chosen.shape[1]
    front = np.empty((FEW, 6))  # relative to the agent: x0, y0, x1, y1, reach, kind
    for row in range(low, high):
        b, k = row // width, row % width
        if chosen[b, k] < 0 or not agents[b, chosen[b, k]].present:
            continue
        a = agents[b, chosen[b, k]]
        own = a.radius if thick else 0.0
        ca, sa = cos_sin(a.heading)
        seen = _facing(a, own, limit, worlds[b], capsules, front)
        for r in range(len(angle)):
            cr, sr = cos_sin(angle[r])
            dx, dy = ca * cr - sa * sr, sa * cr + ca * sr
            if seen >= 0:
                best, what = _first_facing(dx, dy, own, limit, seen, front)
            else:
                best, what = _first_fixed(
                    a.x, a.y, dx, dy, own, limit, worlds[b], capsules, start, item
                )
            best, m = _first_body(a.x, a.y, dx, dy, own, best, worlds[b].bodies, bodies[b], shapes)
            if m >= 0:
                what = bodies[b, m].kind
            met = _first_agent(
                chosen[b, k], dx, dy, own, best, limit, side, sees[b], agents[b], hashed[b],
                sorted_[b],
            )  # fmt: skip
            if met < best:
                best, what, m = met, _AGENT, -1
            distance[b, k, r] = best
            kind[b, k, r] = what
            approach[b, k, r] = 0.0
            if m >= 0 and what == _DYNAMIC:
                approach[b, k, r] = -(bodies[b, m].vx * dx + bodies[b, m].vy * dy)
            reach = worlds[b].tolerance + own
            goal[b, k, r] = _goal_distance(a, dx, dy, reach, best)


@kernel
def _goal_distance(a: Any, dx: float, dy: float, reach: float, best: float) -> float:
    fx, fy = a.x - a.goal_x, a.y - a.goal_y
    t = 0.0 if fx * fx + fy * fy <= reach * reach else disc_time(fx, fy, dx, dy, reach)
    return t if t <= best else math.inf


@kernel
def _facing(
    a: Any, own: float, limit: float, world: Any, capsules: AnyArray, front: FloatArray
) -> int:
    """Lists in ``front`` the few fixed capsules that any ray of agent a could meet; -1 if many.

    An edge whose solid is on the agent's side cannot be met before another edge of
    that solid: its loop is closed and the agent outside.
    """
    if world.last - world.first > FEW:
        return -1
    n = 0
    for p in range(world.first, world.last):
        c = capsules[p]
        x0, y0, x1, y1 = c.x0 - a.x, c.y0 - a.y, c.x1 - a.x, c.y1 - a.y
        reach = own + c.r
        if c.r == 0.0 and x0 * (y1 - y0) - y0 * (x1 - x0) > 0.0:
            continue
        if min(x0, x1) > limit + reach or max(x0, x1) < -limit - reach:
            continue
        if min(y0, y1) > limit + reach or max(y0, y1) < -limit - reach:
            continue
        row = front[n]
        row[0], row[1], row[2], row[3], row[4], row[5] = x0, y0, x1, y1, reach, c.kind
        n += 1
    return n


@kernel
def _first_facing(
    dx: float, dy: float, own: float, limit: float, seen: int, front: FloatArray
) -> tuple[float, int]:
    """As `_first_fixed`, over the first ``seen`` capsules of ``front``."""
    best, what = limit, float(_NOTHING)
    for p in range(seen):
        x0, y0, x1, y1, reach = front[p, 0], front[p, 1], front[p, 2], front[p, 3], front[p, 4]
        across_0, across_1 = dx * y0 - dy * x0, dx * y1 - dy * x1
        if min(across_0, across_1) > reach or max(across_0, across_1) < -reach:
            continue
        along_0, along_1 = dx * x0 + dy * y0, dx * x1 + dy * y1
        if max(along_0, along_1) < -reach or min(along_0, along_1) - reach > best:
            continue
        t = capsule_time(0.0, 0.0, dx, dy, reach, x0, y0, x1, y1)
        if t < best:
            best, what = t, front[p, 5]
    return best, int(what)


@kernel
def _capsule_distance(
    x: float, y: float, dx: float, dy: float, own: float, best: float, c: Any
) -> float:
    """Way along the ray to capsule c if shorter than ``best``, else inf; cheap rejections first."""
    reach = own + c.r
    ax, ay, bx, by = c.x0 - x, c.y0 - y, c.x1 - x, c.y1 - y
    across_a, across_b = dx * ay - dy * ax, dx * by - dy * bx
    if min(across_a, across_b) > reach or max(across_a, across_b) < -reach:
        return math.inf
    along_a, along_b = dx * ax + dy * ay, dx * bx + dy * by
    if max(along_a, along_b) < -reach or min(along_a, along_b) - reach > best:
        return math.inf
    return capsule_time(x, y, dx, dy, reach, c.x0, c.y0, c.x1, c.y1)


@kernel
def _first_fixed(
    x: float, y: float, dx: float, dy: float, own: float, limit: float, world: Any,
    capsules: AnyArray, start: IntArray, item: IntArray,
) -> tuple[float, int]:  # fmt: skip
    """(distance, kind) of the first fixed capsule within ``limit``; (limit, NOTHING) if none."""
    best, what = limit, _NOTHING
    side = world.side
    i = math.floor((x - world.origin_x) / side)
    j = math.floor((y - world.origin_y) / side)
    step_i, step_j = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
    # distance along the ray to the next column and row of cells (Amanatides & Woo 1987)
    next_i = ((i + (dx > 0.0)) * side + world.origin_x - x) / dx if dx != 0.0 else math.inf
    next_j = ((j + (dy > 0.0)) * side + world.origin_y - y) / dy if dy != 0.0 else math.inf
    each_i = side / abs(dx) if dx != 0.0 else math.inf
    each_j = side / abs(dy) if dy != 0.0 else math.inf
    entered = 0.0
    while entered <= best:
        if 0 <= i < world.nx and 0 <= j < world.ny:
            cell = world.grid + i * world.ny + j
            for at in range(start[cell], start[cell + 1]):
                c = capsules[item[at]]
                t = _capsule_distance(x, y, dx, dy, own, best, c)
                if t < best:
                    best, what = t, c.kind
        if next_i < next_j:
            entered, next_i, i = next_i, next_i + each_i, i + step_i
        else:
            entered, next_j, j = next_j, next_j + each_j, j + step_j
    return best, what


@kernel
def _first_body(
    x: float, y: float, dx: float, dy: float, own: float, best: float, count: int,
    bodies: AnyArray, shapes: AnyArray,
) -> tuple[float, int]:  # fmt: skip
    """(distance, index) of the first body nearer than ``best``; (best, -1) if none."""
    who = -1
    for m in range(count):
        body = bodies[m]
        fx, fy = x - body.x, y - body.y
        reach = own + body.bound
        along, across = -(fx * dx + fy * dy), dx * fy - dy * fx
        if abs(across) > reach or along < -reach or along - reach > best:
            continue
        for q in range(body.first, body.last):
            t = _capsule_distance(fx, fy, dx, dy, own, best, shapes[q])
            if t < best:
                best, who = t, m
    return best, who


@kernel
def _first_agent(
    i: int, dx: float, dy: float, own: float, best: float, limit: float, side: float,
    sees: BoolArray, agents: AnyArray, hashed: IntArray, sorted_: IntArray,
) -> float:  # fmt: skip
    """Distance to the first other agent nearer than ``best``; inf if none."""
    nearest = math.inf
    if len(agents) <= BRUTE_FORCE:
        for j in range(len(agents)):
            nearest = min(nearest, _agent_distance(i, j, dx, dy, own, best, sees, agents))
        return nearest
    a = agents[i]
    size = len(hashed) - 1
    rings = math.ceil(limit / side) + 1
    for ci in range(a.ci - rings, a.ci + rings + 1):
        for cj in range(a.cj - rings, a.cj + rings + 1):
            k = bucket(ci, cj, size)
            for at in range(hashed[k], hashed[k + 1]):
                j = sorted_[at]
                if agents[j].ci == ci and agents[j].cj == cj:
                    nearest = min(nearest, _agent_distance(i, j, dx, dy, own, best, sees, agents))
    return nearest


@kernel
def _agent_distance(
    i: int, j: int, dx: float, dy: float, own: float, best: float, sees: BoolArray,
    agents: AnyArray,
) -> float:  # fmt: skip
    a, b = agents[i], agents[j]
    if j == i or not b.present or not sees[a.team, b.team]:
        return math.inf
    fx, fy, reach = a.x - b.x, a.y - b.y, own + b.radius
    if abs(dx * fy - dy * fx) > reach or -(fx * dx + fy * dy) - reach > best:
        return math.inf
    t = disc_time(fx, fy, dx, dy, reach)
    return t if t < best else math.inf
