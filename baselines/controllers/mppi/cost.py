"""What a sequence of twists would cost: way that is left, contacts, probable contacts, jerks.

Costs are in metres, as the way that is left. What stands is predicted to stand, and
neighbours to keep their velocities; a dynamic obstacle may also turn back at once. The
probability of colliding is Eq. 24 of the paper on leaders that benchnav reproduces, see
`benchnav.envs.collision_probability`.
"""

import math

from benchnav.arena.solid import Kind
from benchnav.arrays import ByteArray, FloatArray
from benchnav.envs.collision_probability import probability
from benchnav.geometry.capsule import nearest_on_segment
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
    """(cost [m], touches) of a plan.

    Way is the mean over the plan of the distance to the target. A target that is not the
    end of the path, once passed, is left in any direction: where the path then turns is
    not known. After a contact the way left stays what it was.

    Args:
        plan: (H, 2) twists [m/s, rad/s].
        tick: [s] that each is held.
        x: [m].
        y: [m].
        heading: [rad].
        last: (2,) the twist before the plan.
        goal_x: target [m].
        goal_y: target [m].
        final: the path ends in the target.
        body: (6,) see `baselines.sensed.BODY`.
        margin: [m] within which a contact is counted; half of it beside what stands.
        position: (K, 2) of neighbours [m].
        velocity: (K, 2) [m/s].
        radius: (K,) [m].
        kind: (K,).
        count: neighbours that count.
        start: (E, 2) of edges [m].
        end: (E, 2) [m].
        far: (E,) [m] of each from (x, y).
        edges: edges that count.
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
        moved += v * tick
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
    """Gap [m] to the nearest neighbour, highest probability of colliding with a mover, and the
    gap to the nearest mover if they had turned back at once.
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
    """|d| − reach where that is less than ``gap``."""
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
    """Distance [m] to the nearest edge where that is less than ``within``.

    An edge that was ``far`` away is no nearer than that less what was ``moved`` since.
    """
    least = within * within
    for k in range(edges):
        if far[k] - moved < within:
            px, py = nearest_on_segment(x, y, start[k, 0], start[k, 1], end[k, 0], end[k, 1])
            px -= x
            py -= y
            least = min(least, px * px + py * py)
    return math.sqrt(least)
