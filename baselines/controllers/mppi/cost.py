"""The cost of a sequence of twists: remaining distance, contacts, their probability, jerks.

Costs are in metres, like the remaining distance. Static obstacles are predicted to stay, and
neighbours to keep their velocities; a dynamic obstacle may also turn back at once. The
collision probability is Eq. 24 of the paper on leaders that benchnav reproduces, see
`benchnav.envs.collision_probability`.
"""

import math

from benchnav.arena import Kind
from benchnav.arrays import ByteArray, FloatArray
from benchnav.envs.collision_probability import probability
from benchnav.geometry import nearest_on_segment
from benchnav.kernels import kernel

WEIGHTS = 7  # contact, probability, near, smooth, clearance [m], back, near_edges: see `MppiConfig`
_MOVER = int(Kind.DYNAMIC)


@kernel
def cost_of(
    plan: FloatArray, tick: float, x: float, y: float, heading: float, last: FloatArray,
    goal_x: float, goal_y: float, final: bool, body: FloatArray, margin: float,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray, count: int,
    start: FloatArray, end: FloatArray, far: FloatArray, edges: int, weights: FloatArray,
) -> tuple[float, bool]:  # fmt: skip
    """Return (cost [m], touches) of a plan.

    The remaining distance is the mean over the plan of the distance to the target. A target that is
    not the end of the path is, once passed, left in any direction: the direction of the next
    part of the path is unknown. After a contact, the remaining distance stays constant.

    Args:
        plan: (H, 2) twists [m/s, rad/s].
        tick: [s] duration of each twist.
        x: [m].
        y: [m].
        heading: [rad].
        last: (2,) the twist before the plan.
        goal_x: target [m].
        goal_y: target [m].
        final: the path ends in the target.
        body: (6,) see `baselines.common.kernel_inputs.BODY`.
        margin: [m] within which a contact is counted; half of it for static obstacles.
        position: (K, 2) of neighbours [m].
        velocity: (K, 2) [m/s].
        radius: (K,) [m].
        kind: (K,).
        count: number of valid neighbours.
        start: (E, 2) of edges [m].
        end: (E, 2) [m].
        far: (E,) [m] of each from (x, y).
        edges: number of valid edges.
        weights: (7,) see `WEIGHTS`.
    """
    steps = len(plan)
    left = math.sqrt((goal_x - x) ** 2 + (goal_y - y) ** 2)
    total, passed, turned, moved = 0.0, False, False, 0.0
    within = body[0] + max(weights[4], margin)
    v0, w0 = last[0], last[1]
    ahead_x, ahead_y = (goal_x - x, goal_y - y)
    for t in range(steps):
        v, w = plan[t, 0], plan[t, 1]
        jerk_v, jerk_w = (v - v0) / body[2], (w - w0) / body[3]
        total += weights[3] * (jerk_v * jerk_v + jerk_w * jerk_w)
        v0, w0 = v, w
        course = heading + 0.5 * w * tick
        c, s = math.cos(course), math.sin(course)
        x += v * tick * c
        y += v * tick * s
        heading += w * tick
        gap, risk, back = _others(
            x, y, v * c, v * s, (t + 1) * tick, body[0], position, velocity, radius, kind, count
        )
        if back < margin and not turned:
            turned = True
            total += weights[5] * (steps - t) / steps
        moved += abs(v) * tick
        wall = _edges(x, y, start, end, far, edges, within, moved) - body[0]
        if gap < margin or wall < 0.5 * margin:
            rest = steps - t
            return total + (rest * left + weights[0] * rest) / steps + weights[0], True
        total += weights[1] * risk / steps
        if gap < weights[4]:
            total += weights[2] * (1.0 - gap / weights[4]) / steps
        if wall < weights[4]:
            total += weights[6] * (1.0 - wall / weights[4]) / steps
        if passed:
            left -= v * tick
        else:
            gx, gy = goal_x - x, goal_y - y
            left = math.sqrt(gx * gx + gy * gy)
            if final:
                if left < body[5]:
                    return total, False
            else:
                passed = gx * ahead_x + gy * ahead_y <= 0.0 or left < body[0]
        total += left / steps
    return total, False


@kernel
def _others(
    x: float, y: float, vx: float, vy: float, time: float, size: float,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, kind: ByteArray, count: int,
) -> tuple[float, float, float]:  # fmt: skip
    """Return the gap [m] to the nearest neighbour, the highest collision probability with a mover,
    and the gap to the nearest mover if all movers had turned back at once.
    """
    gap, risk, back = 1e9, 0.0, 1e9
    for j in range(count):
        ux, uy = velocity[j, 0], velocity[j, 1]
        hx, hy = position[j, 0] - x, position[j, 1] - y
        dx, dy = hx + time * ux, hy + time * uy
        reach = size + radius[j]
        gap = _nearer(dx, dy, reach, gap)
        if kind[j] == _MOVER:
            back = _nearer(hx - time * ux, hy - time * uy, reach, back)
            if risk < 1.0:
                risk = max(risk, probability(dx, dy, vx - ux, vy - uy, reach))
    return gap, risk, back


@kernel
def _nearer(dx: float, dy: float, reach: float, gap: float) -> float:
    """Return |d| − reach if it is less than ``gap``, else ``gap``."""
    far, d2 = gap + reach, dx * dx + dy * dy
    return math.sqrt(d2) - reach if d2 < far * far else gap


@kernel
def edge_distances(
    x: float, y: float, start: FloatArray, end: FloatArray, edges: int, out: FloatArray
) -> None:
    """Fill ``out`` (E,) with the distance [m] of each edge from (x, y)."""
    for k in range(edges):
        px, py = nearest_on_segment(x, y, start[k, 0], start[k, 1], end[k, 0], end[k, 1])
        out[k] = math.sqrt((px - x) ** 2 + (py - y) ** 2)


@kernel
def _edges(
    x: float, y: float, start: FloatArray, end: FloatArray, far: FloatArray, edges: int,
    within: float, moved: float,
) -> float:  # fmt: skip
    """Return the distance [m] to the nearest edge if it is less than ``within``.

    An edge that was ``far`` away is no nearer than ``far`` minus the distance ``moved`` since.
    """
    least = within * within
    for k in range(edges):
        if far[k] - moved < within:
            px, py = nearest_on_segment(x, y, start[k, 0], start[k, 1], end[k, 0], end[k, 1])
            px -= x
            py -= y
            least = min(least, px * px + py * py)
    return math.sqrt(least)
