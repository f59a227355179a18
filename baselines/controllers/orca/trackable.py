"""The velocities that a body with limits tracks closely, as half-planes: NH-ORCA and B-ORCA.

A body that cannot take a velocity at once strays from the way that ORCA expects of it. Velocities
for which it strays by no more than ε are permitted, and its disc is enlarged by ε: Alonso-Mora,
Breitenmoser, Rufli, Beardsley and Siegwart 2013, "Optimal reciprocal collision avoidance for
multiple non-holonomic robots" (turning bodies); Alonso-Mora, Breitenmoser, Beardsley and Siegwart
2012, "Reciprocal collision avoidance for multiple car-like robots". The bounds for cars and for
accelerations are this project's. All half-planes hold the velocity 0, or speeds near the current
one if the body cannot stop at once.
"""

import math

from benchnav.arena import Dynamics
from benchnav.arrays import FloatArray
from benchnav.geometry import cos_sin, nearest_on_segment
from benchnav.kernels import kernel

from ...common.motion_limits import (
    BRAKE,
    KIND,
    SPEED_UP,
    STEER,
    STEER_RATE,
    STEP,
    TRACK,
    TURN,
    TURN_UP,
    WHEEL,
    curvature,
    top_speed,
)

MOST = 16  # half-planes of a body
SIDES = 4  # chords of the set of a turning body, on each side
_OCTANT = 0.25 * math.pi
_APOTHEM = math.cos(math.pi / 8.0)  # of an octagon in a circle of radius 1
_HOLONOMIC, _CAR = float(Dynamics.HOLONOMIC), float(Dynamics.ACKERMANN)
_WHEELS = float(Dynamics.DIFFERENTIAL_DRIVE)


@kernel
def trackable(
    limits: FloatArray, course: float, vx: float, vy: float, error: float, planes: FloatArray
) -> int:
    """Write the half-planes of velocities that a body tracks within ``error`` [m]; return how many.

    Args:
        limits: (13,) see `baselines.common.motion_limits`.
        course: [rad] of its front; of its rear if it should drive backwards.
        vx: velocity [m/s].
        vy: velocity [m/s].
        error: ε [m].
        planes: (16, 4) see `.half_plane`.
    """
    if limits[KIND] == _HOLONOMIC:
        return _within_acceleration(limits, vx, vy, error, planes)
    c, s = cos_sin(course)
    if limits[KIND] == _CAR:
        n = _wedge(limits, course, math.sqrt(vx * vx + vy * vy), error, planes)
    else:
        n = _turning_set(limits, c, s, error, planes)
    ahead = c * vx + s * vy
    if not math.isinf(limits[SPEED_UP]):  # it lags by Δ² / 2a while its speed changes by Δ
        most = max(ahead, 0.0) + math.sqrt(2.0 * limits[SPEED_UP] * error)
        planes[n, 0], planes[n, 1], planes[n, 2], planes[n, 3] = most * c, most * s, -s, c
        n += 1
    if not math.isinf(limits[BRAKE]):
        least = ahead - math.sqrt(2.0 * limits[BRAKE] * error)
        if least > 0.0:
            planes[n, 0], planes[n, 1], planes[n, 2], planes[n, 3] = least * c, least * s, s, -c
            n += 1
    return n


@kernel
def _within_acceleration(
    limits: FloatArray, vx: float, vy: float, error: float, planes: FloatArray
) -> int:
    """Write an octagon about the velocity: a change by Δ strays by Δ² / 2a."""
    n = 0
    for k in range(8):
        c, s = cos_sin(k * _OCTANT)
        slowing = c * vx + s * vy < 0.0
        rate = limits[BRAKE] if slowing else limits[SPEED_UP]
        if not math.isinf(rate):
            change = math.sqrt(2.0 * rate * error) * _APOTHEM
            planes[n, 0], planes[n, 1] = vx + change * c, vy + change * s
            planes[n, 2], planes[n, 3] = -s, c
            n += 1
    return n


@kernel
def turn_time(limits: FloatArray, angle: float) -> float:
    """Return the time [s] in which a body turns by ``angle`` [rad] from rest to rest."""
    rate: float = limits[TURN] * _wheel_share(limits, limits[TURN])
    up: float = limits[TURN_UP]
    if math.isinf(up):
        time = angle / rate
    elif angle * up < rate * rate:
        time = 2.0 * math.sqrt(angle / up)
    else:
        time = angle / rate + rate / up
    least: float = limits[STEP]
    return max(time, least)


@kernel
def trackable_speed(limits: FloatArray, angle: float, error: float) -> float:
    """Return the largest speed [m/s] at ``angle`` > 0 from the front that is tracked within ε.

    A body that turns in time t and drives at the best constant speed meanwhile strays by
    v t sin(angle / 2) (from Eq. 13 of the paper of 2013 with the optimal speed).
    """
    time = turn_time(limits, angle)
    slower = 1.0 - _wheel_share(limits, angle / time)  # while it turns
    return error / (time * (math.sin(0.5 * angle) + slower))


@kernel
def _wheel_share(limits: FloatArray, turn_rate: float) -> float:
    """Return the share of the top speed and a turn rate together that the wheels can make."""
    if limits[KIND] != _WHEELS:
        return 1.0
    wheel: float = top_speed(limits) + limits[TRACK] * turn_rate
    return min(float(limits[WHEEL]) / wheel, 1.0)


@kernel
def _turning_set(limits: FloatArray, c: float, s: float, error: float, planes: FloatArray) -> int:
    """Write a polygon in the set of a body that turns on the spot; (c, s) is its front."""
    top = top_speed(limits)
    if trackable_speed(limits, math.pi, error) >= top:
        return 0
    low, high = 0.0, 0.5 * math.pi  # the angle at which the bound is the top speed
    for _ in range(30):
        middle = 0.5 * (low + high)
        if trackable_speed(limits, middle, error) > top:
            low = middle
        else:
            high = middle
    angle, n = high, 0
    y0 = top * math.sin(angle)
    x0 = top * math.cos(angle)
    n = _both(c, s, x0, y0, -1.0, 0.0, planes, n)
    first = angle
    for k in range(1, SIDES + 1):
        angle = first + (math.pi - first) * k / SIDES
        speed = min(trackable_speed(limits, angle, error), top)
        x1, y1 = speed * math.cos(angle), speed * math.sin(angle)
        length = math.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
        if length > 0.0:
            n = _both(c, s, x0, y0, (x1 - x0) / length, (y1 - y0) / length, planes, n)
        x0, y0 = x1, y1
    return n


@kernel
def _both(
    c: float, s: float, x: float, y: float, dx: float, dy: float, planes: FloatArray, n: int
) -> int:
    """Write a half-plane, given in the body's frame, and its mirror image; return n + 2."""
    planes[n, 0], planes[n, 1] = c * x - s * y, s * x + c * y
    planes[n, 2], planes[n, 3] = c * dx - s * dy, s * dx + c * dy
    n += 1
    planes[n, 0], planes[n, 1] = c * x + s * y, s * x - c * y
    planes[n, 2], planes[n, 3] = -c * dx - s * dy, -s * dx + c * dy
    return n + 1


@kernel
def widest_turn(limits: FloatArray, speed: float, error: float) -> float:
    """Return the largest angle [rad] from its front that a car tracks within ε.

    On a circle of radius r it turns by θ, and strays by |∫ (e^iφ − e^iθ) r dφ| ≤ r θ² / 2. While
    its wheels turn to it, for a time t, it strays by v θ t / 2 more; v is the current ``speed``.
    """
    r = 1.0 / curvature(limits)
    late: float = 0.5 * speed * limits[STEER] / limits[STEER_RATE]
    return min((math.sqrt(late * late + 2.0 * r * error) - late) / r, 0.5 * math.pi)


@kernel
def _wedge(
    limits: FloatArray, course: float, speed: float, error: float, planes: FloatArray
) -> int:
    """Write the two half-planes of directions that a car takes."""
    angle = widest_turn(limits, speed, error)
    for k in range(2):
        side = 1.0 - 2.0 * k
        c, s = cos_sin(course + side * angle)
        planes[k, 0], planes[k, 1], planes[k, 2], planes[k, 3] = 0.0, 0.0, -side * c, -side * s
    return 2


@kernel
def tracking_error(
    x: float, y: float, size: float, position: FloatArray, radius: FloatArray, count: int,
    start: FloatArray, end: FloatArray, edges: int, least: float, most: float,
) -> float:  # fmt: skip
    """Return ε [m]: half of the gap to the nearest object, but within ``least`` … ``most``.

    The enlarged discs then do not overlap, as the papers require.
    """
    gap = 2.0 * most
    for k in range(count):
        dx, dy = position[k, 0] - x, position[k, 1] - y
        gap = min(gap, math.sqrt(dx * dx + dy * dy) - radius[k] - size)
    for k in range(edges):
        px, py = nearest_on_segment(x, y, start[k, 0], start[k, 1], end[k, 0], end[k, 1])
        gap = min(gap, math.sqrt((px - x) ** 2 + (py - y) ** 2) - size)
    return min(max(0.5 * gap, least), most)
