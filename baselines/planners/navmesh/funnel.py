"""The shortest path through a sequence of portals.

Mikko Mononen, "Simple stupid funnel algorithm", 2010
(https://digestingduck.blogspot.com/2010/03/simple-stupid-funnel-algorithm.html).
"""

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.kernels import kernel


@kernel
def pulled(start: FloatArray, goal: FloatArray, doors: FloatArray) -> FloatArray:
    """Return the taut path (W, 2) [m] from start to goal, (2,), by portals (K, left right, 2).

    Left and right are relative to the direction of travel. The funnel has its apex at the last
    corner of the path and its two edges at portal ends. It narrows from portal to portal, and if
    one edge crosses the other, the end of the other is the next corner.
    """
    count = len(doors)
    left, right = np.empty((count + 1, 2)), np.empty((count + 1, 2))
    left[:count], right[:count] = doors[:, 0], doors[:, 1]
    left[count], right[count] = goal, goal
    path, made = np.empty((count + 3, 2)), 1
    path[0] = start
    apex, edge_l, edge_r = start, start, start
    at_l, at_r = -1, -1  # the portals of the edges; the apex itself has -1
    k = 0
    while k <= count:
        # an unchanged end crosses nothing, although apex and ends may be collinear
        if _same(edge_r, right[k]):
            at_r = k
        elif _turn(apex, edge_r, right[k]) >= 0.0:  # the right edge narrows
            if _same(apex, edge_r) or _turn(apex, edge_l, right[k]) < 0.0:
                edge_r, at_r = right[k], k
            else:  # it crosses the left edge
                apex, k = edge_l, at_l + 1
                path[made], made = apex, made + 1
                edge_l, edge_r, at_r = apex, apex, at_l
                continue
        if _same(edge_l, left[k]):
            at_l = k
        elif _turn(apex, edge_l, left[k]) <= 0.0:
            if _same(apex, edge_l) or _turn(apex, edge_r, left[k]) > 0.0:
                edge_l, at_l = left[k], k
            else:
                apex, k = edge_r, at_r + 1
                path[made], made = apex, made + 1
                edge_l, edge_r, at_l = apex, apex, at_r
                continue
        k += 1
    path[made] = goal
    return path[: made + 1]


@kernel
def _turn(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    """Return twice the area of abc: positive if c lies to the left of the line from a to b."""
    area: float = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return area


@kernel
def _same(a: FloatArray, b: FloatArray) -> bool:
    return bool(a[0] == b[0] and a[1] == b[1])
