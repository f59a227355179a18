"""Errors of rays: range noise, dropout, approach speed and field of view."""

import math

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, ByteArray, FloatArray, IntArray
from benchnav.geometry.rotation import cos_sin, wrap
from benchnav.kernels import kernel_without_allocation
from benchnav.sensors.noise.draws import RAY, draw, two_normals, uniform
from benchnav.sensors.noise.odometry import HEADING, X, Y
from benchnav.sensors.rays import goal_distance, ray_radius

_NOTHING, _DYNAMIC = int(Kind.NOTHING), int(Kind.DYNAMIC)


@kernel_without_allocation
def disturb_rays(
    low: int, high: int, chosen: IntArray, angle: FloatArray, fan_x: FloatArray, fan_y: FloatArray,
    limit: float, circle: int, noise: float, relative: float, quadratic: float, dropout: float,
    approach_noise: float, view: float, worlds: AnyArray, agents: AnyArray, keys: AnyArray,
    error: FloatArray, distance: FloatArray, kind: ByteArray, approach: FloatArray,
    across: FloatArray, goal: FloatArray,
) -> None:  # fmt: skip
    """Add noise to the readings of rows low:high of the flattened (B, chosen agents).

    The goal layer is computed again: the agent looks for the goal where it believes it to be, and
    the noisy distances decide what hides it. The other arguments are those of `cast_rays`, and the
    numbers of `RayNoise`.
    """
    width = chosen.shape[1]
    for row in range(low, high):
        b, k = row // width, row % width
        i = chosen[b, k]
        if i < 0 or not agents[b, i].present:
            continue
        a, e, step = agents[b, i], error[b, k], worlds[b].steps_done
        own = ray_radius(a, circle)
        ca, sa = cos_sin(a.heading if e[HEADING] == 0.0 else wrap(a.heading + e[HEADING]))
        gx, gy = a.x + e[X] - a.goal_x, a.y + e[Y] - a.goal_y
        gx, gy = ca * gx + sa * gy, ca * gy - sa * gx
        for r in range(len(angle)):
            d = distance[b, k, r]
            if kind[b, k, r] != _NOTHING:
                first, second = draw(keys[b, 0], keys[b, 1], step, i, RAY, r)
                shift, faster = two_normals(first)
                d = max(d + (noise + relative * d + quadratic * d * d) * shift, 0.0)
                if kind[b, k, r] == _DYNAMIC and approach_noise > 0.0:
                    approach[b, k, r] += approach_noise * faster
                    sideways, _ = draw(keys[b, 0], keys[b, 1], step, i, RAY, len(angle) + r)
                    across[b, k, r] += approach_noise * two_normals(sideways)[0]
                outside = abs(angle[r]) > 0.5 * view
                if outside or d >= limit or uniform(second) < dropout:
                    d, kind[b, k, r] = limit, _NOTHING
                    approach[b, k, r] = across[b, k, r] = 0.0
                distance[b, k, r] = d
            goal[b, k, r] = goal_distance(gx, gy, fan_x[r], fan_y[r], worlds[b].tolerance + own, d)


@kernel_without_allocation
def in_view(dx: float, dy: float, ca: float, sa: float, cos_half: float) -> bool:
    """Whether the direction (dx, dy) is within the half angle about the heading (ca, sa)."""
    return bool(ca * dx + sa * dy >= cos_half * math.sqrt(dx * dx + dy * dy))
