"""Rays: the first object that each ray hits, and the goal on a separate layer.

A thick ray is a cast of the agent's own disc: it stops where the body would stop. Of a body that
is not a disc, it is a circle within or around its footprint; it hits the footprints of others. All
objects in reach are listed once per agent, in the agent's frame; then every ray is
tested against the list. Capsules of a large map are found by walking its grid.
"""

import math
from typing import Any

import numpy as np

from benchnav.arena.sensing import RayCircle
from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry.capsule import capsule_time, disc_time
from benchnav.geometry.hash_grid import bucket
from benchnav.geometry.rotation import cos_sin
from benchnav.kernels import inlined, kernel, kernel_without_allocation
from benchnav.sensors import sight
from benchnav.world.fixed import walk
from benchnav.world.touch import BRUTE_FORCE

BEHIND = 1e-3  # [m] farther than this behind the agent, an object cannot be hit by rays ahead
_AGENT, _NOTHING, _DYNAMIC = int(Kind.AGENT), int(Kind.NOTHING), int(Kind.DYNAMIC)
_POINT, _CIRCUMSCRIBED = int(RayCircle.POINT), int(RayCircle.CIRCUMSCRIBED)

# columns of the list: ends; unit normal and distance of the line (edges); sum of radii; kind;
# velocity. Frame: the agent at the origin, looking along +x.
X0, Y0, X1, Y1, NX, NY, OFF, REACH, KIND, VX, VY = range(11)


@kernel
def cast_rays(
    low: int, high: int, chosen: IntArray, fan_x: FloatArray, fan_y: FloatArray,
    limit: float, circle: int, side: float, widest: float, most_shapes: int,
    sees: BoolArray, worlds: AnyArray, agents: AnyArray, bodies: AnyArray,
    shapes: AnyArray, capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray,
    spots: AnyArray, distance: FloatArray, kind: ByteArray, approach: FloatArray,
    across: FloatArray, goal: FloatArray, radius: FloatArray,
) -> None:  # fmt: skip
    """Cast rays for rows low:high of the flattened (B, chosen agents); outputs are (B, An, R).

    ``fan_x``, ``fan_y``: unit vectors in the agent's frame, padded by repetition to a
    multiple of 8; ``circle``: the `RayCircle` that is cast; ``side`` [m] of the hashed cells;
    ``widest`` radius of an agent; ``most_shapes``: capsules of the bodies of one world;
    ``sees`` (B, teams, teams).
    """
    things = np.empty((sight.FEW + 2 * agents.shape[1] + most_shapes, 11))  # room for everything
    best, hit = np.empty(len(fan_x)), np.empty(len(fan_x), np.int64)
    _cast_in_rows(
        low, high, chosen, fan_x, fan_y, limit, circle, side, widest, most_shapes, sees, worlds,
        agents, bodies, shapes, capsules, start, item, hashed, spots, distance, kind, approach,
        across, goal, radius, things, best, hit, np.empty(sight.TABLE),
    )  # fmt: skip


@kernel_without_allocation
def _cast_in_rows(
    low: int, high: int, chosen: IntArray, fan_x: FloatArray, fan_y: FloatArray,
    limit: float, circle: int, side: float, widest: float, most_shapes: int,
    sees: BoolArray, worlds: AnyArray, agents: AnyArray, bodies: AnyArray,
    shapes: AnyArray, capsules: AnyArray, start: IntArray, item: IntArray, hashed: IntArray,
    spots: AnyArray, distance: FloatArray, kind: ByteArray, approach: FloatArray,
    across: FloatArray, goal: FloatArray, radius: FloatArray, things: FloatArray, best: FloatArray,
    hit: IntArray, fixed: FloatArray,
) -> None:  # fmt: skip
    width = chosen.shape[1]
    rays = distance.shape[2]
    rear = -BEHIND if min(fan_x) >= -1e-9 else -math.inf
    for b in range(low // width, (high + width - 1) // width):
        world, here, others = worlds[b], agents[b], bodies[b]
        seen, table, crowd = sees[b], hashed[b], spots[b]
        size, _ = sight.copy_fixed(world, capsules, fixed)
        few = size >= 0
        for k in range(max(low - b * width, 0), min(high - b * width, width)):
            i = chosen[b, k]
            if i < 0 or not here[i].present:
                continue
            a = here[i]
            own = radius[b, k] = ray_radius(a, circle)
            ca, sa = cos_sin(a.heading)
            n = _list_bodies(a, ca, sa, own, limit, rear, world.bodies, others, shapes, things, 0)
            n = _list_agents(
                i, ca, sa, own, limit, rear, side, widest, seen, here, table, crowd, things, n
            )
            if few:
                _mark_reachable(a.x, a.y, ca, sa, own, limit, rear, size, fixed)
                n = _list_marked(a, ca, sa, own, world, capsules, fixed, things, n)
            gx, gy = a.x - a.goal_x, a.y - a.goal_y
            gx, gy = ca * gx + sa * gy, ca * gy - sa * gx
            best[:] = limit
            hit[:] = -1
            _cast(n, things, fan_x, fan_y, best, hit)
            for r in range(rays):
                dx, dy, reach = fan_x[r], fan_y[r], best[r]
                hit_kind = _NOTHING if hit[r] < 0 else int(things[hit[r], KIND])
                if not few:
                    wx, wy = ca * dx - sa * dy, sa * dx + ca * dy
                    reach, on_map = _first_on_map(
                        a.x, a.y, wx, wy, own, reach, world, capsules, start, item
                    )
                    hit_kind = hit_kind if on_map == _NOTHING else on_map
                distance[b, k, r], kind[b, k, r] = reach, hit_kind
                approach[b, k, r] = across[b, k, r] = 0.0
                if hit_kind == _DYNAMIC:
                    vx, vy = things[hit[r], VX], things[hit[r], VY]
                    approach[b, k, r], across[b, k, r] = -(vx * dx + vy * dy), vy * dx - vx * dy
                goal[b, k, r] = goal_distance(gx, gy, dx, dy, world.tolerance + own, reach)


@kernel_without_allocation
def ray_radius(a: Any, circle: int) -> float:
    """Return the radius [m] of the disc that is cast along the rays of agent a (`RayCircle`)."""
    if circle == _POINT:
        return 0.0
    return float(a.radius if circle == _CIRCUMSCRIBED else a.inner_radius)


@kernel_without_allocation
def goal_distance(fx: float, fy: float, dx: float, dy: float, reach: float, best: float) -> float:
    """Return the way along a ray to the goal's disc; inf if missed, or farther than ``best`` [m].

    (fx, fy) is the place of the agent relative to its goal, in the frame of the ray.
    """
    t = 0.0 if fx * fx + fy * fy <= reach * reach else disc_time(fx, fy, dx, dy, reach)
    return t if t <= best else math.inf


@inlined
def _list(
    a: Any, ca: float, sa: float, own: float, rear: float, c: Any, x0: float, y0: float,
    vx: float, vy: float, things: FloatArray, n: int,
) -> int:  # fmt: skip
    """Append capsule c, which begins at (x0, y0) relative to the agent, if it is not too far back.

    ``rear`` [m] is the least coordinate ahead of the agent that a ray can hit.
    """
    x1, y1 = x0 + (c.x1 - c.x0), y0 + (c.y1 - c.y0)
    ahead_0, ahead_1 = ca * x0 + sa * y0, ca * x1 + sa * y1
    if max(ahead_0, ahead_1) + own + c.r < rear:
        return n
    row = things[n]
    row[X0], row[Y0] = ahead_0, ca * y0 - sa * x0
    row[X1], row[Y1] = ahead_1, ca * y1 - sa * x1
    row[NX], row[NY] = ca * c.nx + sa * c.ny, ca * c.ny - sa * c.nx
    row[OFF] = -1.0 if c.nx == 0.0 and c.ny == 0.0 else -(c.nx * x0 + c.ny * y0)
    row[REACH], row[KIND] = own + c.r, c.kind
    row[VX], row[VY] = ca * vx + sa * vy, ca * vy - sa * vx
    return n + 1


@kernel_without_allocation
def _is_reachable(c: Any, x0: float, y0: float, far: float) -> bool:
    """Whether a ray of length ``far`` [m] can hit capsule c, which begins at (x0, y0), first.

    An edge with its solid on the agent's side cannot be hit before another edge of
    that solid: its loop is closed and the agent is outside.
    """
    if c.nx * x0 + c.ny * y0 > 0.0:
        return False
    x1, y1 = x0 + (c.x1 - c.x0), y0 + (c.y1 - c.y0)
    if min(x0, x1) > far + c.r or max(x0, x1) < -far - c.r:
        return False
    return not (min(y0, y1) > far + c.r or max(y0, y1) < -far - c.r)


@kernel_without_allocation
def _mark_reachable(
    px: float, py: float, ca: float, sa: float, own: float, limit: float, rear: float, size: int,
    table: FloatArray,
) -> None:  # fmt: skip
    """Mark the fixed capsules that an agent at p can reach and that are not too far back.

    The tests are those of `_is_reachable` and `_list`, and vary in no bit.
    """
    for k in range(size):
        x0, y0 = table[sight.X0 + k] - px, table[sight.Y0 + k] - py
        x1, y1 = x0 + table[sight.DX + k], y0 + table[sight.DY + k]
        r = table[sight.R + k]
        far = limit + own + r
        low_x, high_x = (x0, x1) if x0 < x1 else (x1, x0)
        low_y, high_y = (y0, y1) if y0 < y1 else (y1, y0)
        beside = (low_x > far) | (high_x < -far) | (low_y > far) | (high_y < -far)
        turned_away = table[sight.NX + k] * x0 + table[sight.NY + k] * y0 > 0.0
        ahead_0, ahead_1 = ca * x0 + sa * y0, ca * x1 + sa * y1
        ahead = ahead_0 if ahead_0 > ahead_1 else ahead_1
        table[sight.FREE + k] = 0.0 if beside | turned_away | (ahead + own + r < rear) else 1.0


@inlined
def _list_marked(
    a: Any, ca: float, sa: float, own: float, world: Any, capsules: AnyArray, table: FloatArray,
    things: FloatArray, n: int,
) -> int:  # fmt: skip
    for k in range(world.last - world.first):
        if table[sight.FREE + k] > 0.0:
            c = capsules[world.first + k]
            n = _list(a, ca, sa, own, -math.inf, c, c.x0 - a.x, c.y0 - a.y, 0.0, 0.0, things, n)
    return n


@inlined
def _list_bodies(
    a: Any, ca: float, sa: float, own: float, limit: float, rear: float, count: int,
    bodies: AnyArray, shapes: AnyArray, things: FloatArray, n: int,
) -> int:  # fmt: skip
    for m in range(count):
        body = bodies[m]
        dx, dy, far = body.x - a.x, body.y - a.y, limit + own + body.bound
        if dx * dx + dy * dy <= far * far:
            for q in range(body.first, body.last):
                c = shapes[q]
                x0, y0 = c.x0 + dx, c.y0 + dy
                if _is_reachable(c, x0, y0, limit + own):
                    n = _list(a, ca, sa, own, rear, c, x0, y0, body.vx, body.vy, things, n)
    return n


@kernel_without_allocation
def _list_agents(
    i: int, ca: float, sa: float, own: float, limit: float, rear: float, side: float,
    widest: float, sees: BoolArray, agents: AnyArray, hashed: IntArray, spots: AnyArray,
    things: FloatArray, n: int,
) -> int:  # fmt: skip
    a = agents[i]
    if len(agents) <= BRUTE_FORCE:
        for j in range(len(agents)):
            if j != i:
                n = _list_agent(a, ca, sa, own, limit, rear, sees, agents[j], things, n)
        return n
    size = len(hashed) - 1
    for ring in range(math.ceil((limit + own + widest) / side) + 1):
        for ci in range(a.ci - ring, a.ci + ring + 1):
            rim = ci == a.ci - ring or ci == a.ci + ring
            for cj in range(a.cj - ring, a.cj + ring + 1, 1 if rim or ring == 0 else 2 * ring):
                k = bucket(ci, cj, size)
                for at in range(hashed[k], hashed[k + 1]):
                    j = spots[at].index
                    other = agents[j]
                    if spots[at].ci == ci and spots[at].cj == cj and j != i:
                        n = _list_agent(a, ca, sa, own, limit, rear, sees, other, things, n)
    return n


@kernel_without_allocation
def _list_agent(
    a: Any, ca: float, sa: float, own: float, limit: float, rear: float, sees: BoolArray,
    other: Any, things: FloatArray, n: int,
) -> int:  # fmt: skip
    x, y, reach = other.x - a.x, other.y - a.y, own + other.radius
    if not other.present or not sees[a.team, other.team]:
        return n
    if x * x + y * y > (limit + reach) * (limit + reach):
        return n
    ahead = ca * x + sa * y
    if ahead + reach < rear:
        return n
    if other.shaped:
        return _list_shape(x, y, ca, sa, own, other, things, n)
    row = things[n]
    row[X0], row[Y0] = ahead, ca * y - sa * x
    row[X1], row[Y1] = row[X0], row[Y0]
    row[OFF], row[REACH], row[KIND] = -1.0, reach, _AGENT
    return n + 1


@kernel_without_allocation
def _list_shape(
    x: float, y: float, ca: float, sa: float, own: float, other: Any, things: FloatArray, n: int
) -> int:
    """List the edges of another agent's core, at (x, y) from the agent, that face the agent.

    There are at most two. A core that is a segment is one edge.
    """
    c, s = cos_sin(other.heading)
    ux, uy = ca * c + sa * s, ca * s - sa * c  # the other's axis in the agent's frame
    px, py = ca * x + sa * y, ca * y - sa * x
    for k in range(2):
        # the edge along the axis, or across it, lies ``away`` in the direction (nx, ny)
        nx, ny = (-uy, ux) if k == 0 else (ux, uy)
        half, away = other.core_length, other.core_width
        if k == 1:
            half, away = away, half
        if half == 0.0:
            continue
        if nx * px + ny * py > 0.0:
            nx, ny = -nx, -ny
        off = -(nx * (px + away * nx) + ny * (py + away * ny))
        if off < 0.0:
            continue
        mx, my = px + away * nx, py + away * ny
        row = things[n]
        row[X0], row[Y0] = mx + half * ny, my - half * nx
        row[X1], row[Y1] = mx - half * ny, my + half * nx
        row[NX], row[NY], row[OFF] = nx, ny, off
        row[REACH], row[KIND] = own + other.rounding, _AGENT
        n += 1
    return n


@inlined
def _cast(
    n: int, things: FloatArray, fan_x: FloatArray, fan_y: FloatArray, best: FloatArray,
    hit: IntArray,
) -> None:  # fmt: skip
    """Lower ``best`` (R,) to the distance of the nearest of n objects; store its index in ``hit``.

    A ray hits an edge on its line, or else at the end where it passes the line. The code has
    no branches and runs over all rays: the compiler turns the inner loop into vector operations.
    """
    for k in range(n):
        x0, y0, x1, y1 = things[k, X0], things[k, Y0], things[k, X1], things[k, Y1]
        nx, ny, off, reach = things[k, NX], things[k, NY], things[k, OFF], things[k, REACH]
        span = (y1 - y0) * nx - (x1 - x0) * ny  # along the tangent (-ny, nx)
        span = span if off >= 0.0 else -1.0  # a disc has no line
        gap = max(off - reach, 0.0)
        for r in range(len(best)):
            dx, dy = fan_x[r], fan_y[r]
            slope = nx * dx + ny * dy
            t = gap / -slope if gap > 0.0 else 0.0
            foot = (t * dy - y0) * nx - (t * dx - x0) * ny
            x, y = (x1, y1) if foot > span else (x0, y0)
            along = x * dx + y * dy
            outside = x * x + y * y - reach * reach
            inner = along * along - outside  # reach² - across²
            at_end = along - math.sqrt(max(inner, 0.0)) if outside > 0.0 else 0.0
            at_end = at_end if along > 0.0 and inner >= 0.0 else math.inf
            on_line = t if slope < 0.0 else math.inf
            t = on_line if foot >= 0.0 and foot <= span else at_end
            t = math.inf if gap > 0.0 and slope >= 0.0 else t
            nearer = t < best[r]
            best[r] = t if nearer else best[r]
            hit[r] = k if nearer else hit[r]


@kernel_without_allocation
def _first_on_map(
    x: float, y: float, dx: float, dy: float, own: float, limit: float, world: Any,
    capsules: AnyArray, start: IntArray, item: IntArray,
) -> tuple[float, int]:  # fmt: skip
    """Return (distance, kind) of the first fixed capsule within ``limit``, or (limit, NOTHING).

    World frame; (dx, dy) is a unit vector.
    """
    best, kind = limit, _NOTHING
    i, j, step_i, step_j, next_i, next_j, each_i, each_j = walk(world, x, y, dx, dy)
    entered = 0.0
    while entered <= best:
        if 0 <= i < world.nx and 0 <= j < world.ny:
            cell = world.grid + i * world.ny + j
            for at in range(start[cell], start[cell + 1]):
                c = capsules[item[at]]
                reach = own + c.r
                ax, ay, bx, by = c.x0 - x, c.y0 - y, c.x1 - x, c.y1 - y
                across_a, across_b = dx * ay - dy * ax, dx * by - dy * bx
                if min(across_a, across_b) > reach or max(across_a, across_b) < -reach:
                    continue
                t = capsule_time(x, y, dx, dy, reach, best, c.x0, c.y0, c.x1, c.y1)
                if t < best:
                    best, kind = t, c.kind
        if next_i < next_j:
            entered, next_i, i = next_i, next_i + each_i, i + step_i
        else:
            entered, next_j, j = next_j, next_j + each_j, j + step_j
    return best, kind
