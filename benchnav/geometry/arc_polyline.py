"""A polyline around an arc, refined where obstacles are near."""

import math

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.geometry.capsule_grid import SLACK, CapsuleGrid, doubled, is_clear
from benchnav.kernels import kernel


@kernel
def around_arc(
    grid: CapsuleGrid, x: float, y: float, radius: float, begin: float, end: float, bend: float
) -> FloatArray:
    """Return corners (N, 2) [m] of a polyline from angle ``begin`` to ``end`` [rad] of a free arc.

    Every side touches the arc, so no corner is cut. A corner turns by at most ``bend`` [rad], and
    by half of it, a quarter, … where the polyline would otherwise touch an obstacle beside
    the arc; the polyline is then as clear as the arc is.
    """
    count = max(1, math.ceil(abs(end - begin) / bend))
    corners, size = np.empty((max(count, 16), 2)), 0
    for part in range(count):
        low, k, parts = begin + (end - begin) * part / count, 0, 1
        wide = (end - begin) / count
        # piece k of ``parts``: a piece that touches an obstacle is split; after a finished
        # piece comes the next one, merged into a wider piece again if possible
        while k < parts:
            step = wide / parts
            at, to = low + k * step, low + (k + 1) * step
            reach = radius / math.cos(0.5 * step)
            cx, cy = x + reach * math.cos(at + 0.5 * step), y + reach * math.sin(at + 0.5 * step)
            ax, ay = x + radius * math.cos(at), y + radius * math.sin(at)
            bx, by = x + radius * math.cos(to), y + radius * math.sin(to)
            clear = is_clear(grid, ax, ay, cx, cy) and is_clear(grid, cx, cy, bx, by)
            if not clear and reach - radius > SLACK:
                k, parts = 2 * k, 2 * parts
                continue
            if size == len(corners):
                corners = doubled(corners)
            corners[size, 0], corners[size, 1] = cx, cy
            size += 1
            k += 1
            while parts > 1 and k % 2 == 0:
                k, parts = k // 2, parts // 2
    return corners[:size]
