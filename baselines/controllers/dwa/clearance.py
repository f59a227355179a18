"""How far along its circular arc a disc gets before it touches something."""

import math

from benchnav.arrays import FloatArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.kernels import kernel

CREEP = 0.01  # [m] least advance: an arc that grazes something ends within a margin, not in it
MOST = 80  # advances; a way that takes more of them counts as ending there
TICK = 0.1  # [s] between the positions in which moving neighbours are met


@kernel
def along_arc(
    x: float, y: float, heading: float, v: float, w: float, s: float
) -> tuple[float, float]:
    """Where a body is that drove s [m] at the twist (v > 0, w)."""
    turn = s * w / v
    half = 0.5 * turn
    chord = s if abs(half) < 1e-9 else s * math.sin(half) / half
    return x + chord * math.cos(heading + half), y + chord * math.sin(heading + half)


@kernel
def room(
    x: float, y: float, start: FloatArray, end: FloatArray, edges: int,
    position: FloatArray, radius: FloatArray, count: int, most: float,
) -> float:  # fmt: skip
    """Distance [m] from a point to the nearest edge or disc, at most ``most``; < 0 in a disc.

    Args:
        x: of the point [m].
        y: of the point [m].
        start: (E, 2) [m].
        end: (E, 2) [m].
        edges: how many count.
        position: (K, 2) of discs [m].
        radius: (K,) [m].
        count: how many count.
        most: [m].
    """
    least2 = most * most
    for k in range(edges):
        px, py = nearest_on_segment(x, y, start[k, 0], start[k, 1], end[k, 0], end[k, 1])
        px -= x
        py -= y
        least2 = min(least2, px * px + py * py)
    least = math.sqrt(least2)
    for k in range(count):
        px, py = position[k, 0] - x, position[k, 1] - y
        far = least + radius[k]
        if far > 0.0 and px * px + py * py < far * far:
            least = math.sqrt(px * px + py * py) - radius[k]
    return least


@kernel
def arc_clearance(
    x: float, y: float, heading: float, v: float, w: float, reach: float,
    start: FloatArray, end: FloatArray, edges: int,
    position: FloatArray, radius: FloatArray, count: int, most: float,
) -> float:  # fmt: skip
    """Length [m] of the arc of (v, w) that a disc of radius ``reach`` drives freely, ≤ ``most``.

    By conservative advancement: an arc is no shorter than its chord, so what is d away is
    not met on the next d of it. The answer errs by `CREEP` at most, and else on the safe side.
    """
    if v <= 0.0:
        return most
    s = 0.0
    for _ in range(MOST):
        px, py = along_arc(x, y, heading, v, w, s)
        gap = room(px, py, start, end, edges, position, radius, count, reach + most) - reach
        if gap <= 0.0:
            return s
        s += max(gap, CREEP)
        if s >= most:
            return most
    return s


@kernel
def meeting_time(
    x: float, y: float, heading: float, v: float, w: float, reach: float,
    position: FloatArray, velocity: FloatArray, radius: FloatArray, count: int, horizon: float,
    hold: float,
) -> float:  # fmt: skip
    """When [s] a disc on the arc of (v, w) first meets neighbours that keep their velocities.

    It keeps its course once it has turned for ``hold`` [s]. Tested every `TICK`; ``horizon``
    where it meets none before. Those that overlap it already count only if they come nearer.
    """
    for k in range(1, math.ceil(horizon / TICK - 1e-9) + 1):
        t = k * TICK
        px, py = x, y
        if v > 0.0:
            px, py = along_arc(x, y, heading, v, w, v * min(t, hold))
            if t > hold:
                px += v * (t - hold) * math.cos(heading + w * hold)
                py += v * (t - hold) * math.sin(heading + w * hold)
        for j in range(count):
            dx = position[j, 0] + t * velocity[j, 0] - px
            dy = position[j, 1] + t * velocity[j, 1] - py
            apart = reach + radius[j]
            if dx * dx + dy * dy < apart * apart:
                gx, gy = position[j, 0] - x, position[j, 1] - y
                if gx * gx + gy * gy >= apart * apart or dx * dx + dy * dy < gx * gx + gy * gy:
                    return (k - 1) * TICK
    return horizon
