"""A uniform grid over capsules, for swept tests on big maps.

Every capsule is registered in each cell that it comes within a margin of, so a disc
whose radius is at most the margin meets only capsules of the cells that its centre
passes through. Cells hold their capsules as compressed rows: cell c lists
items[first[c] : first[c + 1]].
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry.sweep import is_free_of, point_segment_distance2

WORTH_IT = 64  # capsules; below this, looking at all of them is faster
_MOST_CELLS = 1 << 20
_SLACK = 1e-9  # [m] on registration and on the cells visited, above rounding


@dataclass(frozen=True, eq=False)
class GridIndex:
    """Which capsules matter in which cell."""

    origin: tuple[float, float]  # [m] lower-left corner
    side: float  # [m] of a cell
    shape: tuple[int, int]  # columns, rows
    margin: float  # [m] greatest radius that may be asked for
    first: IntArray  # (columns · rows + 1,)
    items: IntArray  # (N,) indices into the capsules, rising within a cell


def grid_index(capsules: FloatArray, margin: float) -> GridIndex:
    """The index of capsules (P, 5) for discs of radius up to ``margin`` [m]."""
    if len(capsules) == 0:
        none = np.zeros(0, np.int64)
        return GridIndex((0.0, 0.0), 1.0, (1, 1), margin, np.zeros(2, np.int64), none)
    reach = capsules[:, 4:5] + margin + _SLACK
    low = np.minimum(capsules[:, 0:2], capsules[:, 2:4]) - reach
    high = np.maximum(capsules[:, 0:2], capsules[:, 2:4]) + reach
    corner = low.min(axis=0)
    extent = np.maximum(high.max(axis=0) - corner, 1e-6)
    cells = min(_MOST_CELLS, 4 * len(capsules))
    side = max(math.sqrt(float(extent[0] * extent[1]) / cells), float(extent.max()) / cells)
    columns, rows = (int(n) + 1 for n in np.floor(extent / side))
    first = np.zeros(columns * rows + 1, np.int64)
    nothing = np.zeros(0, np.int64)
    at = (float(corner[0]), float(corner[1]), side, columns, rows)
    _register(capsules, margin, *at, first, nothing)
    total = np.concatenate([[0], np.cumsum(first[:-1])]).astype(np.int64)
    items = np.zeros(int(total[-1]), np.int64)
    _register(capsules, margin, *at, total.copy(), items)
    return GridIndex((at[0], at[1]), side, (columns, rows), margin, total, items)


@njit(cache=True)
def _clamped(coordinate: float, low: float, side: float, count: int) -> int:
    """The cell of a coordinate, or the nearest one that exists."""
    return int(min(max(math.floor((coordinate - low) / side), 0.0), count - 1.0))


@njit(cache=True)
def _register(
    capsules: FloatArray, margin: float, left: float, bottom: float, side: float,
    columns: int, rows: int, cursor: IntArray, items: IntArray,
) -> None:  # fmt: skip
    """Count each cell's capsules in ``cursor``; with ``items``, write them where it points."""
    half_diagonal = side * math.sqrt(0.5)
    for p in range(capsules.shape[0]):
        x0, y0, x1, y1, r = capsules[p]
        reach = r + margin + _SLACK
        far = (reach + half_diagonal) * (reach + half_diagonal)
        for i in range(
            _clamped(min(x0, x1) - reach, left, side, columns),
            _clamped(max(x0, x1) + reach, left, side, columns) + 1,
        ):
            for j in range(
                _clamped(min(y0, y1) - reach, bottom, side, rows),
                _clamped(max(y0, y1) + reach, bottom, side, rows) + 1,
            ):
                x, y = left + (i + 0.5) * side, bottom + (j + 0.5) * side
                if point_segment_distance2(x, y, x0, y0, x1, y1) > far:
                    continue
                c = i * rows + j
                if len(items) > 0:
                    items[cursor[c]] = p
                cursor[c] += 1


@njit(cache=True)
def motion_is_free_in(
    px: float, py: float, qx: float, qy: float, radius: float, capsules: FloatArray,
    left: float, bottom: float, side: float, columns: int, rows: int,
    first: IntArray, items: IntArray,
) -> bool:  # fmt: skip
    """`motion_is_free` that looks only into the cells along the motion, column by column.

    ``radius`` may not exceed the margin of the index.
    """
    if px > qx:
        px, py, qx, qy = qx, qy, px, py
    right, top = left + columns * side, bottom + rows * side
    if qx < left or px > right or max(py, qy) < bottom or min(py, qy) > top:
        return True
    slope = (qy - py) / (qx - px) if qx > px else 0.0
    start = _clamped(px - _SLACK, left, side, columns)
    for i in range(start, _clamped(qx + _SLACK, left, side, columns) + 1):
        y0, y1 = py, qy
        if qx - px > side:
            y0 = py + slope * (max(px, left + i * side) - px)
            y1 = py + slope * (min(qx, left + (i + 1) * side) - px)
        low, high = min(y0, y1) - _SLACK, max(y0, y1) + _SLACK
        for j in range(_clamped(low, bottom, side, rows), _clamped(high, bottom, side, rows) + 1):
            c = i * rows + j
            for k in range(first[c], first[c + 1]):
                if not is_free_of(px, py, qx, qy, radius, capsules[items[k]]):
                    return False
    return True
