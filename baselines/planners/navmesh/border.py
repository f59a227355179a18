"""Doors across the borders of tiles, where the sides of triangles do not share their ends.

Both tiles round the place where an obstacle crosses their border, and may differ in the last bit.
A door is what two sides have in common.
"""

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.kernels import kernel

from .tile import Tiling

NEAR = 1e-8  # [m] within which a vertex lies on a border; shorter pieces of a side do not count


def on_lines(vertex: FloatArray, tiling: Tiling) -> BoolArray:
    """Return (V, 2), whether each vertex lies on a vertical and on a horizontal line of tiles."""
    lines = np.rint(vertex / tiling.side)
    near: BoolArray = np.abs(vertex - lines * tiling.side) <= NEAR
    return near


def border_doors(
    sides: IntArray, tail: IntArray, head: IntArray, vertex: FloatArray, tiling: Tiling
) -> tuple[IntArray, IntArray]:
    """Return doors, and the sides that are doors all along.

    Doors are (D, 4): triangle left, triangle entered, vertices at the left and right end.

    Args:
        sides: (S,) that two triangles do not share; side k of triangle t is 3 t + k.
        tail: (3 T,) vertex where each side begins, the triangle on its left.
        head: (3 T,) vertex where it ends.
        vertex: (V, 2) [m].
        tiling: the tiles.
    """
    found, length = [], np.zeros(len(tail))
    near, line = on_lines(vertex, tiling), np.rint(vertex / tiling.side)
    for axis in (0, 1):
        t, h = tail[sides], head[sides]
        on = near[t, axis] & near[h, axis] & (line[t, axis] == line[h, axis])
        t, h, here = t[on], h[on], sides[on]
        rises = vertex[h, 1 - axis] > vertex[t, 1 - axis]
        low, high = np.where(rises, t, h), np.where(rises, h, t)
        below = rises if axis == 0 else ~rises  # whether the triangle is before the line
        rank = np.lexsort((vertex[low, 1 - axis], line[low, axis]))
        a, b = rank[below[rank]], rank[~below[rank]]
        pair = _overlaps(
            line[low[a], axis], vertex[low[a], 1 - axis], vertex[high[a], 1 - axis],
            line[low[b], axis], vertex[low[b], 1 - axis], vertex[high[b], 1 - axis],
        )  # fmt: skip
        a, b = a[pair[:, 0]], b[pair[:, 1]]
        v = vertex[:, 1 - axis]
        begin = np.where(v[low[a]] >= v[low[b]], low[a], low[b])
        end = np.where(v[high[a]] <= v[high[b]], high[a], high[b])
        ends = (end, begin) if axis == 0 else (begin, end)
        found.append(np.stack([here[a] // 3, here[b] // 3, *ends], axis=1))
        np.add.at(length, here[np.concatenate([a, b])], np.tile(v[end] - v[begin], 2))
    missing = np.hypot(*(vertex[head[sides]] - vertex[tail[sides]]).T) - length[sides]
    return np.vstack(found), sides[missing <= NEAR]


@kernel
def _overlaps(
    line_a: FloatArray, low_a: FloatArray, high_a: FloatArray,
    line_b: FloatArray, low_b: FloatArray, high_b: FloatArray,
) -> IntArray:  # fmt: skip
    """Return the pairs (N, 2) of intervals on one line that overlap; both are sorted."""
    pairs, count = np.empty((len(low_a) + len(low_b), 2), np.int64), 0
    a, b = 0, 0
    while a < len(low_a) and b < len(low_b):
        if line_a[a] != line_b[b]:
            if line_a[a] < line_b[b]:
                a += 1
            else:
                b += 1
            continue
        if min(high_a[a], high_b[b]) - max(low_a[a], low_b[b]) > NEAR:
            pairs[count, 0], pairs[count, 1] = a, b
            count += 1
        if high_a[a] <= high_b[b]:
            a += 1
        else:
            b += 1
    return pairs[:count]
