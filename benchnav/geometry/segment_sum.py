"""Distances and contact times of two convex bodies, from the Minkowski sum of their cores.

The core of a body is a rectangle, a segment or a point; a radius rounds it. Two bodies touch
when the vector between their centres is as far from the Minkowski sum of their cores as the sum of
the radii. A rectangle is a sum of two segments, so the sum of two cores is a sum of up to four:
a zonotope (McMullen 1971), whose edges have a closed form. Distances, depths and contact times are
therefore those of a point and a convex polygon, exact up to rounding, without iteration.

A sum is centred at the origin. It is given by its half segments ``gx``, ``gy``: two tuples of
four coordinates [m], zero for a missing one. Operations are correctly rounded.
"""

import math

from benchnav.geometry.capsule import APPROACH, capsule_time, disc_time, nearest_on_segment
from benchnav.kernels import kernel_without_allocation

Four = tuple[float, float, float, float]


@kernel_without_allocation
def edge_center(i: int, gx: Four, gy: Four) -> tuple[float, float]:
    """Return the middle of the edge along half segment i, on the left of its direction.

    Every other segment ends on that side. Of parallel ones, the later is turned left by an
    infinitesimal angle, so that their edges follow each other.
    """
    x, y = 0.0, 0.0
    for j in range(4):
        if j == i:
            continue
        cross = gx[i] * gy[j] - gy[i] * gx[j]
        if cross == 0.0:
            cross = (gx[i] * gx[j] + gy[i] * gy[j]) * (j - i)
        if cross > 0.0:
            x += gx[j]
            y += gy[j]
        elif cross < 0.0:
            x -= gx[j]
            y -= gy[j]
    return x, y


@kernel_without_allocation
def distance_to_sum(fx: float, fy: float, gx: Four, gy: Four) -> tuple[float, float, float]:
    """Return (nx, ny, distance) of f and a sum: the direction away from it, and the distance [m].

    Inside, the distance is negative and the direction is that of the shortest way out. The
    direction is not normalised, and zero only for a point that f is equal to.
    """
    nearest, nx, ny = math.inf, fx, fy
    depth, ox, oy = math.inf, 0.0, 0.0
    inside = True
    for i in range(4):
        ax, ay = gx[i], gy[i]
        length2 = ax * ax + ay * ay
        if length2 == 0.0:
            continue
        side = ax * fy - ay * fx
        cx, cy = edge_center(i, gx, gy)
        over = abs(side) - (ax * cy - ay * cx)  # times the length: beyond the edge's line
        if side < 0.0:
            cx, cy = -cx, -cy
        qx, qy = nearest_on_segment(fx, fy, cx - ax, cy - ay, cx + ax, cy + ay)
        dx, dy = fx - qx, fy - qy
        d2 = dx * dx + dy * dy
        length = math.sqrt(length2)
        if d2 < nearest:
            nearest, nx, ny = d2, dx, dy
            if d2 == 0.0:
                nx, ny = (-ay, ax) if side >= 0.0 else (ay, -ax)
        if over > 0.0:
            inside = False
        elif -over < depth * length:
            depth, ox, oy = -over / length, -ay, ax
            if side < 0.0:
                ox, oy = ay, -ax
    if nearest == math.inf:
        return fx, fy, math.sqrt(fx * fx + fy * fy)
    if inside and depth > 0.0:
        return ox, oy, -depth
    return nx, ny, math.sqrt(nearest)


@kernel_without_allocation
def time_to_sum(
    fx: float, fy: float, wx: float, wy: float, reach: float, way: float, gx: Four, gy: Four
) -> float:
    """Return the first t ≥ 0 with f + w t within ``reach`` of a sum, approaching; inf if never.

    A sum farther away than ``way`` is ignored. The result is 0 for a point within reach that
    approaches, and inf for one that separates, because the distance along a line is convex.
    """
    nx, ny, d = distance_to_sum(fx, fy, gx, gy)
    if d > reach + way:
        return math.inf
    if d <= reach:
        closing = nx * wx + ny * wy
        return 0.0 if closing < -APPROACH * math.sqrt(nx * nx + ny * ny) else math.inf
    best, point = math.inf, True
    for i in range(4):
        ax, ay = gx[i], gy[i]
        if ax == 0.0 and ay == 0.0:
            continue
        point = False
        cx, cy = edge_center(i, gx, gy)
        t = capsule_time(fx, fy, wx, wy, reach, way, cx - ax, cy - ay, cx + ax, cy + ay)
        best = min(best, t)
        t = capsule_time(fx, fy, wx, wy, reach, way, -cx - ax, -cy - ay, -cx + ax, -cy + ay)
        best = min(best, t)
    return disc_time(fx, fy, wx, wy, reach) if point else best
