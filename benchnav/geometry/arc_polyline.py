"""Corners of a polyline around an arc, as many as what stands beside it demands."""

import math

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.geometry.capsule_grid import SLACK, CapsuleGrid, is_clear, longer
from benchnav.kernels import kernel


@kernel
def around_arc(
    grid: CapsuleGrid, x: float, y: float, radius: float, begin: float, end: float, bend: float
) -> FloatArray:
    """(N, 2) [m] corners of a polyline from angle ``begin`` to ``end`` [rad] of a free arc.

    Every side touches the arc, so no corner is cut. A corner turns by ``bend`` [rad] at
    most, and by half of it, a quarter, … where the polyline would otherwise touch
    something beside the arc; the polyline is then as clear as the arc is.
    """
    count = max(1, math.ceil(abs(end - begin) / bend))
    corners, made = np.empty((max(count, 16), 2)), 0
    for part in range(count):
        low, k, parts = begin + (end - begin) * part / count, 0, 1
        wide = (end - begin) / count
        # piece k of ``parts``; a piece that touches is split, one that is done gives way to the
        # next, joined to a wider one again where it can be
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
            if made == len(corners):
                corners = longer(corners)
            corners[made, 0], corners[made, 1] = cx, cy
            made += 1
            k += 1
            while parts > 1 and k % 2 == 0:
                k, parts = k // 2, parts // 2
    return corners[:made]
