"""A capsule is a segment with a radius; everything solid is made of capsules.

Kernels take a capsule as seven numbers x0, y0, x1, y1, r and a point or disc
beside it. All are closed-form and use correctly rounded operations only.
"""

import math

from benchnav.kernels import kernel

APPROACH = 1e-9  # [m/s] a closing speed below this is none: rounding must not touch again


@kernel
def nearest_on_segment(
    px: float, py: float, x0: float, y0: float, x1: float, y1: float
) -> tuple[float, float]:
    """The point of the segment that is nearest to p."""
    dx, dy = x1 - x0, y1 - y0
    along = dx * (px - x0) + dy * (py - y0)
    if along <= 0.0:
        return x0, y0
    length2 = dx * dx + dy * dy
    if along >= length2:
        return x1, y1
    t = along / length2
    return x0 + t * dx, y0 + t * dy


@kernel
def disc_time(fx: float, fy: float, wx: float, wy: float, reach: float) -> float:
    """First t ≥ 0 at which f + w t is within ``reach`` of the origin, approaching; inf if never.

    f starts outside; inside, the answer is 0 while approaching.
    """
    b = fx * wx + fy * wy
    if b >= -APPROACH * reach:
        return math.inf
    c = fx * fx + fy * fy - reach * reach
    if c <= 0.0:
        return 0.0
    a = wx * wx + wy * wy
    root = b * b - a * c
    if root < 0.0:
        return math.inf
    return c / (math.sqrt(root) - b)


@kernel
def capsule_time(
    px: float, py: float, wx: float, wy: float, reach: float, way: float,
    x0: float, y0: float, x1: float, y1: float,
) -> float:  # fmt: skip
    """First t ≥ 0 at which p + w t comes within ``reach`` of the segment; inf if never.

    ``reach`` is the sum of the two radii; what is farther off than ``way`` is left out.
    A point that is within reach already and approaches has 0; one that separates has
    inf, because the distance to a convex set along a line is convex.
    """
    qx, qy = nearest_on_segment(px, py, x0, y0, x1, y1)
    fx, fy = px - qx, py - qy
    f2 = fx * fx + fy * fy
    if fx * wx + fy * wy >= -APPROACH * reach or f2 > (reach + way) * (reach + way):
        return math.inf
    if f2 <= reach * reach:
        return 0.0
    dx, dy = x1 - x0, y1 - y0
    length2 = dx * dx + dy * dy
    if length2 > 0.0:
        length = math.sqrt(length2)
        across = (dx * (py - y0) - dy * (px - x0)) / length
        speed = (dx * wy - dy * wx) / length
        gap = abs(across) - reach
        here = dx * (px - x0) + dy * (py - y0)
        if gap <= 0.0 and 0.0 <= here <= length2:
            return 0.0  # touching, though the squares above were rounded apart
        if gap > 0.0:
            closing = -speed if across > 0.0 else speed
            if closing <= 0.0:
                return math.inf
            t = gap / closing
            along = dx * (px + wx * t - x0) + dy * (py + wy * t - y0)
            if 0.0 <= along <= length2:
                return t
    return min(
        disc_time(px - x0, py - y0, wx, wy, reach), disc_time(px - x1, py - y1, wx, wy, reach)
    )


@kernel
def segments_cross(
    ax: float, ay: float, bx: float, by: float, x0: float, y0: float, x1: float, y1: float
) -> bool:
    """True where the open segment ab properly crosses the segment."""
    dx, dy = x1 - x0, y1 - y0
    side_a = dx * (ay - y0) - dy * (ax - x0)
    side_b = dx * (by - y0) - dy * (bx - x0)
    if side_a * side_b >= 0.0:
        return False
    ex, ey = bx - ax, by - ay
    side_0 = ex * (y0 - ay) - ey * (x0 - ax)
    side_1 = ex * (y1 - ay) - ey * (x1 - ax)
    return side_0 * side_1 <= 0.0
