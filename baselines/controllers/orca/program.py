"""The velocity nearest to the preferred one within half-planes and the speed limit.

Randomised incremental linear programming (de Berg et al. 2008, chapter 4) as in van
den Berg et al. 2011, section 5; half-planes come in a fixed order
(nearest first), so there is no randomness. Rows of ``planes`` are half-planes.
"""

import math

from benchnav.arrays import FloatArray
from benchnav.kernels import kernel_without_allocation

PARALLEL = 1e-5  # sine of the angle below which two boundaries count as parallel


@kernel_without_allocation
def excess(planes: FloatArray, i: int, x: float, y: float) -> float:
    """Return how far [m/s] (x, y) lies outside half-plane i; negative inside."""
    out: float = planes[i, 2] * (planes[i, 1] - y) - planes[i, 3] * (planes[i, 0] - x)
    return out


@kernel_without_allocation
def on_boundary(
    planes: FloatArray, i: int, speed: float, wx: float, wy: float, farthest: bool
) -> tuple[bool, float, float]:
    """Return (feasible, best point) on boundary i in half-planes 0 … i - 1 and the speed limit.

    Best is nearest to w, or ``farthest`` in the direction w.
    """
    x, y, dx, dy = planes[i, 0], planes[i, 1], planes[i, 2], planes[i, 3]
    middle = x * dx + y * dy
    root = middle * middle + speed * speed - (x * x + y * y)
    if root < 0.0:
        return False, 0.0, 0.0
    root = math.sqrt(root)
    low, high = -middle - root, root - middle
    for j in range(i):
        turn = dx * planes[j, 3] - dy * planes[j, 2]
        gap = planes[j, 2] * (y - planes[j, 1]) - planes[j, 3] * (x - planes[j, 0])
        if abs(turn) <= PARALLEL:
            if gap < 0.0:
                return False, 0.0, 0.0
            continue
        t = gap / turn
        if turn > 0.0:
            high = min(high, t)
        else:
            low = max(low, t)
        if low > high:
            return False, 0.0, 0.0
    if farthest:
        t = high if wx * dx + wy * dy > 0.0 else low
    else:
        t = min(max(dx * (wx - x) + dy * (wy - y), low), high)
    return True, x + t * dx, y + t * dy


@kernel_without_allocation
def nearest_permitted(
    planes: FloatArray, n: int, speed: float, wx: float, wy: float, farthest: bool
) -> tuple[int, float, float]:
    """Return (n, velocity) within the first n half-planes, or (first that fails, velocity).

    Nearest to w, or ``farthest`` in the unit direction w.
    """
    x, y = wx, wy
    length2 = wx * wx + wy * wy
    if farthest:
        x, y = wx * speed, wy * speed
    elif length2 > speed * speed:
        scale = speed / math.sqrt(length2)
        x, y = wx * scale, wy * scale
    for i in range(n):
        if excess(planes, i, x, y) > 0.0:
            feasible, bx, by = on_boundary(planes, i, speed, wx, wy, farthest)
            if not feasible:
                return i, x, y
            x, y = bx, by
    return n, x, y


@kernel_without_allocation
def least_excess(
    planes: FloatArray, n: int, fixed: int, first: int, speed: float, x: float, y: float,
    projected: FloatArray,
) -> tuple[float, float]:  # fmt: skip
    """Return the velocity with the smallest maximal excess over half-planes fixed … n - 1.

    Half-planes 0 … fixed - 1 (edges) stay hard. ``first`` is the one that
    failed at velocity (x, y); ``projected`` is scratch, as large as ``planes``.
    """
    worst = 0.0
    for i in range(first, n):
        if excess(planes, i, x, y) > worst:
            m = _bisectors(planes, fixed, i, projected)
            wx, wy = -planes[i, 3], planes[i, 2]
            reached, bx, by = nearest_permitted(projected, m, speed, wx, wy, True)
            if reached == m:  # it fails only by rounding: keep the result
                x, y = bx, by
            worst = excess(planes, i, x, y)
    return x, y


@kernel_without_allocation
def _bisectors(planes: FloatArray, fixed: int, i: int, projected: FloatArray) -> int:
    """Write where half-plane i is exceeded no less than each earlier one; return the row count."""
    for j in range(fixed):
        for k in range(4):
            projected[j, k] = planes[j, k]
    m = fixed
    x, y, dx, dy = planes[i, 0], planes[i, 1], planes[i, 2], planes[i, 3]
    for j in range(fixed, i):
        qx, qy, fx, fy = planes[j, 0], planes[j, 1], planes[j, 2], planes[j, 3]
        turn = dx * fy - dy * fx
        if abs(turn) > PARALLEL:
            t = (fx * (y - qy) - fy * (x - qx)) / turn
            qx, qy = x + t * dx, y + t * dy
        elif dx * fx + dy * fy > 0.0:
            continue
        else:
            qx, qy = 0.5 * (x + qx), 0.5 * (y + qy)
        gx, gy = fx - dx, fy - dy
        length = math.sqrt(gx * gx + gy * gy)
        projected[m, 0], projected[m, 1] = qx, qy
        projected[m, 2], projected[m, 3] = gx / length, gy / length
        m += 1
    return m
