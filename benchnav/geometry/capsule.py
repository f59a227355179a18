"""Distances and collision times of capsules: segments with a radius, the parts of all solids.

Kernels take a capsule as x0, y0, x1, y1, r, together with a point or disc. All formulas are
closed-form and use correctly rounded operations only.
"""

import math

from benchnav.kernels import kernel_without_allocation

APPROACH = 1e-9  # [m/s] lower closing speeds count as zero, so that rounding causes no contact


@kernel_without_allocation
def nearest_on_segment(
    px: float, py: float, x0: float, y0: float, x1: float, y1: float
) -> tuple[float, float]:
    """Return the point of the segment that is nearest to p."""
    dx, dy = x1 - x0, y1 - y0
    along = dx * (px - x0) + dy * (py - y0)
    if along <= 0.0:
        return x0, y0
    length2 = dx * dx + dy * dy
    if along >= length2:
        return x1, y1
    t = along / length2
    return x0 + t * dx, y0 + t * dy


@kernel_without_allocation
def disc_time(fx: float, fy: float, wx: float, wy: float, reach: float) -> float:
    """Return the first t ≥ 0 with f + w t within ``reach`` of the origin, approaching, else inf.

    f starts outside; if it starts inside and approaches, the result is 0.
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


@kernel_without_allocation
def capsule_time(
    px: float, py: float, wx: float, wy: float, reach: float, way: float,
    x0: float, y0: float, x1: float, y1: float,
) -> float:  # fmt: skip
    """Return the first t ≥ 0 with p + w t within ``reach`` of the segment; inf if never.

    ``reach`` is the sum of the two radii; a segment farther away than ``way`` is ignored.
    The result is 0 for a point within reach that approaches, and inf for one that separates,
    because the distance to a convex set along a line is convex.
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
            return 0.0  # touching, although rounding separated the squares above
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


@kernel_without_allocation
def segments_cross(
    ax: float, ay: float, bx: float, by: float, x0: float, y0: float, x1: float, y1: float
) -> bool:
    """Whether the open segment ab properly crosses the segment."""
    dx, dy = x1 - x0, y1 - y0
    side_a = dx * (ay - y0) - dy * (ax - x0)
    side_b = dx * (by - y0) - dy * (bx - x0)
    if side_a * side_b >= 0.0:
        return False
    ex, ey = bx - ax, by - ay
    side_0 = ex * (y0 - ay) - ey * (x0 - ax)
    side_1 = ex * (y1 - ay) - ey * (x1 - ax)
    return side_0 * side_1 <= 0.0
