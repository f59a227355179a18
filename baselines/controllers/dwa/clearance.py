"""The free length of a disc's circular arc."""

import math

from benchnav.arrays import FloatArray
from benchnav.geometry import nearest_on_segment
from benchnav.kernels import kernel

CREEP = 0.01  # [m] smallest advance: an arc that grazes an obstacle ends within a margin
MAX_ADVANCES = 80  # an arc that takes more counts as ending there
TICK = 0.1  # [s] between the tested positions of moving neighbours


@kernel
def along_arc(
    x: float, y: float, heading: float, v: float, w: float, s: float
) -> tuple[float, float]:
    """Return the position of a body that drove s [m] at the twist (v > 0, w)."""
    turn = s * w / v
    half = 0.5 * turn
    chord = s if abs(half) < 1e-9 else s * math.sin(half) / half
    return x + chord * math.cos(heading + half), y + chord * math.sin(heading + half)


@kernel
def room(
    x: float, y: float, start: FloatArray, end: FloatArray, edges: int,
    position: FloatArray, radius: FloatArray, count: int, most: float,
) -> float:  # fmt: skip
    """Return the distance [m] to the nearest edge or disc, at most ``most``; < 0 in a disc.

    Args:
        x: of the point [m].
        y: of the point [m].
        start: (E, 2) [m].
        end: (E, 2) [m].
        edges: number of valid edges.
        position: (K, 2) of discs [m].
        radius: (K,) [m].
        count: number of valid discs.
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
    """Return the free length [m] of the arc of (v, w) for a disc of radius ``reach``, ≤ ``most``.

    By conservative advancement: an arc is no shorter than its chord, so an obstacle at distance d
    is not hit on the next d of it. The error is at most `CREEP`, otherwise on the safe side.
    """
    if v <= 0.0:
        return most
    s = 0.0
    for _ in range(MAX_ADVANCES):
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
    """Return when [s] a disc on the arc of (v, w) first meets neighbours of constant velocity.

    It goes straight after it has turned for ``hold`` [s]. Tested every `TICK`; ``horizon``
    if it meets none before. Neighbours that overlap it already count only if they approach.
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
